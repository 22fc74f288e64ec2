// Scores of alerts on runs: additive over runs, scenes and worlds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "lab/eval/metrics.hpp"

namespace lookout::eval {

/// Verdict on an alert when it comes up. ALERTS.md defines each.
enum class AlertVerdict { kRight, kBorder, kFar, kNothing, kRepeated };
inline constexpr std::size_t kNumAlertVerdicts = 5;
std::string_view NameOf(AlertVerdict verdict);

/// Why an alert is far, nothing or repeated: the look-out's belief compared with the truth. ALERTS.md defines each.
enum class AlertFault { kNone, kPieceMoves, kStandingMoves, kOtherCourse, kNothingThere, kTooNear, kTwoTracks, kToldAgain };
inline constexpr std::size_t kNumAlertFaults = 8;
std::string_view NameOf(AlertFault fault);

/// Verdict on a danger.
enum class DangerVerdict { kInTime, kLate, kMissed };
inline constexpr std::size_t kNumDangerVerdicts = 3;
std::string_view NameOf(DangerVerdict verdict);

/// An alert or a danger of one run, for lists.
struct AlertEvent {
  double second = 0.0;  // of the run, when the alert came up, or when the danger could be known
  std::string what;     // name of the verdict
  bool is_danger = false;
  std::string level;          // "warning", "caution": the graver that the alert had; empty of a danger
  std::string cause;          // "zone", "approach", "zone+approach"; empty of a danger
  std::int64_t alert_id = 0;  // of a danger the first that told it; 0 = none
  std::int64_t track_id = 0;
  std::string thing;  // name; empty: none
  std::string kind;
  double distance_m = std::numeric_limits<double>::quiet_NaN();  // true, hull to hull
  double approach_m = std::numeric_limits<double>::quiet_NaN();  // true; infinite: both stand
  double told_distance_m = std::numeric_limits<double>::quiet_NaN();
  double told_bearing_rad = std::numeric_limits<double>::quiet_NaN();
  double delay_s = std::numeric_limits<double>::quiet_NaN();  // of a danger; infinite: missed
  AlertFault fault = AlertFault::kNone;
  double true_speed_mps = std::numeric_limits<double>::quiet_NaN();  // over ground
  double told_speed_mps = std::numeric_limits<double>::quiet_NaN();
  double existence_probability = std::numeric_limits<double>::quiet_NaN();  // of the alert's track
  std::string text;
};

struct AlertScores {
  std::int64_t num_runs = 0;
  std::int64_t num_scans = 0;
  double seconds = 0.0;

  /// By level (caution, warning: the graver that the alert had while it held) and verdict.
  std::array<std::array<std::int64_t, kNumAlertVerdicts>, 2> num_alerts{};
  /// Causes of alerts that are far, nothing or repeated.
  std::array<std::array<std::int64_t, kNumAlertFaults>, kNumAlertVerdicts> num_faults{};
  /// While the own boat stood: how long, and alerts that came up then and are far or nothing.
  double berth_s = 0.0;
  std::int64_t num_false_in_berth = 0;
  std::array<std::int64_t, kNumDangerVerdicts> num_dangers{};
  Summary delay_s;  // of dangers: from when it can be known to its alert; infinite: missed

  Mean standing;  // alerts that hold, a scan
  Mean standing_warnings;
  std::int64_t most_standing = 0;
  Mean has_warning;              // share of scans
  double sound_s = 0.0;          // some alert holds and is not acknowledged
  double warning_sound_s = 0.0;  // some warning
  // As ALERTS let it ring: an alert, a warning.
  double sounding_s = 0.0;
  double warning_sounding_s = 0.0;

  // Left out.
  std::int64_t num_watch_alerts = 0;     // that nobody looks
  std::int64_t num_early_alerts = 0;     // before the truth and the boat's map were known
  std::int64_t num_open_dangers = 0;     // the run ended before it was known whether they are told in time
  std::int64_t num_turning_dangers = 0;  // by the tangent of a turn alone
  double run_in_s = 0.0;                 // after the own boat went through a thing, as a simulated one may: no lidar sees that so

  std::vector<AlertEvent> events;  // of one run: not added

  std::int64_t Num(AlertVerdict verdict) const;
  std::int64_t Num(AlertVerdict verdict, bool is_warning) const { return num_alerts[is_warning ? 1 : 0][static_cast<std::size_t>(verdict)]; }
  std::int64_t Num(AlertVerdict verdict, AlertFault fault) const {
    return num_faults[static_cast<std::size_t>(verdict)][static_cast<std::size_t>(fault)];
  }
  std::int64_t Num(DangerVerdict verdict) const { return num_dangers[static_cast<std::size_t>(verdict)]; }
  std::int64_t NumAlerts() const;
  std::int64_t NumAlerts(bool is_warning) const;
  std::int64_t NumFalse() const { return Num(AlertVerdict::kFar) + Num(AlertVerdict::kNothing); }
  std::int64_t NumFalse(bool is_warning) const { return Num(AlertVerdict::kFar, is_warning) + Num(AlertVerdict::kNothing, is_warning); }
  std::int64_t NumDangers() const;

  void Add(const AlertScores& other);
};

}  // namespace lookout::eval
