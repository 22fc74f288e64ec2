#include "common/core/outlines.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout {

namespace {

bool DoCross(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m, const Eigen::Vector2d& c_m, const Eigen::Vector2d& d_m) {
  const Eigen::Vector2d ab_m = b_m - a_m;
  const Eigen::Vector2d cd_m = d_m - c_m;
  return Cross(ab_m, c_m - a_m) * Cross(ab_m, d_m - a_m) < 0.0 && Cross(cd_m, a_m - c_m) * Cross(cd_m, b_m - c_m) < 0.0;
}

// A place within the four outermost places is no corner (Akl and Toussaint).
void DropInner(std::vector<Eigen::Vector2d>& places_m) {
  constexpr std::size_t kFew = 32;
  if (places_m.size() < kFew) return;
  std::array<Eigen::Vector2d, 4> outer;  // counter-clockwise
  const auto farthest = [&places_m](double x, double y) {
    return *std::ranges::max_element(places_m, {}, [x, y](const Eigen::Vector2d& place_m) { return x * place_m.x() + y * place_m.y(); });
  };
  outer = {farthest(1.0, 0.0), farthest(0.0, 1.0), farthest(-1.0, 0.0), farthest(0.0, -1.0)};
  std::erase_if(places_m, [&outer](const Eigen::Vector2d& place_m) {
    for (std::size_t i = 0; i < outer.size(); ++i) {
      if (Cross(outer.at((i + 1) % outer.size()) - outer.at(i), place_m - outer.at(i)) <= 0.0) return false;
    }
    return true;
  });
}

}  // namespace

double DistanceToEdge(const Eigen::Vector2d& p_m, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
  const Eigen::Vector2d edge_m = to_m - from_m;
  const double length2_m2 = edge_m.squaredNorm();
  const double share = length2_m2 > 0.0 ? std::clamp((p_m - from_m).dot(edge_m) / length2_m2, 0.0, 1.0) : 0.0;
  return (p_m - from_m - share * edge_m).norm();
}

bool Contains(const std::vector<Eigen::Vector2d>& outline_m, const Eigen::Vector2d& p_m) {
  bool is_inside = false;
  for (std::size_t i = 0; i < outline_m.size(); ++i) {
    const Eigen::Vector2d& a_m = outline_m[i];
    const Eigen::Vector2d& b_m = outline_m[i + 1 < outline_m.size() ? i + 1 : 0];
    if ((a_m.y() > p_m.y()) == (b_m.y() > p_m.y())) continue;
    // An edge to the east of the point that crosses its northing.
    if (p_m.x() < a_m.x() + (p_m.y() - a_m.y()) / (b_m.y() - a_m.y()) * (b_m.x() - a_m.x())) is_inside = !is_inside;
  }
  return is_inside;
}

double GapBetween(const std::vector<Eigen::Vector2d>& one_m, const std::vector<Eigen::Vector2d>& other_m) {
  if (one_m.empty() || other_m.empty()) return std::numeric_limits<double>::infinity();
  // Without crossing edges either one holds the other as a whole, or they are apart.
  if (Contains(one_m, other_m[0]) || Contains(other_m, one_m[0])) return 0.0;
  double distance_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < one_m.size(); ++i) {
    const Eigen::Vector2d& one_to_m = one_m[i + 1 < one_m.size() ? i + 1 : 0];
    for (std::size_t k = 0; k < other_m.size(); ++k) {
      const Eigen::Vector2d& other_to_m = other_m[k + 1 < other_m.size() ? k + 1 : 0];
      if (DoCross(one_m[i], one_to_m, other_m[k], other_to_m)) return 0.0;
      distance_m = std::min({distance_m, DistanceToEdge(one_m[i], other_m[k], other_to_m), DistanceToEdge(other_m[k], one_m[i], one_to_m)});
    }
  }
  return distance_m;
}

std::vector<Eigen::Vector2d> ConvexHull(std::vector<Eigen::Vector2d> places_m, double flat_m2) {
  if (flat_m2 <= 0.0) DropInner(places_m);
  std::ranges::sort(places_m, [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  places_m.erase(std::unique(places_m.begin(), places_m.end()), places_m.end());
  std::vector<Eigen::Vector2d> hull_m;
  ChainHull(
      places_m,
      [flat_m2](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
        const Eigen::Vector2d last_m = b - a;
        const Eigen::Vector2d next_m = c - b;
        return Cross(last_m, next_m) > (flat_m2 > 0.0 ? flat_m2 * std::min(last_m.norm() + next_m.norm(), 1.0) : 0.0);
      },
      hull_m);
  return hull_m;
}

Rectangle RectangleAround(std::span<const Eigen::Vector2d> polygon) {
  Rectangle best{.center_m = polygon.front()};
  Eigen::Vector2d best_along = Eigen::Vector2d::UnitX();
  double least_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d edge = polygon[i + 1 < polygon.size() ? i + 1 : 0] - polygon[i];
    const double edge_m = edge.norm();
    if (edge_m == 0.0) continue;
    const Eigen::Vector2d along = edge / edge_m;
    const Eigen::Vector2d across(-along.y(), along.x());
    Eigen::Array2d from = Eigen::Array2d::Zero();  // along and across, from the first corner
    Eigen::Array2d to = Eigen::Array2d::Zero();
    for (const auto& corner : polygon) {
      const Eigen::Array2d at(along.dot(corner - polygon.front()), across.dot(corner - polygon.front()));
      from = from.min(at);
      to = to.max(at);
    }
    const Eigen::Array2d size = to - from;
    if (size.prod() >= least_m2) continue;
    least_m2 = size.prod();
    const Eigen::Array2d middle = 0.5 * (from + to);
    best.center_m = polygon.front() + middle[0] * along + middle[1] * across;
    best.length_m = size.maxCoeff();
    best.width_m = size.minCoeff();
    best_along = size[0] >= size[1] ? along : across;
  }
  const double angle_rad = WrapTo2Pi(Atan2(best_along.y(), best_along.x()));
  best.length_angle_rad = angle_rad < kPi ? angle_rad : angle_rad - kPi;
  return best;
}

}  // namespace lookout
