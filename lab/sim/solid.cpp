#include "lab/sim/solid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A ray inside of the half spaces seen so far: from `enter_m` to `leave_m`.
struct Span {
  double enter_m = -std::numeric_limits<double>::infinity();
  double leave_m = std::numeric_limits<double>::infinity();
  double enter_cosine = 1.0;

  // Keeps what lies behind a plane. `distance` is from the ray's origin to the plane along its outward normal, `rate` = direction . normal;
  // the normal may have any length.
  bool Clip(double distance, double rate, double normal_squared = 1.0) {
    if (rate == 0.0) return distance >= 0.0;
    const double at_m = distance / rate;
    if (rate < 0.0) {
      if (at_m > enter_m) {
        enter_m = at_m;
        enter_cosine = -rate / std::sqrt(normal_squared);
      }
    } else {
      leave_m = std::min(leave_m, at_m);
    }
    return enter_m <= leave_m;
  }

  bool ClipHeights(const Ray& ray, double bottom_m, double top_m) {
    return Clip(top_m - ray.origin_m.z(), ray.direction.z()) && Clip(ray.origin_m.z() - bottom_m, -ray.direction.z());
  }

  std::optional<Hit> Entry() const {
    if (enter_m <= 0.0) return std::nullopt;
    return Hit{enter_m, enter_cosine};
  }
};

std::optional<Hit> IntersectSolid(const Cylinder& cylinder, const Ray& ray) {
  const Vector2d direction = ray.direction.head<2>();
  const Vector2d from_center_m = ray.origin_m.head<2>() - cylinder.center_m;
  const double a = direction.squaredNorm();
  const double b = direction.dot(from_center_m);
  const double c = from_center_m.squaredNorm() - cylinder.radius_m * cylinder.radius_m;
  const double discriminant = b * b - a * c;
  if (discriminant <= 0.0 || a == 0.0) return std::nullopt;
  const double root = std::sqrt(discriminant);
  Span span;
  span.enter_m = (-b - root) / a;
  span.leave_m = (-b + root) / a;
  span.enter_cosine = root / cylinder.radius_m;  // -direction . (from_center + enter direction) / radius
  if (!span.ClipHeights(ray, cylinder.bottom_m, cylinder.top_m)) return std::nullopt;
  return span.Entry();
}

std::optional<Hit> IntersectSolid(const Ellipsoid& ellipsoid, const Ray& ray) {
  const Vector3d direction = ray.direction.cwiseQuotient(ellipsoid.radii_m);
  const Vector3d from_center = (ray.origin_m - ellipsoid.center_m).cwiseQuotient(ellipsoid.radii_m);
  const double a = direction.squaredNorm();
  const double b = direction.dot(from_center);
  const double discriminant = b * b - a * (from_center.squaredNorm() - 1.0);
  if (discriminant <= 0.0) return std::nullopt;
  const double range_m = (-b - std::sqrt(discriminant)) / a;
  if (range_m <= 0.0) return std::nullopt;
  const Vector3d normal = (from_center + range_m * direction).cwiseQuotient(ellipsoid.radii_m).normalized();
  return Hit{range_m, std::abs(normal.dot(ray.direction))};
}

std::optional<Hit> IntersectSolid(const Prism& prism, const Ray& ray) {
  Span span;
  if (!span.ClipHeights(ray, prism.bottom_m, prism.top_m)) return std::nullopt;
  const auto& footprint = prism.footprint_m;
  for (std::size_t i = 0; i < footprint.size(); ++i) {
    const Vector2d& from_m = footprint[i];
    const Vector2d edge_m = footprint[i + 1 < footprint.size() ? i + 1 : 0] - from_m;
    const Vector2d normal(edge_m.y(), -edge_m.x());
    if (!span.Clip(normal.dot(from_m - ray.origin_m.head<2>()), normal.dot(ray.direction.head<2>()), normal.squaredNorm())) return std::nullopt;
  }
  return span.Entry();
}

