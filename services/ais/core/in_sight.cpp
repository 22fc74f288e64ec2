#include "services/ais/core/in_sight.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/core/elementary.hpp"
#include "common/core/outlines.hpp"

namespace lookout::ais {

namespace {

constexpr double kDeviations = 2.0;
constexpr double kUnknownHalfLengthM = 4.0;
constexpr int kNumRays = 15;
constexpr double kFreeShare = 0.8;
// Cells of the land memory have some such size.
constexpr double kShoreRadiusM = 1.0;
// Older places are those of ships that may have left their berth since.
constexpr double kMostAgeS = 200.0;
constexpr double kMostAgeUnderWayS = 40.0;
constexpr double kHasWayMps = 1.0;

struct Ray {
  Eigen::Vector2d from_m;
  Eigen::Vector2d direction;
};

// Whether the ray meets the outline nearer than `range_m`.
bool IsStopped(const Ray& ray, const std::vector<Eigen::Vector2d>& outline_m, double range_m) {
  for (std::size_t i = 0; i < outline_m.size(); ++i) {
    const Eigen::Vector2d a = outline_m[i] - ray.from_m;
    const Eigen::Vector2d b = outline_m[(i + 1) % outline_m.size()] - ray.from_m;
    const double side_a = Cross(ray.direction, a);
    const double side_b = Cross(ray.direction, b);
    if ((side_a > 0.0) == (side_b > 0.0) || side_a == side_b) continue;
    const double share = side_a / (side_a - side_b);
    const double along_m = ray.direction.dot(a + share * (b - a));
    if (along_m > 0.0 && along_m < range_m) return true;
  }
  return false;
}

bool IsStoppedByShore(const Ray& ray, std::span<const Eigen::Vector2d> shore_m, double range_m) {
  return std::ranges::any_of(shore_m, [&](const Eigen::Vector2d& cell_m) {
    const Eigen::Vector2d to_m = cell_m - ray.from_m;
    const double along_m = ray.direction.dot(to_m);
    return along_m > 0.0 && along_m < range_m && std::abs(Cross(ray.direction, to_m)) < kShoreRadiusM;
  });
}

}  // namespace

bool ShouldBeSeen(const ShipInReach& ship, const Place& own, std::span<const TrackedThing> tracks, std::span<const Eigen::Vector2d> shore_m,
                  const SightParams& params) {
  const auto& predicted = ship.predicted;
  if (ship.ship->is_virtual || !predicted.velocity_map_mps.allFinite()) return false;
  if (predicted.age_s > (predicted.velocity_map_mps.norm() > kHasWayMps ? kMostAgeUnderWayS : kMostAgeS)) return false;
  const double half_length_m = std::isnan(ship.ship->dimensions.length_m()) ? kUnknownHalfLengthM : 0.5 * ship.ship->dimensions.length_m();
  const double sd_m = std::sqrt(0.5 * predicted.covariance_m2.trace());
  const double reach_m = half_length_m + kDeviations * sd_m;

  // The lidar in the map, seen from above.
  const auto [sin, cos] = SinCosOf(own.heading_rad);
  const Eigen::Vector2d bow = cos * own.R_map_here.col(1).head<2>() + sin * own.R_map_here.col(0).head<2>();
  const Eigen::Vector2d port(-bow.y(), bow.x());
  const Eigen::Vector3d p_vessel_m = params.T_vessel_lidar.translation();
  const Eigen::Vector2d lidar_m = own.position_map_m.head<2>() + p_vessel_m.x() * bow + p_vessel_m.y() * port;
  const Eigen::Vector2d to_m = predicted.center_map_m - lidar_m;
  const double range_m = to_m.norm();
  if (range_m + kDeviations * sd_m > params.range_m || range_m - reach_m < params.min_range_m) return false;
  if (std::ranges::any_of(shore_m, [&](const auto& cell_m) { return (cell_m - predicted.center_map_m).norm() < reach_m; })) return false;

  const Eigen::Vector2d ahead = to_m / range_m;
  const Eigen::Vector2d aside(-ahead.y(), ahead.x());
  int num_free = 0;
  for (int i = 0; i < kNumRays; ++i) {
    const double share = 2.0 * i / (kNumRays - 1) - 1.0;
    const Ray ray{lidar_m, (range_m * ahead + share * reach_m * aside).normalized()};
    // In the lidar frame, of which all but the turn about the vertical is small.
    const Eigen::Vector3d ray_vessel(ray.direction.dot(bow), ray.direction.dot(port), 0.0);
    const Eigen::Vector3d ray_lidar = params.T_vessel_lidar.linear().transpose() * ray_vessel;
    if (!params.field_of_view.Contains(WrapTo2Pi(Atan2(ray_lidar.y(), ray_lidar.x())))) continue;
    const double before_m = range_m - half_length_m;
    const bool is_stopped = std::ranges::any_of(tracks, [&](const auto& track) { return IsStopped(ray, track.outline_map_m, before_m); });
    if (!is_stopped && !IsStoppedByShore(ray, shore_m, range_m)) ++num_free;
  }
  return num_free >= kFreeShare * kNumRays;
}

}  // namespace lookout::ais
