#include "lab/eval/alert_scores.hpp"

#include <algorithm>
#include <numeric>

namespace lookout::eval {

std::string_view NameOf(AlertVerdict verdict) {
  constexpr std::array<std::string_view, kNumAlertVerdicts> kNames{"right", "border", "far", "nothing", "repeated"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::string_view NameOf(DangerVerdict verdict) {
  constexpr std::array<std::string_view, kNumDangerVerdicts> kNames{"in time", "late", "missed"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::int64_t AlertScores::Num(AlertVerdict verdict) const { return Num(verdict, false) + Num(verdict, true); }

std::int64_t AlertScores::NumAlerts(bool is_warning) const {
  const auto& counts = num_alerts[is_warning ? 1 : 0];
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
}

std::int64_t AlertScores::NumAlerts() const { return NumAlerts(false) + NumAlerts(true); }

std::int64_t AlertScores::NumDangers() const { return std::accumulate(num_dangers.begin(), num_dangers.end(), std::int64_t{0}); }

void AlertScores::Add(const AlertScores& other) {
  num_runs += other.num_runs;
  num_scans += other.num_scans;
  seconds += other.seconds;
  for (std::size_t level = 0; level < num_alerts.size(); ++level) {
    for (std::size_t i = 0; i < kNumAlertVerdicts; ++i) num_alerts[level][i] += other.num_alerts[level][i];
  }
  for (std::size_t i = 0; i < kNumDangerVerdicts; ++i) num_dangers[i] += other.num_dangers[i];
  berth_s += other.berth_s;
  num_false_in_berth += other.num_false_in_berth;
  delay_s.Add(other.delay_s);
  standing.Add(other.standing);
  standing_warnings.Add(other.standing_warnings);
  most_standing = std::max(most_standing, other.most_standing);
  has_warning.Add(other.has_warning);
  sound_s += other.sound_s;
  warning_sound_s += other.warning_sound_s;
  num_watch_alerts += other.num_watch_alerts;
  num_early_alerts += other.num_early_alerts;
  num_open_dangers += other.num_open_dangers;
  num_turning_dangers += other.num_turning_dangers;
  run_in_s += other.run_in_s;
}

}  // namespace lookout::eval