// T. Moeller, B. Trumbore, "Fast, minimum storage ray-triangle intersection", Journal of Graphics Tools 2(1), 1997.
std::optional<Hit> IntersectSolid(const Triangle& triangle, const Ray& ray) {
  const Vector3d ab_m = triangle.b_m - triangle.a_m;
  const Vector3d ac_m = triangle.c_m - triangle.a_m;
  const Vector3d p = ray.direction.cross(ac_m);
  const double determinant = ab_m.dot(p);
  if (determinant == 0.0) return std::nullopt;
  const Vector3d from_a_m = ray.origin_m - triangle.a_m;
  const double u = from_a_m.dot(p) / determinant;
  if (u < 0.0 || u > 1.0) return std::nullopt;
  const Vector3d q = from_a_m.cross(ab_m);
  const double v = ray.direction.dot(q) / determinant;
  if (v < 0.0 || u + v > 1.0) return std::nullopt;
  const double range_m = ac_m.dot(q) / determinant;
  if (range_m <= 0.0) return std::nullopt;
  return Hit{range_m, std::abs(ab_m.cross(ac_m).normalized().dot(ray.direction))};
}

std::optional<Hit> IntersectSolid(const Cone& cone, const Ray& ray) {
  // On the wall |p - center| = radius + slope (z - bottom), from the ray's height on: radius = start + rate x range.
  const double slope = (cone.top_radius_m - cone.bottom_radius_m) / (cone.top_m - cone.bottom_m);
  const Vector2d direction = ray.direction.head<2>();
  const Vector2d from_center_m = ray.origin_m.head<2>() - cone.center_m;
  const double start_m = cone.bottom_radius_m + slope * (ray.origin_m.z() - cone.bottom_m);
  const double rate = slope * ray.direction.z();
  const double a = direction.squaredNorm() - rate * rate;
  const double b = direction.dot(from_center_m) - start_m * rate;
  const double c = from_center_m.squaredNorm() - start_m * start_m;
  if (ray.origin_m.z() > cone.bottom_m && ray.origin_m.z() < cone.top_m && c < 0.0) return std::nullopt;
  std::optional<Hit> best;
  const auto consider = [&](double range_m, const Vector3d& normal) {
    if (range_m > 0.0 && (!best || range_m < best->range_m)) best = Hit{range_m, std::abs(normal.normalized().dot(ray.direction))};
  };
  const double discriminant = b * b - a * c;
  if (discriminant > 0.0 && a != 0.0) {
    for (const double sign : {-1.0, 1.0}) {
      const double range_m = (-b + sign * std::sqrt(discriminant)) / a;
      const double height_m = ray.origin_m.z() + range_m * ray.direction.z();
      if (height_m < cone.bottom_m || height_m > cone.top_m) continue;  // this also refuses hits on the cone beyond its tip
      const Vector2d outward = (from_center_m + range_m * direction).normalized();
      consider(range_m, {outward.x(), outward.y(), -slope});
    }
  }
  for (const auto& [height_m, radius_m] : {std::pair(cone.bottom_m, cone.bottom_radius_m), std::pair(cone.top_m, cone.top_radius_m)}) {
    if (ray.direction.z() == 0.0) break;
    const double range_m = (height_m - ray.origin_m.z()) / ray.direction.z();
    if ((from_center_m + range_m * direction).squaredNorm() < radius_m * radius_m) consider(range_m, Vector3d::UnitZ());
  }
  return best;
}

