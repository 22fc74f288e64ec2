// Land along a line: coasts, quays, islands and breakwaters. Its waterline bends and has bays; stretches of it have an edge (beach, reeds, wall, ...)
// and a cover (trees, houses, cars, ...) each, drawn from the lists of the scene file.
#pragma once

#include <vector>

#include "lab/sim/random.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// Water on its starboard side.
using Line = std::vector<Eigen::Vector2d>;

struct Coast {
  SceneObject object;             // without id, name and way
  Line line_m;                    // the waterline without its bays, object frame
  std::size_t num_front = 0;      // so many vertices of the outline, from the first, lie at the water
  std::vector<double> reach_m{};  // [vertices of line_m] how far reeds, boulders or fenders stand out of the waterline
};

/// Along a line that bends as `land` says. Frame: the origin is the middle of the line, x runs along it there, land is on the side of positive y.
///
/// @param kind  name of the object
Coast MakeCoast(std::string_view kind, const config::Scene::Land& land, double length_m, Random& random);

/// Along a given line.
Coast MakeCoastAlong(std::string_view kind, const config::Scene::Land& land, const Line& line_m, Random& random);

/// Inside of a closed line of about this length and width. The origin is its middle.
Coast MakeIslandOf(std::string_view kind, const config::Scene::Land& land, double length_m, double width_m, Random& random);

/// The line beside another at a distance on its starboard side, back against it: both have the water between them on their starboard side.
Line Opposite(const Line& line_m, double distance_m);

}  // namespace lookout::sim
