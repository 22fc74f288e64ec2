// A boat and a scene as small as a test wants them.
#pragma once

#include "common/config/boat.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// A level boat with the lidar amidships, 2 m above the water, looking ahead.
inline config::BoatFacts SmallBoat() {
  config::BoatFacts boat;
  boat.name = "test";
  boat.lidar.p_vessel_m = {0.0, 0.0, 1.5};
  boat.T_vessel_lidar = TransformVesselSensor(boat.lidar);
  boat.p_vessel_antenna_m = {-0.8, 0.4, 0.9};
  boat.reference_point_above_water_m = 0.5;
  boat.own_vessel_box_m = {Eigen::Vector3d(-1.4, -0.9, -1.0), Eigen::Vector3d(1.4, 0.9, 2.0)};
  return boat;
}

/// One object around a boat that lies still at the origin. Object frame = map turned so that x is north.
inline Scene StillScene(double own_heading_rad, std::vector<Part> parts) {
  Scene scene;
  scene.own_motion.track.start.heading_rad = own_heading_rad;
  scene.objects.push_back({1, "thing", "buoy", Track{}, std::move(parts), {{0.0, 0.0}}});
  return scene;
}

}  // namespace lookout::sim