std::optional<Hit> IntersectSolid(const Rod& rod, const Ray& ray) {
  const Vector3d along_m = rod.to_m - rod.from_m;
  const double length_m = along_m.norm();
  const Vector3d axis = length_m > 0.0 ? Vector3d(along_m / length_m) : Vector3d(Vector3d::UnitZ());
  const Vector3d from_m = ray.origin_m - rod.from_m;
  if ((from_m - std::clamp(axis.dot(from_m), 0.0, length_m) * axis).squaredNorm() < rod.radius_m * rod.radius_m) return std::nullopt;
  const double axis_rate = axis.dot(ray.direction);
  const Vector3d across = ray.direction - axis_rate * axis;
  const Vector3d from_axis_m = from_m - axis.dot(from_m) * axis;
  const double a = across.squaredNorm();
  const double b = across.dot(from_axis_m);
  const double c = from_axis_m.squaredNorm() - rod.radius_m * rod.radius_m;
  const double discriminant = b * b - a * c;
  if (a > 0.0 ? discriminant <= 0.0 : c >= 0.0) return std::nullopt;
  if (a > 0.0) {
    const double range_m = (-b - std::sqrt(discriminant)) / a;
    const double at_m = axis.dot(from_m) + range_m * axis_rate;
    if (at_m >= 0.0 && at_m <= length_m) return range_m > 0.0 ? std::optional(Hit{range_m, std::sqrt(discriminant) / rod.radius_m}) : std::nullopt;
  }
  // An end that lies in the rod is met behind the rod's own surface: the nearer of the two ends is the one.
  std::optional<Hit> best;
  for (const Vector3d& end_m : {rod.from_m, rod.to_m}) {
    const auto hit = IntersectSolid(Ellipsoid{end_m, Vector3d::Constant(rod.radius_m)}, ray);
    if (hit && (!best || hit->range_m < best->range_m)) best = hit;
  }
  return best;
}

// Where a ray is inside of half spaces, and how steeply it meets the planes there.
struct Passage {
  double enter_m = -std::numeric_limits<double>::infinity();
  double leave_m = std::numeric_limits<double>::infinity();
  double enter_cosine = 1.0;
  double leave_cosine = 1.0;
};

std::optional<Passage> PassageOf(const std::vector<Plane>& planes, const Ray& ray) {
  Passage passage;
  for (const Plane& plane : planes) {
    const double distance_m = plane.offset_m - plane.normal.dot(ray.origin_m);
    const double rate = plane.normal.dot(ray.direction);
    if (rate == 0.0) {
      if (distance_m < 0.0) return std::nullopt;
      continue;
    }
    const double at_m = distance_m / rate;
    if (rate < 0.0 && at_m > passage.enter_m) {
      passage.enter_m = at_m;
      passage.enter_cosine = -rate;
    } else if (rate > 0.0 && at_m < passage.leave_m) {
      passage.leave_m = at_m;
      passage.leave_cosine = rate;
    }
    if (passage.enter_m > passage.leave_m) return std::nullopt;
  }
  return passage;
}

std::optional<Hit> IntersectSolid(const Convex& convex, const Ray& ray) {
  const auto outer = PassageOf(convex.planes, ray);
  if (!outer || outer->enter_m <= 0.0) return std::nullopt;
  if (!convex.hollow.empty()) {
    const auto inner = PassageOf(convex.hollow, ray);
    if (inner && inner->enter_m <= outer->enter_m && inner->leave_m > outer->enter_m) {
      // In by the opening: on to the inner side of a wall, unless it leaves by the opening again.
      if (inner->leave_m >= outer->leave_m) return std::nullopt;
      return Hit{inner->leave_m, inner->leave_cosine};
    }
  }
  return Hit{outer->enter_m, outer->enter_cosine};
}

