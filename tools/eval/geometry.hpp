// Distances between points and outlines on the plane.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lookout::eval {

using Polygon = std::vector<Eigen::Vector2d>;  // simple, in either direction; the last vertex joins the first

struct OutlineDistance {
  double edge_m = 0.0;     // to the nearest point of the line itself
  double outside_m = 0.0;  // the same, but 0 for a point inside
};

/// Precondition: the polygon has a vertex. Cost: proportional to its vertices.
OutlineDistance DistanceToOutline(const Eigen::Vector2d& p_m, const Polygon& outline_m);

}  // namespace lookout::eval
