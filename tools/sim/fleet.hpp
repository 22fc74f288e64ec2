// Boats, buoys, docks and swimmers to put in scenes. Sizes are those of common craft, rounded.
#pragma once

#include <string>

#include "tools/sim/scene.hpp"

namespace lookout::sim {

/// Each makes an object without id; the caller gives the name and the way.
SceneObject MakeMotorBoat(const std::string& name, const Track& track);    // 6.0 m x 2.2 m, console and windscreen
SceneObject MakeSailingBoat(const std::string& name, const Track& track);  // 7.0 m x 2.4 m, mast of 9 m, boom with its sail down
SceneObject MakeKayak(const std::string& name, const Track& track);        // 4.5 m x 0.6 m with paddler
SceneObject MakeSwimmer(const std::string& name, const Track& track);      // head of 0.2 m

/// A can buoy. @param reflectance  0.03 for black rubber, 0.5 for paint
SceneObject MakeBuoy(const std::string& name, const Eigen::Vector2d& position_map_m, double radius_m, double height_m, double reflectance);

/// A pier on piles. The origin is the middle of its landward end, x runs out along it.
SceneObject MakeDock(const std::string& name, const Placement& placement, double length_m, double width_m);

}  // namespace lookout::sim
