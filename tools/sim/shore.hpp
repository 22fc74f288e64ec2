// Land: a bank along an irregular waterline, rising ground behind it, and trees.
#pragma once

#include <functional>

#include "tools/sim/random.hpp"
#include "tools/sim/scene.hpp"

namespace lookout::sim {

/// Land about a middle.
struct LandShape {
  double mean_radius_m;  // from the middle to the waterline
  double roughness_m;    // greatest bay or headland
  int num_trees;
};

/// A stretch of a circle of water's edge.
struct Stretch {
  double from_rad;   // bearing of its first end, clockwise from north
  double width_rad;  // how far it runs on clockwise
};

/// @return radius of the waterline at a bearing
using Waterline = std::function<double(double bearing_rad)>;

struct Shore {
  SceneObject object;  // frame: x north, y west, origin in the middle of the circle
  Waterline waterline_m;
};

/// Land outward of the waterline.
Shore MakeShore(const LandShape& shape, const Stretch& stretch, Random& random);

/// Land inward of the waterline: a bank round it and a hill. Trees only where their crowns stay over the land.
SceneObject MakeIsland(const LandShape& shape, Random& random);

}  // namespace lookout::sim
