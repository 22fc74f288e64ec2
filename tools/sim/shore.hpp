// Land around the water: a bank along an irregular line, rising ground behind it, and trees.
#pragma once

#include <functional>
#include <string>

#include "tools/sim/random.hpp"
#include "tools/sim/scene.hpp"

namespace lookout::sim {

/// A stretch of shore around the origin of the map.
struct ShoreShape {
  double from_rad;       // bearing of its first end, clockwise from north
  double width_rad;      // how far it runs on clockwise
  double mean_radius_m;  // from the origin to the waterline
  double roughness_m;    // greatest bay or headland
  int num_trees;
};

/// @return radius of the waterline at a bearing
using Waterline = std::function<double(double bearing_rad)>;

struct Shore {
  SceneObject object;  // fixed, frame: x north, y west
  Waterline waterline_m;
};

Shore MakeShore(const std::string& name, const ShoreShape& shape, Random& random);

}  // namespace lookout::sim
