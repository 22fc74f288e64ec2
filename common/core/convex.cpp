#include "common/core/convex.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout {

namespace {

// What lies within the four outermost places is no corner (Akl and Toussaint).
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
