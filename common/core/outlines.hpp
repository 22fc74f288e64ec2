// Outlines seen from above: distances, convex hulls, the rectangle of least area around one, the centre of an area.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace lookout {

/// Positive where b is counter-clockwise of a.
inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// From a point to the line from one place to another.
double DistanceToEdge(const Eigen::Vector2d& p_m, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m);

/// @param outline_m  a simple polygon, in either direction. A vertex or an edge itself may count either way
bool Contains(const std::vector<Eigen::Vector2d>& outline_m, const Eigen::Vector2d& p_m);

/// @param one_m, other_m  simple polygons, convex or not, in either direction; one of one corner is a point, of two a line
/// @return shortest distance; 0 where they touch or one holds the other; infinite where one has no corner. Cost: product of their corners.
double GapBetween(const std::vector<Eigen::Vector2d>& one_m, const std::vector<Eigen::Vector2d>& other_m);

/// The hull of points in the order of x, then y, each at a place of its own: the lower side towards greater x, then the upper one back.
///
/// @param turns_left  turns_left(a, b, c): whether b is a corner on the way from a to c
/// @param hull        corners counter-clockwise from the first point; of fewer than three points, the points
/// Cost: points. Source: A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions", Information Processing Letters 9, 1979.
template <typename Point, typename TurnsLeft>
void ChainHull(const std::vector<Point>& points, TurnsLeft turns_left, std::vector<Point>& hull) {
  hull.clear();
  if (points.size() < 3) {
    hull = points;
    return;
  }
  const auto extend = [&](const Point& point, std::size_t least) {
    while (hull.size() > least && !turns_left(hull[hull.size() - 2], hull.back(), point)) hull.pop_back();
    hull.push_back(point);
  };
  for (const auto& point : points) extend(point, 1);
  const std::size_t lower = hull.size();
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) extend(*point, lower);
  hull.pop_back();  // the first once more
}

/// Convex hull.
///
/// @param places_m  in any order
/// @param flat_m2   above 0: a corner is left out where twice the area of the triangle with its neighbours is less than that times the length of
///                  their two edges (at most 1 m)
/// @return corners counter-clockwise from that of least x (then y), none of them on the line between its neighbours; one corner where all are at one
///         place, two where they are on a line. Cost: n log n.
std::vector<Eigen::Vector2d> ConvexHull(std::vector<Eigen::Vector2d> places_m, double flat_m2 = 0.0);

/// Centre of an outline, seen from above.
///
/// @param vertices  in two or three dimensions, at least one; around the outline in either sense
/// @return the centroid of the area in x and y (with z of the surface at that place); where the outline has next to no area (a point, a line, or less
///         than a ten-thousandth of its extent squared) the mean of the vertices
template <typename Vector>
Vector AreaCenter(const std::vector<Vector>& vertices) {
  constexpr double kMinAreaRatio = 1e-4;
  // Relative to the first vertex: far from the datum the products would lose their digits. A fan of triangles around it.
  const Vector& origin = vertices.front();
  double doubled_area_m2 = 0.0;
  double extent_m2 = 0.0;
  Vector weighted = Vector::Zero();
  Vector sum = Vector::Zero();
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const Vector a = vertices[i - 1] - origin;
    const Vector b = vertices[i] - origin;
    const double doubled_triangle_m2 = a.x() * b.y() - a.y() * b.x();
    doubled_area_m2 += doubled_triangle_m2;
    weighted += doubled_triangle_m2 * (a + b);
    extent_m2 = std::max(extent_m2, b.x() * b.x() + b.y() * b.y());
    sum += b;
  }
  if (std::abs(doubled_area_m2) <= 2.0 * kMinAreaRatio * extent_m2) return origin + sum / static_cast<double>(vertices.size());
  return origin + weighted / (3.0 * doubled_area_m2);
}

/// Rectangle of least area round a polygon; one of its sides is along an edge.
struct Rectangle {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  double length_m = 0.0;  // longer side
  double width_m = 0.0;
  double length_angle_rad = 0.0;  // of the longer side from the first axis, counter-clockwise, 0 to pi; 0 of a point
};
/// @param polygon  convex, counter-clockwise, at least one corner
Rectangle RectangleAround(std::span<const Eigen::Vector2d> polygon);

}  // namespace lookout
