// The tracker process without its clock: OBSTACLES, SEGMENTS, LIDAR_SCAN, POSE, ALERT_ACK and ORDERS in, TRACKS and ALERTS out.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/input_watch.hpp"
#include "common/core/utime.hpp"
#include "common/messages/part_assembler.hpp"
#include "common/messages/pose_message.hpp"
#include "services/tracker/core/kept_acknowledgements.hpp"
#include "services/tracker/core/look_out.hpp"
#include "services/tracker/core/script.hpp"
#include "services/tracker/core/zone_sight.hpp"
#include "services/tracker/handover.hpp"
#include "services/tracker/params.hpp"
#include "services/tracker/watch.hpp"
#include "services/tracker/wire.hpp"

namespace lookout::tracker {

/// Facts of the input, known beforehand. Live: none.
struct RunContext {
  Gatherer::Sources sources = {};
  std::optional<Script> script = {};                                     // of the live run that is replayed, where its log holds ALERTS
  std::optional<Legacy> before = {};                                     // live: of the process before
  std::function<void(const alerts_t&, const tracks_t&)> hand_over = {};  // live: after each scan, for the process behind
};

class Service {
 public:
  Service(bus::Bus& bus, const Params& params, RunContext context = {});

  /// Live only: host time has come so far. Ten times a second or more.
  void AdvanceTo(Utime host_time);

  /// End of input: waiting scans are used as they are; where a live run is replayed, as far as that used them. A live process that is stopped does
  /// not call it: its result of half a scan no replay, which hears the rest of it, could know.
  void Finish();

  /// Scans that wait for POSE, LIDAR_SCAN or SEGMENTS.
  std::int64_t num_waiting() const { return gatherer_.num_waiting(); }

  /// Live only: whether somebody looks has changed since the call before. That is worth a HEALTH message at once.
  bool TakeWatchChange();

  HealthReport Report() const;

 private:
  // Tracks and alerts, from the begin of a process.
  struct Memory {
    explicit Memory(const Params& params) : tracker(params.tracker), look_out(params.look_out), zone_sight(params.zone_sight), cover(params.cover) {}
    Tracker tracker;
    LookOut look_out;
    ZoneSight zone_sight;
    CoverWatch cover;
    bool is_second_silent = false;  // in the last scan
    std::string zone_text;          // of the last part of the guard zone that nobody looked into
    std::string cover_text;         // of what covered the lidar last
    KeptAcknowledgements kept;
    KeptNames kept_names;
    const Picture* picture = nullptr;  // of the last scan: the tracker's own
    std::optional<Pose> own;           // when it was known last
    ScanKey begin;
  };

  void OnObstacles(const obstacles_t& message);
  void OnBeams(const lidar_scan_t& message);
  void OnLabels(const segments_t& message);
  void OnPose(const pose_t& message);
  void OnAcknowledgement(const alert_ack_t& message);
  void OnOrder(const order_t& message);

  void AddObstacles(std::span<const obstacles_t> parts);
  void AddBeams(std::span<const lidar_scan_t> parts, bool is_whole);
  void AddLabels(std::span<const segments_t> parts, bool is_whole);

  void Use(std::vector<GatheredScan> scans);
  void Use(GatheredScan& scan);
  void Keep(const Datum& datum, const Eigen::Vector2d& shift_m);
  void KeepBesideBoat(const ScanInput& input);
  bool FollowScript(const ScanKey& key);
  void Begin(const ScanKey& begin);
  std::vector<Acknowledgement> TakeAcknowledgements(const ScanInput& input, const Picture& picture);
  std::vector<Order> TakeOrders(const ScanInput& input);
  void WatchForCovers(ScanInput& input);
  std::vector<Danger> LookForUnseen(const ScanInput& input);
  void TellOfUnseen(alerts_t& message) const;
  void HandOver(const alerts_t& message, const Picture& picture) const;
  void SendWatch();

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"obstacles_not_placed", "obstacles_without_covariance", "obstacles_over_limit", "obstacles_inconsistent",
                                       "beams_inconsistent", "parts_duplicate", "parts_inconsistent", "scans_not_of_the_live_run", "acks_taken",
                                       "acks_of_no_alert", "acks_dropped", "orders_taken", "orders_dropped", "alerts_untold"});

  bus::Bus& bus_;
  Params params_;
  RunContext context_;
  Gatherer gatherer_;
  messages::PartAssembler<obstacles_t> obstacles_parts_;
  messages::PartAssembler<lidar_scan_t> beams_parts_;
  messages::PartAssembler<segments_t> labels_parts_;
  std::unique_ptr<Memory> memory_;  // nullptr until the first scan
  std::size_t next_stretch_ = 0;    // of the script
  std::deque<Acknowledgement> acknowledgements_;
  std::vector<Order> orders_;
  std::optional<std::int64_t> pose_seq_;
  std::optional<ScanLabel> label_;  // of the last scan
  bool is_placed_ = true;           // in the last scan
  std::int64_t num_alerts_ = 0;
  Counts<kCountNames> counts_;
  Counts<messages::kObstaclesFaults> obstacles_refused_;
  Counts<messages::kScanFaults> beams_refused_;
  Counts<messages::kSegmentsFaults> labels_refused_;
  Counts<messages::kPoseFaults> poses_refused_;
  Counts<messages::kAckFaults> acknowledgements_refused_;
  Counts<messages::kOrderFaults> orders_refused_;
  // Host time, live only.
  Watch watch_;
  bool reported_failing_ = false;
  std::optional<Utime> now_;
  InputWatch obstacles_watch_{bus::kObstacles.name};
  std::array<InputWatch, 3> other_watches_{InputWatch(bus::kLidarScan.name), InputWatch(bus::kSegments.name), InputWatch(bus::kPose.name)};
};

}  // namespace lookout::tracker
