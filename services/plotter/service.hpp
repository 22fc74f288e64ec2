// The plotter process without its clock and its sockets: TRACKS, ALERTS and POSE in; own ship, targets and alerts out over links; ALERT_ACK out.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/recently.hpp"
#include "common/messages/part_assembler.hpp"
#include "common/messages/pose_message.hpp"
#include "services/plotter/core/target_numbers.hpp"
#include "services/plotter/output.hpp"
#include "services/plotter/params.hpp"
#include "services/plotter/surroundings.hpp"
#include "services/plotter/wire.hpp"

namespace lookout::plotter {

/// Nothing old is told as new. Targets are told with each TRACKS, while ALERTS, TRACKS and POSE came within kFresh of host time and POSE knows the
/// position; the own ship while POSE came within kFresh; the surroundings, where an output takes them, with each TRACKS as targets, whether or not
/// the position is known, and not while an alert says that nobody looks. That ALERTS are missing, or a position, is itself a notice.
class Service {
 public:
  static constexpr std::chrono::seconds kFresh{1};

  Service(bus::Bus& bus, const Params& params, std::vector<std::unique_ptr<Output>> outputs);

  /// Host time has come so far. Ten times a second or more.
  void AdvanceTo(Utime host_time);

  /// The process ends in order: targets are told as ended, so that they do not stand where nobody sends them.
  void Finish();

  HealthReport Report() const;

  /// Lines for the log of the process, each when it comes up: of outputs that nobody listens to, which is no fault.
  std::vector<std::string> TakeRemarks();

 private:
  void OnTracks(const tracks_t& message);
  void OnAlerts(const alerts_t& message);
  void OnPose(const pose_t& message);
  void OnAis(const ais_t& message);

  const std::string* ShipOf(std::int64_t track_id) const;
  void UseTracks(std::span<const tracks_t> parts);
  void SubscribeSurroundings();
  void TellLook(std::span<const tracks_t> parts);
  void ComposeTargets();
  void ComposeNotices();
  std::optional<Notice> OwnNotice() const;
  void TellNotices();
  void TakeCommands();
  void Acknowledge(std::int64_t key);
  void Silence();
  Told ToldNow() const;
  bool IsFresh(std::optional<std::chrono::microseconds> seen) const;
  bool MayTellTargets() const;
  bool MayTellLook() const;
  bool TellsTargets() const;
  void StopTargets();

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"tracks_incomplete", "tracks_inconsistent", "acks_sent", "acks_of_no_alert", "silences_sent",
                                       "times_unwatched", "runs_begun", "names_refused", "ais_refused"});

  bus::Bus& bus_;
  Params params_;
  std::vector<std::unique_ptr<Output>> outputs_;
  std::set<std::string> remarks_;  // remarks that hold
  messages::PartAssembler<tracks_t> parts_;
  TargetNumbers numbers_;
  OwnShip own_;
  bool has_pose_ = false;
  std::vector<Target> tracks_;      // of the last TRACKS, by id
  std::vector<Target> targets_;     // tracks that are told, at the present time
  Utime tracks_time_;               // to which they are propagated
  std::optional<Utime> begin_;      // of the tracker's process
  std::vector<Notice> alerts_;      // of the last ALERTS
  GivenNames names_;                // of the last ALERTS
  std::optional<ShipNames> ships_;  // of the last AIS
  std::optional<Notice> own_notice_;
  std::vector<Notice> notices_;                                                          // alerts_ and own_notice_
  std::map<std::pair<std::int64_t, Utime>, std::chrono::microseconds> unchanged_since_;  // by key and change, by passed_
  bool are_told_ = false;                                                                // targets
  bool was_watched_ = false;
  PassedTime passed_{std::chrono::milliseconds(250)};
  std::optional<Utime> now_;
  std::optional<std::chrono::microseconds> tracks_seen_;  // by passed_
  std::optional<std::chrono::microseconds> alerts_seen_;
  std::optional<std::chrono::microseconds> pose_seen_;
  std::optional<Surroundings> surroundings_;
  std::optional<std::chrono::microseconds> look_told_;
  std::optional<std::chrono::microseconds> sight_lost_;  // since when nobody looked in any direction, though TRACKS came
  std::optional<std::chrono::microseconds> own_told_;
  std::optional<std::chrono::microseconds> notices_told_;
  std::int64_t ack_seq_ = 0;
  std::int64_t order_seq_ = 0;
  std::optional<std::chrono::microseconds> silenced_;               // sent last
  std::map<std::int64_t, std::chrono::microseconds> acknowledged_;  // by key, when
  Counts<kCountNames> counts_;
  Counts<kTracksFaults> tracks_refused_;
  Counts<kAlertsFaults> alerts_refused_;
  Counts<messages::kPoseFaults> poses_refused_;
};

}  // namespace lookout::plotter
