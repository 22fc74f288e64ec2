// Alerts over time: when they come up, how grave they are, their acknowledgement, and when they end.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/danger.hpp"
#include "services/tracker/core/told_places.hpp"

namespace lookout::tracker {

// Numbers of these are those of the wire.
enum class AlertState : std::int32_t { kActive = 1, kAcknowledged = 2, kRectified = 3, kCleared = 4 };
enum class AlertSight : std::int32_t { kSeen = 1, kJustSeen = 2, kLost = 3 };
enum class AlertEnd : std::int32_t { kNone = 0, kClear = 1, kPassed = 2, kGone = 3, kHidden = 4, kMerged = 5 };

/// One thing that is dangerous, by whatever causes.
struct Alert {
  std::int64_t id = 0;
  AlertCause cause = AlertCause::kGuardZone;  // the one that weighs most
  bool is_in_zone = false;
  bool comes_near = false;
  bool tells_way = false;  // the place is the one on the boat's way, and not the nearest in the zone
  AlertLevel level = AlertLevel::kCaution;
  AlertState state = AlertState::kActive;
  std::int64_t thing = kLandTrack;
  std::int64_t nearest_track = kLandTrack;  // of the thing; 0: land, no track, or not seen any more
  TrackKind kind = TrackKind::kUnknown;     // of nearest_track
  std::string name = {};                    // given by people; "": none
  Utime raised = {};
  Utime changed = {};
  double distance_m = kNan;
  double bearing_rad = kNan;
  double cpa_m = kNan;
  double tcpa_s = kNan;
  double cpa_probability = kNan;
  double time_left_s = kNan;
  Eigen::Vector2d place_map_m = Eigen::Vector2d::Constant(kNan);  // nearest place, now or when it was seen last
  Utime seen = {};
  AlertSight sight = AlertSight::kSeen;
  AlertEnd end = AlertEnd::kNone;

  bool Holds() const { return state == AlertState::kActive || state == AlertState::kAcknowledged; }
  void SetState(AlertState to, Utime time) {
    if (state != to) changed = time;
    state = to;
  }
  void SetLevel(AlertLevel to, Utime time) {
    if (level != to) changed = time;
    level = to;
  }
};

struct Acknowledgement {
  Utime time;  // host time of the sender; from the tracker itself (KeptAcknowledgements) the end of the scan
  std::string source;
  std::int64_t alert_id = 0;
  Utime raised;
  std::int64_t seq = 0;  // of its message; from the tracker itself 0

  friend bool operator==(const Acknowledgement&, const Acknowledgement&) = default;
};

struct AlertParams {
  double raise_probability = 0.5;  // an alert comes up when 3 of the last 5 scans have a danger at least as likely
  double clear_probability = 0.2;  // it ends when all dangers are below this for clear_s
  double clear_s = 3.0;
};

/// The surroundings of the boat after a scan, beside the dangers.
struct Surroundings {
  std::optional<Pose> own = std::nullopt;                       // placed; nullopt: not known
  std::optional<std::span<const Track>> tracks = std::nullopt;  // nullopt: not known
};

/// Source of the states: IEC 62923-1 (bridge alert management): active, acknowledged, rectified, normal.
///
/// An alert is of a thing: guard zone and closest approach are causes of one alert, which is as grave as the graver of both.
///
/// Time goes by the message time of scans. An alert comes up, or becomes a warning, when 3 of the last 5 scans say so (one, where a known track
/// enters the guard zone). It ends, or becomes a caution, when none has said so for clear_s (1 s where the thing opens abaft) and 5 whole scans. A
/// scan that is not whole clears nothing, but its dangers count; when no scan has shown the danger for kHiddenS, all scans clear. A scan counts
/// neither way after 1 s. After a gap or a step back of more than 1 s clearing begins anew, since nobody looked.
///
/// A thing whose track has ended is lost. Its alert stays where the thing was seen last: for clear_s if beams looked there and found nothing, or if
/// the place is abaft by now; else for kHiddenS, since the thing may be hidden. A thing that is found again within kSameS, by its track id, beside
/// its last place or where it would be by now, has the same alert, acknowledged only if it is near and soon. If it has an alert of its own already,
/// the two become one.
///
/// Nothing in the guard zone stays unnoticed because its track id changes from scan to scan: each thing in the zone without an alert that holds
/// counts for the alert of kUnnamed too, unless another alert of the zone is active anyway. So when 3 of the last 5 scans show anything in the zone,
/// some alert of it holds.
///
/// Many things share the alert of land, and that of kUnnamed. So their acknowledgement is one of places (ToldPlaces): when 3 of the last 5 scans show
/// a place that is not covered, or that came much nearer, the alert is active again and tells that place.
///
/// A caution that becomes a warning wants a new acknowledgement. A warning that ends without one stays as rectified until it gets one; a caution does
/// not, nor a warning of kUnnamed when something in the zone has an alert of its own. A rectified alert that holds again is the same alert, active.
/// The newest 16 rectified alerts stay.
///
/// When all tracks are forgotten their alerts end, since no danger comes from them any more; KeptAcknowledgements holds the acknowledged ones.
class Alerts {
 public:
  static constexpr std::size_t kWindowScans = 5;
  static constexpr int kScansToRaise = 3;
  static constexpr int kScansToClear = 5;
  static constexpr std::chrono::seconds kGreatestAge{1};
  static constexpr std::size_t kMostRectified = 16;
  /// Longer than a small boat stays hidden behind another boat or a pile.
  static constexpr double kHiddenS = 10.0;
  static constexpr double kSameS = 10.0;
  /// A thing that is found again may be so far off: another part of it is seen, and it has moved on.
  static constexpr double kSamePlaceM = 3.0;