Bounds BoundsOfSolid(const Cylinder& cylinder) { return {{cylinder.center_m}, cylinder.radius_m, cylinder.bottom_m, cylinder.top_m}; }
Bounds BoundsOfSolid(const Ellipsoid& ellipsoid) {
  return {{ellipsoid.center_m.head<2>()},
          ellipsoid.radii_m.head<2>().maxCoeff(),
          ellipsoid.center_m.z() - ellipsoid.radii_m.z(),
          ellipsoid.center_m.z() + ellipsoid.radii_m.z()};
}
Bounds BoundsOfSolid(const Prism& prism) { return {prism.footprint_m, 0.0, prism.bottom_m, prism.top_m}; }
Bounds BoundsOfSolid(const Triangle& triangle) {
  const auto heights_m = std::minmax({triangle.a_m.z(), triangle.b_m.z(), triangle.c_m.z()});
  return {{triangle.a_m.head<2>(), triangle.b_m.head<2>(), triangle.c_m.head<2>()}, 0.0, heights_m.first, heights_m.second};
}
Bounds BoundsOfSolid(const Cone& cone) { return {{cone.center_m}, std::max(cone.bottom_radius_m, cone.top_radius_m), cone.bottom_m, cone.top_m}; }
Bounds BoundsOfSolid(const Rod& rod) {
  const auto heights_m = std::minmax(rod.from_m.z(), rod.to_m.z());
  return {{rod.from_m.head<2>(), rod.to_m.head<2>()}, rod.radius_m, heights_m.first - rod.radius_m, heights_m.second + rod.radius_m};
}
Bounds BoundsOfSolid(const Convex& convex) { return convex.bounds; }

}  // namespace

std::optional<Hit> Intersect(const Solid& solid, const Ray& ray) {
  return std::visit([&ray](const auto& shape) { return IntersectSolid(shape, ray); }, solid);
}

Bounds BoundsOf(const Solid& solid) {
  return std::visit([](const auto& shape) { return BoundsOfSolid(shape); }, solid);
}

Convex ToConvex(const LeaningWalls& walls) {
  Convex convex;
  const auto& footprint = walls.footprint_m;
  double highest_m = -std::numeric_limits<double>::infinity();
  for (const auto& p_m : footprint) highest_m = std::max(highest_m, walls.top_m + walls.top_slope * p_m.x());
  const double widest_m = walls.is_widest_on_top ? highest_m : walls.bottom_m;
  for (std::size_t i = 0; i < footprint.size(); ++i) {
    const Vector2d edge_m = footprint[i + 1 < footprint.size() ? i + 1 : 0] - footprint[i];
    const double lean = walls.lean.size() == 1 ? walls.lean[0] : walls.lean[i];
    const Vector2d outward = Vector2d(edge_m.y(), -edge_m.x()).normalized();
    const Vector3d normal = Vector3d(outward.x(), outward.y(), walls.is_widest_on_top ? -lean : lean).normalized();
    const double offset_m = normal.dot(Vector3d(footprint[i].x(), footprint[i].y(), widest_m));
    convex.planes.push_back({normal, offset_m});
    if (walls.wall_m > 0.0) convex.hollow.push_back({normal, offset_m - walls.wall_m});
  }
  const Vector3d up = Vector3d(-walls.top_slope, 0.0, 1.0).normalized();
  convex.planes.push_back({up, walls.top_m * up.z()});
  convex.planes.push_back({-Vector3d::UnitZ(), -walls.bottom_m});
  if (walls.wall_m > 0.0) convex.hollow.push_back({-Vector3d::UnitZ(), -walls.hollow_bottom_m});
  convex.bounds = {footprint, 0.0, walls.bottom_m, highest_m};
  return convex;
}

std::vector<Vector2d> Rectangle(double min_x_m, double max_x_m, double min_y_m, double max_y_m) {
  return {{min_x_m, min_y_m}, {max_x_m, min_y_m}, {max_x_m, max_y_m}, {min_x_m, max_y_m}};
}

std::vector<Vector2d> Circle(const Vector2d& center_m, double radius_m, int num_vertices) {
  std::vector<Vector2d> vertices;
  for (int i = 0; i < num_vertices; ++i) {
    const double angle_rad = kTwoPi * i / num_vertices;
    vertices.emplace_back(center_m + radius_m * Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  }
  return vertices;
}

}  // namespace lookout::sim
