// Speed and course of POSE, for tables and screens.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "common/core/geodesy.hpp"
#include "lookout/pose_t.hpp"

namespace lookout {

/// Velocity to the east, to the north and up where the boat is, m/s. POSE has it along the axes of the map, which are those at the datum: taken as
/// they are, the course is off by a degree 100 km away and more near the poles, and far away the speed too. Where place or datum are not known, as it
/// is.
inline Eigen::Vector3d Velocity3dHere(const pose_t& pose) {
  Eigen::Vector3d velocity_map_mps(pose.velocity_map_mps[0], pose.velocity_map_mps[1], pose.velocity_map_mps[2]);
  const auto or_zero = [](double value) { return std::isfinite(value) ? value : 0.0; };
  if (!std::isfinite(pose.latitude_deg) || !std::isfinite(pose.longitude_deg) || !std::isfinite(pose.datum_latitude_deg) ||
      !std::isfinite(pose.datum_longitude_deg)) {
    return velocity_map_mps;
  }
  const LocalFrame map({pose.datum_latitude_deg, pose.datum_longitude_deg, or_zero(pose.datum_ellipsoid_height_m)});
  const LocalFrame here({pose.latitude_deg, pose.longitude_deg, or_zero(pose.ellipsoid_height_m)});
  return here.TransformFrom(map).linear() * velocity_map_mps;
}

/// Its level part: east and north.
inline Eigen::Vector2d VelocityHere(const pose_t& pose) { return Velocity3dHere(pose).head<2>(); }

}  // namespace lookout