  explicit Alerts(const AlertParams& params) : params_(params) {}

  /// One scan. Call Acknowledge and Rename of that scan before.
  /// @param is_whole  no part and no packet of it was lost
  /// @param dangers   a thing without a danger has a probability of 0
  /// @return also unchanged alerts, the gravest first: those that hold, warnings, active ones, then by time, distance, id. A cleared alert is told
  /// once
  const std::vector<Alert>& Update(Utime time, bool is_whole, const std::vector<Danger>& dangers, const Surroundings& around = {});

  /// @return false where there is no such alert, of this id and raised at this time, or it wants none
  bool Acknowledge(const Acknowledgement& acknowledgement, Utime time);

  /// A thing became part of another: its alert goes with it. If both have an alert, the older one stays, as grave as the graver of both and active
  /// unless both were acknowledged; the younger one is cleared.
  void Rename(std::int64_t from_thing, std::int64_t to_thing, Utime time);

  /// The map has another datum, or began anew.
  void ForgetMap();

  /// As returned by the last Update.
  const std::vector<Alert>& alerts() const { return alerts_; }
  /// In the last Update: things whose alert goes on under another name, as they were found again (from, to).
  const std::vector<std::pair<std::int64_t, std::int64_t>>& adopted() const { return adopted_; }

 private:
  // Whether scans say that something holds: on after 3 of 5 that do, off after clear_s without one.
  struct Latch {
    struct Look {
      Utime time;
      bool says_on = false;
    };
    std::deque<Look> looks;
    bool is_on = false;
    std::optional<Utime> off_since;
    std::optional<Utime> quiet_since;  // the last scan that said on
    int num_off = 0;

    void Update(Utime time, bool is_whole, bool says_on, bool says_off, double clear_s, bool is_known = false);
    void Merge(const Latch& other) {
      is_on = is_on || other.is_on;
      if (other.quiet_since) quiet_since = quiet_since ? std::max(*quiet_since, *other.quiet_since) : other.quiet_since;
    }
    void ForgetLooks();
  };
  // The danger of a thing in a scan, by cause; nullptr: none.
  using Evidence = std::array<const Danger*, kNumCauses>;
  struct Lost {
    Utime since;
    bool is_hidden = false;
  };
  struct Entry {
    std::array<Latch, kNumCauses> causes;  // by their number, less one
    Latch warning;
    std::optional<Alert> alert;
    bool is_over = false;           // the alert's end was told
    bool was_acknowledged = false;  // the alert, when it ended
    std::optional<Lost> lost;
    // Of its track, when that was known last.
    bool was_likely = true;      // to exist
    double likely_tcpa_s = 0.0;  // time to closest approach, when the thing was last likely to come too near
    Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
    Utime placed;  // when its place was told last
    // Of things with places alone: the scans of the last second that showed some. An acknowledgement covers places that a person can have seen.
    struct Shown {
      Utime time;
      std::vector<DangerPlace> places;
    };
    std::deque<Shown> shown;
    std::optional<ToldPlaces> told;  // acknowledged places
    Latch untold;                    // whether scans show a place that is not covered

    bool IsRaised() const;
    bool HasAlert() const { return alert && !is_over; }
    bool WasLost() const;
    double DistanceTo(const Eigen::Vector2d& place_map_m, Utime time) const;
  };

  void Update(Entry& entry, std::int64_t thing, Utime time, bool is_whole, const Evidence& evidence, const Surroundings& around);
  void Tell(Entry& entry, const Evidence& evidence, Utime time) const;
  const Danger* ToldOf(const Evidence& evidence, bool comes_near) const;
  void UpdatePlaces(Entry& entry, Utime time, bool is_whole, const Evidence& evidence, const DangerPlace& last) const;
  static void LookFor(Entry& entry, std::int64_t thing, Utime time, const Evidence& evidence, const Surroundings& around);
  static void TellPlaces(Entry& entry, std::int64_t thing, const Acknowledgement& acknowledgement);
  std::optional<Danger> FindUnnamed(const std::map<std::int64_t, Evidence>& dangers) const;
  bool HasNamedInZone(bool (*is_so)(const Alert&)) const;
  void Advance(Entry& entry, std::int64_t thing, Utime time);
  void Adopt(std::int64_t thing, Utime time, const Danger& danger);
  void ClearOldestRectified(Utime time);

  AlertParams params_;
  std::map<std::int64_t, Entry> entries_;  // by thing
  std::vector<Alert> ended_;               // to be told in the next Update
  std::vector<Alert> alerts_;
  std::vector<std::pair<std::int64_t, std::int64_t>> adopted_;
  std::optional<Utime> newest_;
  std::int64_t next_id_ = 1;
};

}  // namespace lookout::tracker
