// Waterlines seen from above. Land lies on the port side of a line, and inside of a closed one, which runs counter-clockwise.
#pragma once

#include "lab/sim/coast.hpp"

namespace lookout::sim {

/// A vertex of a waterline.
struct WaterlineVertex {
  Eigen::Vector2d place_m;
  Eigen::Vector2d inland;  // unit vector, square to the line without its bays
  double along_m;          // from the first
  double max_depth_m;      // this far inland, other parts of the line are about as near as this one
};

/// With bends, their middle at the origin along x. Bends that would bring the line back to itself are left out.
/// @throws std::length_error for a line of more than 5 km
Line BentLine(const config::Scene::Land& land, double length_m, Random& random);

/// Round an ellipse.
Line Ring(double length_m, double width_m);

/// A vertex each step and at each corner, moved by bays and headlands.
std::vector<WaterlineVertex> WithBays(const Line& line_m, bool is_closed, const config::Scene::Land& land, Random& random);

/// A value or a range, else from `low` to `high`.
double DrawNumber(const google::protobuf::RepeatedField<double>& numbers, double low, double high, Random& random);

/// Draws one of the numbers 0 to `count` - 1.
int DrawIndex(int count, Random& random);

}  // namespace lookout::sim
