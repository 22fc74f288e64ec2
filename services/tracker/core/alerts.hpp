// Alerts over time: when they come up, how grave they are, who has taken note, and when they end.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"

namespace lookout::tracker {

// Numbers of all three are those of the wire.
enum class AlertCause : std::int32_t { kGuardZone = 1, kClosestApproach = 2, kWatch = 3 };
enum class AlertLevel : std::int32_t { kCaution = 1, kWarning = 2 };
enum class AlertState : std::int32_t { kActive = 1, kAcknowledged = 2, kRectified = 3, kCleared = 4 };

struct Alert {
  std::int64_t id = 0;
  AlertCause cause = AlertCause::kGuardZone;
  AlertLevel level = AlertLevel::kCaution;
  AlertState state = AlertState::kActive;
  std::int64_t track_id = 0;  // 0: land, or none
  Utime raised;
  Utime changed;
  double distance_m = kNan;
  double bearing_rad = kNan;
  double cpa_m = kNan;
  double tcpa_s = kNan;
  double cpa_probability = kNan;
};

/// What one scan says of one possible alert.
struct Danger {
  AlertCause cause = AlertCause::kGuardZone;
  std::int64_t track_id = 0;
  double probability = 0.0;  // of a guard zone 1: it is in it
  double tcpa_s = 0.0;
  double distance_m = 0.0;
  double bearing_rad = 0.0;
  double cpa_m = kNan;
};

struct Acknowledgement {
  Utime time;  // host time of who sent it
  std::string source;
  std::int64_t alert_id = 0;
  Utime raised;
  std::int64_t seq = 0;  // of its message

  friend bool operator==(const Acknowledgement&, const Acknowledgement&) = default;
};

struct AlertParams {
  double raise_probability = 0.5;  // in 3 of the last 5 scans
  double clear_probability = 0.2;  // below it for clear_s
  double clear_s = 3.0;
  double warning_tcpa_s = 0.0;  // closer in time than this a caution becomes a warning
};

/// Source of the states: IEC 62923-1 (bridge alert management): active, acknowledged, rectified, normal.
class Alerts {
 public:
  explicit Alerts(const AlertParams& params);

  /// One whole scan (or one that lost something: then what it does not show clears nothing).
  /// @param gone  tracks that ended, or were merged into another: (from, to), to 0 where it ended. An alert goes with the track
  /// @return what changed nothing too, gravest first: warnings before cautions, active before acknowledged, then by tcpa, distance, id
  const std::vector<Alert>& Update(Utime time, bool is_whole, const std::vector<Danger>& dangers);
  /// @return false where there is no such alert, or it does not want one
  bool Acknowledge(const Acknowledgement& acknowledgement, Utime time);
  void Rename(std::int64_t from_track, std::int64_t to_track);

  const std::vector<Alert>& alerts() const { return alerts_; }

 private:
  struct Memory;
  AlertParams params_;
  std::vector<Alert> alerts_;
};

}  // namespace lookout::tracker
