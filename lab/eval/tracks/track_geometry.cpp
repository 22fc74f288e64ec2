#include "lab/eval/tracks/track_geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "common/core/outlines.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

Eigen::AlignedBox2d BoxOf(const Polygon& polygon_m) {
  Eigen::AlignedBox2d box_m;
  for (const auto& corner_m : polygon_m) box_m.extend(corner_m);
  return box_m;
}

Polygon Moved(Polygon polygon_m, const Vector2d& by_m) {
  for (auto& corner_m : polygon_m) corner_m += by_m;
  return polygon_m;
}

}  // namespace

double HullGap(const Polygon& one_m, const Polygon& other_m, double enough_m) {
  const double box_gap_m = std::sqrt(BoxOf(one_m).squaredExteriorDistance(BoxOf(other_m)));
  if (box_gap_m > enough_m) return box_gap_m;
  return GapBetween(one_m, other_m);
}

Approach ApproachOf(const Polygon& own_m, const Vector2d& own_mps, const Polygon& other_m, const Vector2d& other_mps) {
  constexpr double kSlowMps = 0.02;  // slower against each other than this nothing comes nearer
  constexpr double kTouchM = 1e-4;
  constexpr int kNumHalvings = 60;
  const auto own_hull_m = ConvexHull(own_m);
  const auto other_hull_m = ConvexHull(other_m);
  const Vector2d relative_mps = other_mps - own_mps;
  const auto gap_at = [&](double time_s) { return HullGap(own_hull_m, Moved(other_hull_m, relative_mps * time_s)); };
  if (relative_mps.norm() < kSlowMps) return {gap_at(0.0), 0.0};
  double begin_s = 0.0;
  double end_s = kMaxLookAheadS;
  for (int i = 0; i < kNumHalvings && end_s - begin_s > 1e-5; ++i) {
    const double third_s = (end_s - begin_s) / 3.0;
    // At equal gaps the earlier time is kept: where the hulls touch, the first time is looked for below.
    if (gap_at(begin_s + third_s) <= gap_at(end_s - third_s)) {
      end_s -= third_s;
    } else {
      begin_s += third_s;
    }
  }
  const double nearest_s = (begin_s + end_s) / 2.0;
  const double now_m = gap_at(0.0);
  const double nearest_m = gap_at(nearest_s);
  if (now_m <= nearest_m) return {now_m, 0.0};
  if (nearest_m > kTouchM) return {nearest_m, nearest_s};
  double apart_s = 0.0;
  double touching_s = nearest_s;
  for (int i = 0; i < kNumHalvings; ++i) {
    const double middle_s = (apart_s + touching_s) / 2.0;
    (gap_at(middle_s) > kTouchM ? apart_s : touching_s) = middle_s;
  }
  return {0.0, touching_s};
}

double GapAfter(double seconds, const Polygon& own_m, const Vector2d& own_mps, const Polygon& other_m, const Vector2d& other_mps) {
  return HullGap(ConvexHull(own_m), Moved(ConvexHull(other_m), (other_mps - own_mps) * seconds));
}

Vector2d CenterOf(const Polygon& outline_m) { return RectangleAround(ConvexHull(outline_m)).center_m; }

}  // namespace lookout::eval
