#include "lab/eval/tracks/alert_scores.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace lookout::eval {
namespace {

// All but the events and the greatest count.
auto AdditiveOfAlerts(auto& scores) {
  return std::tie(scores.num_runs, scores.num_scans, scores.seconds, scores.num_alerts, scores.num_faults, scores.num_dangers, scores.berth_s,
                  scores.num_false_in_berth, scores.delay_s, scores.standing, scores.standing_warnings, scores.has_warning, scores.sound_s,
                  scores.warning_sound_s, scores.sounding_s, scores.warning_sounding_s, scores.num_watch_alerts, scores.num_early_alerts,
                  scores.num_open_dangers, scores.num_turning_dangers, scores.run_in_s);
}

}  // namespace

std::string_view NameOf(AlertVerdict verdict) {
  constexpr std::array<std::string_view, kNumAlertVerdicts> kNames{"right", "border", "far", "nothing", "repeated"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::string_view NameOf(AlertFault fault) {
  constexpr std::array<std::string_view, kNumAlertFaults> kNames{"",         "piece moves", "standing moves", "other course", "nothing there",
                                                                 "too near", "two tracks",  "told again"};
  return kNames[static_cast<std::size_t>(fault)];
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
  AddEach(AdditiveOfAlerts(*this), AdditiveOfAlerts(other));
  most_standing = std::max(most_standing, other.most_standing);
}

}  // namespace lookout::eval
