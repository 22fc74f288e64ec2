#include "tools/sim/outline.hpp"

#include <algorithm>
#include <limits>

namespace lookout::sim {
namespace {

using Eigen::Vector2d;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double DistanceToEdgeM(const Vector2d& p_m, const Vector2d& from_m, const Vector2d& to_m) {
  const Vector2d edge_m = to_m - from_m;
  const double length2_m2 = edge_m.squaredNorm();
  const double share = length2_m2 > 0.0 ? std::clamp((p_m - from_m).dot(edge_m) / length2_m2, 0.0, 1.0) : 0.0;
  return (p_m - from_m - share * edge_m).norm();
}

bool DoCross(const Vector2d& a_m, const Vector2d& b_m, const Vector2d& c_m, const Vector2d& d_m) {
  const Vector2d ab_m = b_m - a_m;
  const Vector2d cd_m = d_m - c_m;
  return Cross(ab_m, c_m - a_m) * Cross(ab_m, d_m - a_m) < 0.0 && Cross(cd_m, a_m - c_m) * Cross(cd_m, b_m - c_m) < 0.0;
}

}  // namespace

bool Contains(const Outline& outline_m, const Vector2d& p_m) {
  bool is_inside = false;
  for (std::size_t i = 0; i < outline_m.size(); ++i) {
    const Vector2d& a_m = outline_m[i];
    const Vector2d& b_m = outline_m[i + 1 < outline_m.size() ? i + 1 : 0];
    if ((a_m.y() > p_m.y()) == (b_m.y() > p_m.y())) continue;
    // An edge to the east of the point that crosses its northing.
    if (p_m.x() < a_m.x() + (p_m.y() - a_m.y()) / (b_m.y() - a_m.y()) * (b_m.x() - a_m.x())) is_inside = !is_inside;
  }
  return is_inside;
}

double DistanceM(const Outline& a_m, const Outline& b_m) {
  if (a_m.empty() || b_m.empty()) return std::numeric_limits<double>::infinity();
  // Without crossing edges either one holds the other as a whole, or they are apart.
  if (Contains(a_m, b_m[0]) || Contains(b_m, a_m[0])) return 0.0;
  double distance_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a_m.size(); ++i) {
    const Vector2d& a_to_m = a_m[i + 1 < a_m.size() ? i + 1 : 0];
    for (std::size_t k = 0; k < b_m.size(); ++k) {
      const Vector2d& b_to_m = b_m[k + 1 < b_m.size() ? k + 1 : 0];
      if (DoCross(a_m[i], a_to_m, b_m[k], b_to_m)) return 0.0;
      distance_m = std::min({distance_m, DistanceToEdgeM(a_m[i], b_m[k], b_to_m), DistanceToEdgeM(b_m[k], a_m[i], a_to_m)});
    }
  }
  return distance_m;
}

}  // namespace lookout::sim
