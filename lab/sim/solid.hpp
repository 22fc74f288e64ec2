// Simple solids and where a ray meets them. z is up in every frame used here.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <variant>
#include <vector>

namespace lookout::sim {

struct Ray {
  Eigen::Vector3d origin_m;
  Eigen::Vector3d direction;  // unit vector
};

/// Where a ray enters a solid.
struct Hit {
  double range_m = 0.0;
  double incidence_cosine = 1.0;  // of the angle between the ray and the normal of the surface, 0 to 1
};

/// Upright.
struct Cylinder {
  Eigen::Vector2d center_m;
  double radius_m;
  double bottom_m;
  double top_m;
};

/// Axes along x, y, z.
struct Ellipsoid {
  Eigen::Vector3d center_m;
  Eigen::Vector3d radii_m;
};

/// Upright walls over a convex footprint, counter-clockwise.
struct Prism {
  std::vector<Eigen::Vector2d> footprint_m;
  double bottom_m;
  double top_m;
};

/// A piece of ground, seen from both sides.
struct Triangle {
  Eigen::Vector3d a_m;
  Eigen::Vector3d b_m;
  Eigen::Vector3d c_m;
};

/// Upright and round; the radius changes linearly from bottom_radius_m to the radius at the top. One of the two may be 0.
struct Cone {
  Eigen::Vector2d center_m;
  double bottom_radius_m;
  double top_radius_m;
  double bottom_m;
  double top_m;
};

/// Straight, in any direction, with half balls as its ends.
struct Rod {
  Eigen::Vector3d from_m;
  Eigen::Vector3d to_m;
  double radius_m;
};

/// Seen from above, the convex hull of the points, widened by the radius, contains the solid; so do the heights.
struct Bounds {
  std::vector<Eigen::Vector2d> points_m;
  double radius_m = 0.0;
  double low_m = 0.0;
  double high_m = 0.0;
};

/// A half space: what has normal . p <= offset.
struct Plane {
  Eigen::Vector3d normal;  // unit vector, outward
  double offset_m;
};

/// The space inside of all planes, without the space inside of all planes of the hollow.
struct Convex {
  std::vector<Plane> planes;
  std::vector<Plane> hollow;  // none = solid. Where the hollow goes beyond the planes the solid is open: rays go into it
  Bounds bounds;
};

using Solid = std::variant<Cylinder, Ellipsoid, Prism, Triangle, Cone, Rod, Convex>;

/// Walls that lean over a convex footprint, under a top that may slope.
struct LeaningWalls {
  std::vector<Eigen::Vector2d> footprint_m;  // counter-clockwise, where the walls are widest: at the bottom of a cabin, at the top of a hull
  // By edge of the footprint from its first vertex on; one value = all. Not negative: how much a wall comes in per metre from the widest height.
  std::vector<double> lean;
  bool is_widest_on_top = false;
  double bottom_m = 0.0;
  double top_m = 0.0;            // at x = 0
  double top_slope = 0.0;        // rise per metre along x
  double wall_m = 0.0;           // thickness; 0 = solid, else open on top
  double hollow_bottom_m = 0.0;  // of a part that is open on top
};
Convex ToConvex(const LeaningWalls& walls);

/// @return nullopt when the ray misses, or starts inside
std::optional<Hit> Intersect(const Solid& solid, const Ray& ray);

Bounds BoundsOf(const Solid& solid);

/// @return rectangle from (min_x, min_y) to (max_x, max_y), counter-clockwise
std::vector<Eigen::Vector2d> Rectangle(double min_x_m, double max_x_m, double min_y_m, double max_y_m);

/// @return regular polygon of `num_vertices` on a circle, counter-clockwise
std::vector<Eigen::Vector2d> Circle(const Eigen::Vector2d& center_m, double radius_m, int num_vertices);

}  // namespace lookout::sim
