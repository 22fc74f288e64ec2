#include "tools/sim/solid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace

std::optional<Hit> Intersect(const Solid& solid, const Ray& ray) {
  return std::visit([&ray](const auto& shape) { return IntersectSolid(shape, ray); }, solid);
}

Bounds BoundsOf(const Solid& solid) {
  return std::visit([](const auto& shape) { return BoundsOfSolid(shape); }, solid);
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
