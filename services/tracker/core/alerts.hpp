// Alerts over time: when they come up, how grave they are, who has taken note, and when they end.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/told_places.hpp"

namespace lookout::tracker {

// Numbers of all three are those of the wire.
enum class AlertCause : std::int32_t { kGuardZone = 1, kClosestApproach = 2, kWatch = 3 };
enum class AlertLevel : std::int32_t { kCaution = 1, kWarning = 2 };
enum class AlertState : std::int32_t { kActive = 1, kAcknowledged = 2, kRectified = 3, kCleared = 4 };

// As the track of an alert or a danger: land; and what is in the guard zone and is no track yet, or has no place on the map.
inline constexpr std::int64_t kLandTrack = 0;
inline constexpr std::int64_t kUnnamed = -1;
// Those of -2 and below are tentative tracks; from here down they are parts of the guard zone that nobody looks into.
inline constexpr std::int64_t kFirstUnseenId = -1'000'000;
// What many things share.
constexpr bool IsOfPlaces(std::int64_t track_id) { return track_id == kLandTrack || track_id == kUnnamed || track_id <= kFirstUnseenId; }

struct Alert {
  std::int64_t id = 0;
  AlertCause cause = AlertCause::kGuardZone;
  AlertLevel level = AlertLevel::kCaution;
  AlertState state = AlertState::kActive;
  std::int64_t track_id = kLandTrack;
  Utime raised;
  Utime changed;
  double distance_m = kNan;
  double bearing_rad = kNan;
  double cpa_m = kNan;
  double tcpa_s = kNan;
  double cpa_probability = kNan;

  bool Holds() const { return state == AlertState::kActive || state == AlertState::kAcknowledged; }
};

/// What one scan says of one possible alert.
struct Danger {
  AlertCause cause = AlertCause::kGuardZone;
  std::int64_t track_id = kLandTrack;
  double probability = 0.0;  // of a guard zone 1: it is in it
  double tcpa_s = 0.0;       // 0: they part, or hardly move
  double distance_m = 0.0;
  double bearing_rad = 0.0;
  double cpa_m = kNan;
  bool is_inside = false;                // the zone, or nearer than the limit, now
  std::vector<DangerPlace> places = {};  // in the guard zone; of land and of what has no track, at least one: so far an acknowledgement goes
};

struct Acknowledgement {
  Utime time;  // host time of who sent it; of the tracker itself (KeptAcknowledgements) the end of the scan
  std::string source;
  std::int64_t alert_id = 0;
  Utime raised;
  std::int64_t seq = 0;  // of its message; of the tracker itself 0

  friend bool operator==(const Acknowledgement&, const Acknowledgement&) = default;
};

struct AlertParams {
  double raise_probability = 0.5;  // in 3 of the last 5 scans
  double clear_probability = 0.2;  // below it for clear_s
  double clear_s = 3.0;
  double warning_tcpa_s = 0.0;  // closer in time than this, or inside now, a caution becomes a warning
};

/// Source of the states: IEC 62923-1 (bridge alert management): active, acknowledged, rectified, normal.
///
/// Time goes by the message time of scans. On and off have hysteresis, and so has the level: what says "on" or "warning" must do so in 3 of the last
/// 5 scans, and must not for clear_s and 5 whole scans. A scan that is not whole clears nothing, but what it shows counts; scans older than 1 s count
/// neither way; after a gap or a step back of more than 1 s clearing begins anew, since nobody looked.
///
/// Nothing is in the guard zone unnoticed because it is named now so, now otherwise: what is in it and has no alert that holds counts for the alert
/// of kUnnamed too, unless another of that cause is active anyway. So where 3 of the last 5 scans show anything in the zone, some alert of it holds.
///
/// No track names land, nor what is of kUnnamed: many things share one alert of these. So there an acknowledgement is one of places (ToldPlaces):
/// where 3 of the last 5 scans show a place that was not told, or that came much nearer, the alert is active again and tells of that place.
///
/// A caution that becomes a warning wants a new acknowledgement. A warning that ends without one stays as rectified until it gets one; a caution does
/// not, nor one of kUnnamed where something in the zone has an alert of its own. What holds again meanwhile is the same alert, active. Of rectified
/// ones the newest 16 stay.
///
/// Where tracks are forgotten their alerts end by themselves, since no danger comes of them any more; KeptAcknowledgements knows what people took
/// note of.
class Alerts {
 public:
  static constexpr std::size_t kWindowScans = 5;
  static constexpr int kScansToRaise = 3;
  static constexpr int kScansToClear = 5;
  static constexpr std::chrono::seconds kGreatestAge{1};
  static constexpr std::size_t kMostRectified = 16;

  explicit Alerts(const AlertParams& params) : params_(params) {}

  /// One scan. Call Acknowledge and Rename of that scan before.
  /// @param is_whole  no part and no packet of it was lost
  /// @param dangers   what is not among them has a probability of 0
  /// @return also what did not change, the gravest first: what holds, warnings, active ones, then by tcpa, distance, id. A cleared alert is told once
  const std::vector<Alert>& Update(Utime time, bool is_whole, const std::vector<Danger>& dangers);

  /// @return false where there is no such alert, of this id and raised at this time, or it wants none
  bool Acknowledge(const Acknowledgement& acknowledgement, Utime time);

  /// A track became part of another: its alerts go with it. Where the other has one of the same cause, the older one stays, as grave as the graver
  /// and active unless both were acknowledged; the other is cleared. (A track that ended needs no call: no danger comes of it any more.)
  void Rename(std::int64_t from_track, std::int64_t to_track, Utime time);

  /// The map has another datum, or began anew.
  void ForgetMap();

  /// As returned by the last Update.
  const std::vector<Alert>& alerts() const { return alerts_; }

 private:
  // On and off with hysteresis.
  struct Latch {
    struct Look {
      Utime time;
      bool says_on = false;
    };
    std::deque<Look> looks;
    bool is_on = false;
    std::optional<Utime> off_since;
    int num_off = 0;

    void Update(Utime time, bool is_whole, bool says_on, bool says_off, double clear_s);
    void ForgetLooks();
  };
  struct Entry {
    Latch raised;
    Latch warning;
    std::optional<Alert> alert;
    // Of land and of kUnnamed alone.
    // The scans of the last second that showed any: an acknowledgement is of what a person can have seen.
    struct Shown {
      Utime time;
      std::vector<DangerPlace> places;
    };
    std::deque<Shown> shown;
    std::optional<ToldPlaces> told;  // acknowledged
    Latch untold;                    // scans that showed a place that is not
  };
  using Key = std::pair<AlertCause, std::int64_t>;  // and track
  static constexpr Key kUnnamedKey{AlertCause::kGuardZone, kUnnamed};

  void Update(Entry& entry, const Key& key, Utime time, bool is_whole, const Danger* danger);
  void UpdatePlaces(Entry& entry, Utime time, bool is_whole, const Danger& danger) const;
  static void TellPlaces(Entry& entry, const Key& key, const Acknowledgement& acknowledgement);
  std::optional<Danger> FindUnnamed(const std::map<Key, const Danger*>& dangers) const;
  bool HasNamedInZone(bool (*is_so)(const Alert&)) const;
  void Advance(Entry& entry, const Key& key, Utime time);
  void ClearOldestRectified(Utime time);

  AlertParams params_;
  std::map<Key, Entry> entries_;
  std::vector<Alert> ended_;  // to be told in the next Update
  std::vector<Alert> alerts_;
  std::optional<Utime> newest_;
  std::int64_t next_id_ = 1;
};

}  // namespace lookout::tracker
