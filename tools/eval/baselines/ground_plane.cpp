#include "tools/eval/baselines/ground_plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>

namespace lookout::eval {

namespace {

using Indices = std::vector<std::size_t>;

struct Plane {
  Eigen::Vector3d normal;  // upward
  double offset_m = 0.0;   // of the plane along the normal
};

Plane FitPlane(std::span<const Eigen::Vector3d> points_m, const Indices& indices) {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const auto i : indices) mean_m += points_m[i];
  mean_m /= static_cast<double>(indices.size());
  Eigen::Matrix3d spread_m2 = Eigen::Matrix3d::Zero();
  for (const auto i : indices) spread_m2 += (points_m[i] - mean_m) * (points_m[i] - mean_m).transpose();
  // Eigenvalues come in increasing order: the normal is where the points spread least.
  Eigen::Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread_m2).eigenvectors().col(0);
  if (normal.z() < 0.0) normal = -normal;
  return {normal, normal.dot(mean_m)};
}

// Of `indices`, those lower than a height over the mean of the lowest.
Indices Seeds(std::span<const Eigen::Vector3d> points_m, const Indices& indices, const GroundPlaneParams& params) {
  std::vector<double> height_m;
  for (const auto i : indices) height_m.push_back(points_m[i].z());
  const auto num_lowest = std::min(height_m.size(), static_cast<std::size_t>(params.num_lowest));
  std::partial_sort(height_m.begin(), height_m.begin() + static_cast<std::ptrdiff_t>(num_lowest), height_m.end());
  double sum_m = 0.0;
  for (std::size_t i = 0; i < num_lowest; ++i) sum_m += height_m[i];
  const double limit_m = sum_m / static_cast<double>(num_lowest) + params.seed_height_m;
  Indices seeds;
  for (const auto i : indices) {
    if (points_m[i].z() < limit_m) seeds.push_back(i);
  }
  return seeds;
}

}  // namespace

std::vector<bool> FitGround(std::span<const Eigen::Vector3d> points_m, const GroundPlaneParams& params) {
  std::vector<bool> is_ground(points_m.size(), false);
  if (points_m.empty()) return is_ground;
  const auto [first, last] =
      std::minmax_element(points_m.begin(), points_m.end(), [](const auto& one, const auto& other) { return one.x() < other.x(); });
  const double begin_m = first->x();
  const double length_m = last->x() - begin_m;
  std::vector<Indices> segments(static_cast<std::size_t>(params.num_segments));
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const double place = length_m > 0.0 ? (points_m[i].x() - begin_m) / length_m * params.num_segments : 0.0;
    segments[std::min(segments.size() - 1, static_cast<std::size_t>(place))].push_back(i);
  }
  constexpr std::size_t kPointsOfPlane = 3;
  for (const auto& segment : segments) {
    if (segment.empty()) continue;
    auto ground = Seeds(points_m, segment, params);
    for (int iteration = 0; iteration < params.num_iterations && ground.size() >= kPointsOfPlane; ++iteration) {
      const auto plane = FitPlane(points_m, ground);
      ground.clear();
      for (const auto i : segment) {
        if (plane.normal.dot(points_m[i]) - plane.offset_m < params.max_distance_m) ground.push_back(i);
      }
    }
    for (const auto i : ground) is_ground[i] = true;
  }
  return is_ground;
}

}  // namespace lookout::eval
