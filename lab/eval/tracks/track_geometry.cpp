#include "lab/eval/tracks/track_geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "common/core/convex.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

Eigen::AlignedBox2d BoxOf(const Polygon& polygon_m) {
  Eigen::AlignedBox2d box_m;
  for (const auto& corner_m : polygon_m) box_m.extend(corner_m);
  return box_m;
}

// The inside is not looked at where a polygon has none.
double DistanceTo(const Vector2d& p_m, const Polygon& polygon_m) {
  const auto distance = DistanceToOutline(p_m, polygon_m);
  return polygon_m.size() > 2 ? distance.outside_m : distance.edge_m;
}

// Whether two edges cross in a point that is inside of both.
bool DoCross(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const double side_c = Cross(b - a, c - a);
  const double side_d = Cross(b - a, d - a);
  const double side_a = Cross(d - c, a - c);
  const double side_b = Cross(d - c, b - c);
  return ((side_c > 0.0) != (side_d > 0.0)) && ((side_a > 0.0) != (side_b > 0.0)) && side_c != 0.0 && side_d != 0.0 && side_a != 0.0 && side_b != 0.0;
}

bool DoOutlinesCross(const Polygon& one_m, const Polygon& other_m) {
  for (std::size_t i = 0, before_i = one_m.size() - 1; i < one_m.size(); before_i = i++) {
    for (std::size_t k = 0, before_k = other_m.size() - 1; k < other_m.size(); before_k = k++) {
      if (DoCross(one_m[before_i], one_m[i], other_m[before_k], other_m[k])) return true;
    }
  }
  return false;
}

Polygon Moved(Polygon polygon_m, const Vector2d& by_m) {
  for (auto& corner_m : polygon_m) corner_m += by_m;
  return polygon_m;
}

}  // namespace

double HullGap(const Polygon& one_m, const Polygon& other_m, double enough_m) {
  const auto box_m = BoxOf(one_m);
  const auto other_box_m = BoxOf(other_m);
  const double box_gap_m = std::sqrt(box_m.squaredExteriorDistance(other_box_m));
  if (box_gap_m > enough_m) return box_gap_m;
  double gap_m = std::numeric_limits<double>::infinity();
  for (const auto& corner_m : one_m) gap_m = std::min(gap_m, DistanceTo(corner_m, other_m));
  for (const auto& corner_m : other_m) gap_m = std::min(gap_m, DistanceTo(corner_m, one_m));
  if (gap_m > 0.0 && box_gap_m == 0.0 && DoOutlinesCross(one_m, other_m)) return 0.0;
  return gap_m;
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
    // Of equals the earlier: where they touch, the first time is looked for below.
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
