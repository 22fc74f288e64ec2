#include "tools/calibrate/waterline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/core/frames.hpp"

namespace lookout::calibrate {

namespace {

constexpr std::size_t kEveryScan = 3;
constexpr double kMaxFootRangeM = 40.0;
// Two rings that meet an upright face are as far away, seen from above.
constexpr double kUprightM = 0.15;
constexpr double kWidestM = 1.5;
// Voting: heights from 0 to 40 m.
constexpr double kBinM = 0.01;
constexpr std::size_t kNumBins = 4000;
// The middle of the heights with nearly as many votes as the most counts.
constexpr double kNearlyMost = 0.97;
constexpr std::size_t kLeastFeet = 500;
constexpr std::size_t kNumParts = 8;
constexpr std::size_t kLeastParts = 5;
// Banks that lean, fenders, and the width of the beam.
constexpr double kLeastSdM = 0.03;

// The lidar is between so high above the water.
struct Foot {
  double from_m = 0.0;
  double to_m = 0.0;
  std::size_t part = 0;  // of the time
};

class FootFinder {
 public:
  FootFinder(const odometer::Scan& scan, const TrackPose& pose, const Assumed& assumed)
      : scan_(scan), R_map_lidar_(pose.T_map_vessel.linear() * assumed.T_vessel_lidar.linear()), min_range_m_(assumed.min_range_m) {
    // How far the swinging boat has lifted the lidar.
    const Eigen::Vector3d p_lidar_m = assumed.T_vessel_lidar.translation();
    lift_m_ = (pose.T_map_vessel.linear() * p_lidar_m).z() - p_lidar_m.z() + pose.heave_m;
    order_.resize(scan.rings.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    if (assumed.T_vessel_lidar.linear()(2, 2) < 0.0) std::ranges::reverse(order_);
  }

  void AddTo(std::vector<Foot>& feet, std::size_t part) const {
    for (std::size_t column = 0; column < scan_.azimuth_rad.size(); ++column) {
      std::size_t lowest = 0;
      while (lowest < order_.size() && RangeM(column, lowest) <= 0.0) ++lowest;
      if (lowest == 0 || lowest + 1 >= order_.size()) continue;
      const double range_m = RangeM(column, lowest);
      const double above_m = RangeM(column, lowest + 1);
      if (range_m < min_range_m_ || range_m > kMaxFootRangeM || above_m <= 0.0) continue;
      const Eigen::Vector3d foot = Direction(column, lowest);
      const Eigen::Vector3d next = Direction(column, lowest + 1);
      const double level_m = range_m * foot.head<2>().norm();
      if (std::abs(above_m * next.head<2>().norm() - level_m) > kUprightM) continue;
      const Eigen::Vector3d below = Direction(column, lowest - 1);
      const double hit_z_m = range_m * foot.z() + lift_m_;
      const double missed_z_m = level_m * below.z() / below.head<2>().norm() + lift_m_;
      if (hit_z_m <= missed_z_m || hit_z_m - missed_z_m > kWidestM) continue;
      feet.push_back({-hit_z_m, -missed_z_m, part});
    }
  }

 private:
  double RangeM(std::size_t column, std::size_t place) const { return scan_.range[column * scan_.rings.size() + order_[place]] * scan_.range_unit_m; }
  // Along the axes of the map.
  Eigen::Vector3d Direction(std::size_t column, std::size_t place) const {
    const auto& ring = scan_.rings[order_[place]];
    return R_map_lidar_ * BeamDirection(scan_.azimuth_rad[column] + ring.azimuth_offset_rad, ring.elevation_rad);
  }

  const odometer::Scan& scan_;
  Eigen::Matrix3d R_map_lidar_;
  double min_range_m_;
  double lift_m_ = 0.0;
  std::vector<std::size_t> order_;  // rings from the lowest up
};

// The height that lies between the bounds of most feet, without the feet of one part of the time (kNumParts: with all).
double VotedHeightM(const std::vector<Foot>& feet, std::size_t without) {
  std::vector<double> steps(kNumBins + 1, 0.0);
  for (const auto& foot : feet) {
    if (foot.part == without || foot.to_m <= 0.0) continue;
    const auto bin = [](double height_m) { return static_cast<std::size_t>(std::clamp(height_m / kBinM, 0.0, static_cast<double>(kNumBins))); };
    const double weight = 1.0 / std::max(0.1, foot.to_m - foot.from_m);
    steps[bin(foot.from_m)] += weight;
    steps[bin(foot.to_m)] -= weight;
  }
  std::partial_sum(steps.begin(), steps.end(), steps.begin());
  const double most = *std::ranges::max_element(steps);
  double sum = 0.0;
  double num = 0.0;
  for (std::size_t i = 0; i < kNumBins; ++i) {
    if (steps[i] < kNearlyMost * most) continue;
    sum += (static_cast<double>(i) + 0.5) * kBinM;
    num += 1.0;
  }
  return num > 0.0 ? sum / num : 0.0;
}

}  // namespace

std::optional<WaterHeight> HeightAboveWater(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed) {
  constexpr double kLeastLevel = 0.9;
  if (scans.empty() || std::abs(assumed.T_vessel_lidar.linear()(2, 2)) < kLeastLevel) return std::nullopt;
  std::vector<Foot> feet;
  for (std::size_t i = 0; i < scans.size(); i += kEveryScan) {
    const Utime middle = scans[i].time + (scans[i].end_time - scans[i].time) / 2;
    const auto pose = track.At(middle, assumed.latency);
    if (pose) FootFinder(scans[i], *pose, assumed).AddTo(feet, i * kNumParts / scans.size());
  }
  std::array<std::size_t, kNumParts> num_of_part{};
  for (const auto& foot : feet) ++num_of_part.at(foot.part);
  const auto is_filled = [](std::size_t num) { return num >= kLeastFeet / kNumParts; };
  if (feet.size() < kLeastFeet || std::cmp_less(std::ranges::count_if(num_of_part, is_filled), kLeastParts)) return std::nullopt;
  WaterHeight height;
  height.num_feet = feet.size();
  height.lidar_above_water_m = VotedHeightM(feet, kNumParts);
  double mean_m = 0.0;
  std::array<double, kNumParts> without_m{};
  for (std::size_t part = 0; part < kNumParts; ++part) mean_m += (without_m.at(part) = VotedHeightM(feet, part)) / kNumParts;
  double squares_m2 = 0.0;
  for (const double one_m : without_m) squares_m2 += (one_m - mean_m) * (one_m - mean_m);
  height.sd_m = std::max(kLeastSdM, std::sqrt(squares_m2 * (kNumParts - 1) / kNumParts));
  return height;
}

}  // namespace lookout::calibrate
