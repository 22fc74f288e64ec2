// Simple polygons seen from above: what they hold, and how far they are from each other.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lookout::sim {

using Outline = std::vector<Eigen::Vector2d>;

/// A vertex or an edge itself may count either way.
bool Contains(const Outline& outline_m, const Eigen::Vector2d& p_m);

/// @return shortest distance between two polygons; 0 when they touch or one holds the other. Cost: product of their vertices.
double DistanceM(const Outline& a_m, const Outline& b_m);

}  // namespace lookout::sim
