#include "lab/eval/baselines/f3d.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>
#include <numeric>

#include "lab/eval/baselines/point_tree.hpp"
#include "services/segmenter/core/union_find.hpp"

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

// The points of `indices` that are lower than a height over the mean of the lowest points.
Indices Seeds(std::span<const Eigen::Vector3d> points_m, const Indices& indices, const GroundPlaneParams& params) {
  std::vector<double> height_m;
  for (const auto i : indices) height_m.push_back(points_m[i].z());
  const auto num_lowest = std::min(height_m.size(), static_cast<std::size_t>(params.num_lowest));
  std::partial_sort(height_m.begin(), height_m.begin() + static_cast<std::ptrdiff_t>(num_lowest), height_m.end());
  const double sum_m = std::accumulate(height_m.begin(), height_m.begin() + static_cast<std::ptrdiff_t>(num_lowest), 0.0);
  const double limit_m = sum_m / static_cast<double>(num_lowest) + params.seed_height_m;
  Indices seeds;
  for (const auto i : indices) {
    if (points_m[i].z() < limit_m) seeds.push_back(i);
  }
  return seeds;
}

using ScanLine = std::vector<std::int32_t>;  // indices of returns, in the order of columns

bool AreNear(const segmenter::Return& one, const segmenter::Return& other, double distance_m) {
  return segmenter::SquaredDistance(one.point, other.point) < distance_m * distance_m;
}

// [begin, end) of the returns of one shot, and so of one column, in a scan line.
struct Shot {
  std::size_t begin, end;
};

std::vector<Shot> ShotsOf(const ScanLine& line, std::span<const segmenter::Return> returns) {
  std::vector<Shot> shots;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto column = returns[static_cast<std::size_t>(line[i])].column;
    if (shots.empty() || returns[static_cast<std::size_t>(line[shots.back().begin])].column != column) shots.push_back({i, i});
    shots.back().end = i + 1;
  }
  return shots;
}

void JoinRuns(const ScanLine& line, std::span<const segmenter::Return> returns, double distance_m, segmenter::UnionFind& sets) {
  const auto join = [&](const Shot& shot, const Shot& other) {
    for (std::size_t i = shot.begin; i < shot.end; ++i) {
      for (std::size_t j = other.begin; j < other.end; ++j) {
        if (AreNear(returns[static_cast<std::size_t>(line[i])], returns[static_cast<std::size_t>(line[j])], distance_m)) sets.Join(line[i], line[j]);
      }
    }
  };
  const auto shots = ShotsOf(line, returns);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    join(shots[i], shots[i]);
    join(shots[i], shots[i + 1 < shots.size() ? i + 1 : 0]);  // the last shot is merged with the first: the circle is closed
  }
}

void MergeWithRingAbove(const ScanLine& line, const ScanLine& above, std::span<const segmenter::Return> returns, double distance_m,
                        segmenter::UnionFind& sets) {
  if (line.empty() || above.empty()) return;
  std::vector<segmenter::Point> points_m;
  points_m.reserve(above.size());
  for (const auto index : above) points_m.push_back(returns[static_cast<std::size_t>(index)].point);
  const PointTree tree(std::move(points_m));
  for (const auto index : line) {
    const auto nearest = tree.FindNearest(returns[static_cast<std::size_t>(index)].point);
    if (nearest && nearest->distance_m < distance_m) sets.Join(index, above[static_cast<std::size_t>(nearest->index)]);
  }
}

segmenter::Groups Group(const F3dParams& params, const Eigen::Isometry3d& T_vessel_lidar, const segmenter::Scan& scan,
                        std::span<const segmenter::Return> returns, StageClock& clock) {
  std::vector<bool> is_ground(returns.size(), false);
  if (params.ground) {
    std::vector<Eigen::Vector3d> p_vessel_m;
    p_vessel_m.reserve(returns.size());
    for (const auto& one : returns) {
      p_vessel_m.emplace_back(T_vessel_lidar * Eigen::Vector3d(one.point.x_m, one.point.y_m, one.point.z_m));
    }
    is_ground = FitGround(p_vessel_m, *params.ground);
    clock.End("ground");
  }
  std::vector<ScanLine> lines(static_cast<std::size_t>(scan.head.num_rings()));
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (!is_ground[i]) lines[static_cast<std::size_t>(returns[i].ring)].push_back(static_cast<std::int32_t>(i));
  }
  segmenter::UnionFind sets(returns.size());
  for (const auto& line : lines) JoinRuns(line, returns, params.run_distance_m, sets);
  clock.End("runs");
  for (std::size_t ring = lines.size(); ring > 1; --ring) {
    MergeWithRingAbove(lines[ring - 2], lines[ring - 1], returns, params.merge_distance_m, sets);
  }
  clock.End("merging");

  segmenter::Groups groups;
  groups.of_return.assign(returns.size(), segmenter::Groups::kNone);
  // The root of a set is its least member, so it has its group before the others ask for it.
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (is_ground[i]) continue;
    const auto root = static_cast<std::size_t>(sets.Find(static_cast<std::int32_t>(i)));
    groups.of_return[i] = root == i ? groups.count++ : groups.of_return[root];
  }
  return groups;
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

Grouping F3dGrouping(const F3dParams& params, const Eigen::Isometry3d& T_vessel_lidar) {
  return [params, T_vessel_lidar](const segmenter::Scan& scan, std::span<const segmenter::Return> returns, StageClock& clock) {
    return Group(params, T_vessel_lidar, scan, returns, clock);
  };
}

}  // namespace lookout::eval
