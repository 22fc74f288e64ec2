#include "tools/calibrate/turn_rate.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::calibrate {

namespace {

constexpr int kMostSteps = 100;
constexpr double kShiftS = 0.01;
constexpr std::size_t kLeastTurns = 50;
// A shift that is less certain than this says nothing.
constexpr double kMaxSdS = 0.05;

std::optional<double> TurnByPose(const odometer::Motion& motion, const PoseTrack& track, double later_s) {
  const auto begin = track.At(motion.begin, later_s);
  const auto end = track.At(motion.end, later_s);
  if (!begin || !end) return std::nullopt;
  return WrapToPi(HeadingOf(end->T_map_vessel) - HeadingOf(begin->T_map_vessel));
}

// Mean of the squares of the difference; nullopt where too few motions have a pose.
std::optional<double> MeanSquare(const std::vector<odometer::Motion>& motions, const PoseTrack& track, double later_s) {
  double sum = 0.0;
  std::size_t num = 0;
  // A motion that is far off is one of another thing: it counts as this.
  constexpr double kMostRad = 0.02;
  for (const auto& motion : motions) {
    if (!motion.is_known()) continue;
    const auto turn_rad = TurnByPose(motion, track, later_s);
    if (!turn_rad) continue;
    const double difference_rad = std::min(kMostRad, std::abs(WrapToPi(motion.turn_rad - *turn_rad)));
    sum += difference_rad * difference_rad;
    ++num;
  }
  if (num < kLeastTurns) return std::nullopt;
  return sum / static_cast<double>(num);
}

}  // namespace

std::optional<TurnLatency> LatencyByTurning(const std::vector<odometer::Motion>& motions, const PoseTrack& track) {
  std::vector<std::optional<double>> squares;
  squares.reserve(2 * kMostSteps + 1);
  for (int i = -kMostSteps; i <= kMostSteps; ++i) squares.push_back(MeanSquare(motions, track, i * kShiftS));
  std::size_t best = 0;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    if (squares[i] && (!squares[best] || *squares[i] < *squares[best])) best = i;
  }
  if (!squares[best] || best == 0 || best + 1 == squares.size() || !squares[best - 1] || !squares[best + 1]) return std::nullopt;
  const double below = *squares[best - 1];
  const double least = *squares[best];
  const double above = *squares[best + 1];
  const double curvature = below - 2.0 * least + above;
  if (curvature <= 0.0) return std::nullopt;
  TurnLatency latency;
  latency.latency_s = (static_cast<double>(best) - kMostSteps + 0.5 * (below - above) / curvature) * kShiftS;
  double sum = 0.0;
  std::vector<double> rates;
  for (const auto& motion : motions) {
    const auto turn_rad = motion.is_known() ? TurnByPose(motion, track, latency.latency_s) : std::nullopt;
    if (turn_rad) rates.push_back(*turn_rad / ToSeconds(motion.end - motion.begin));
  }
  latency.num_motions = rates.size();
  for (const double rate : rates) sum += rate / static_cast<double>(rates.size());
  double variance = 0.0;
  for (const double rate : rates) variance += (rate - sum) * (rate - sum) / static_cast<double>(rates.size());
  latency.rate_rms_radps = std::sqrt(variance);
  // There are n differences with variance `least`. The second derivative of their sum of squares, halved, is n times the square of the rate's change.
  latency.sd_s = std::sqrt(least / (static_cast<double>(rates.size()) * curvature / (2.0 * kShiftS * kShiftS)));
  if (latency.sd_s > kMaxSdS) return std::nullopt;
  return latency;
}

std::vector<odometer::Motion> OdometryOf(const std::vector<odometer::Scan>& scans, const odometer::OdometerParams& params) {
  odometer::Odometer odometer(params);
  std::vector<odometer::Motion> motions;
  motions.reserve(scans.size());
  for (const auto& scan : scans) motions.push_back(odometer.Consume(scan));
  return motions;
}

}  // namespace lookout::calibrate
