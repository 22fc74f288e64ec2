#include "lab/eval/track_geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

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

// Andrew's monotone chain.
Polygon ConvexHullOf(Polygon points_m) {
  std::ranges::sort(points_m, {}, [](const Vector2d& p_m) { return std::pair(p_m.x(), p_m.y()); });
  points_m.erase(std::unique(points_m.begin(), points_m.end()), points_m.end());
  if (points_m.size() < 3) return points_m;
  Polygon hull_m;
  const auto extend = [&](const Vector2d& p_m, std::size_t least) {
    while (hull_m.size() > least && Cross(hull_m.back() - hull_m[hull_m.size() - 2], p_m - hull_m.back()) <= 0.0) hull_m.pop_back();
    hull_m.push_back(p_m);
  };
  for (const auto& p_m : points_m) extend(p_m, 1);
  const std::size_t lower = hull_m.size();
  for (std::size_t i = points_m.size() - 1; i-- > 0;) extend(points_m[i], lower);
  hull_m.pop_back();
  return hull_m;
}

Approach ApproachOf(const Polygon& own_m, const Vector2d& own_mps, const Polygon& other_m, const Vector2d& other_mps) {
  constexpr double kSlowMps = 0.02;  // slower against each other than this nothing comes nearer
  constexpr double kTouchM = 1e-4;
  constexpr int kNumHalvings = 60;
  const auto own_hull_m = ConvexHullOf(own_m);
  const auto other_hull_m = ConvexHullOf(other_m);
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
  return HullGap(ConvexHullOf(own_m), Moved(ConvexHullOf(other_m), (other_mps - own_mps) * seconds));
}

Vector2d CenterOf(const Polygon& outline_m) {
  const auto hull_m = ConvexHullOf(outline_m);
  if (hull_m.size() < 3) return BoxOf(hull_m).center();
  double least_m2 = std::numeric_limits<double>::infinity();
  Vector2d center_m = hull_m.front();
  for (std::size_t i = 0, before = hull_m.size() - 1; i < hull_m.size(); before = i++) {
    const Vector2d along = (hull_m[i] - hull_m[before]).normalized();
    const Vector2d across(-along.y(), along.x());
    Eigen::AlignedBox2d box_m;
    for (const auto& corner_m : hull_m) box_m.extend(Vector2d(along.dot(corner_m), across.dot(corner_m)));
    if (box_m.volume() >= least_m2) continue;
    least_m2 = box_m.volume();
    center_m = along * box_m.center().x() + across * box_m.center().y();
  }
  return center_m;
}

}  // namespace lookout::eval
