#include "tools/eval/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lookout::eval {

OutlineDistance DistanceToOutline(const Eigen::Vector2d& p_m, const Polygon& outline_m) {
  double nearest_m2 = std::numeric_limits<double>::infinity();
  bool is_inside = false;
  for (std::size_t i = 0, previous = outline_m.size() - 1; i < outline_m.size(); previous = i++) {
    const Eigen::Vector2d& a_m = outline_m[previous];
    const Eigen::Vector2d& b_m = outline_m[i];
    const Eigen::Vector2d edge_m = b_m - a_m;
    const double length2_m2 = edge_m.squaredNorm();
    const double share = length2_m2 > 0.0 ? std::clamp((p_m - a_m).dot(edge_m) / length2_m2, 0.0, 1.0) : 0.0;
    nearest_m2 = std::min(nearest_m2, (p_m - a_m - share * edge_m).squaredNorm());
    // A ray along +x crosses the edges that have one end above it and one not.
    if ((a_m.y() > p_m.y()) != (b_m.y() > p_m.y())) {
      const double crossing_m = a_m.x() + (p_m.y() - a_m.y()) / edge_m.y() * edge_m.x();
      if (p_m.x() < crossing_m) is_inside = !is_inside;
    }
  }
  const double edge_m = std::sqrt(nearest_m2);
  return {edge_m, is_inside ? 0.0 : edge_m};
}

}  // namespace lookout::eval
