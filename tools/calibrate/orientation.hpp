// Mountings in angles and words.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/core/frames.hpp"

namespace lookout::calibrate {

/// Roll, pitch, yaw of boat.txtpb: R_vessel_lidar = Rz(yaw) Ry(pitch) Rx(roll). Pitch is -pi/2 to pi/2.
struct Angles {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;  // -pi to pi
};

Angles AnglesOf(const Eigen::Matrix3d& R_vessel_lidar);
Eigen::Matrix3d RotationOf(const Angles& angles);

/// The 24 rotations that bring a cube onto itself, the identity first.
std::vector<Eigen::Matrix3d> CubeRotations();

/// Angle of a rotation, 0 to pi.
double AngleOf(const Eigen::Matrix3d& R);

/// How a lidar is turned against boat.txtpb, by right angles about the axes of the boat.
///
/// @param turned  one of CubeRotations: R_vessel_lidar = turned * R of boat.txtpb, about
/// @return "turned by 90 deg to port", "upside down, and ..."; empty for the identity
std::string TurnInWords(const Eigen::Matrix3d& turned);

/// The rotation of CubeRotations nearest to R.
Eigen::Matrix3d NearestCubeRotation(const Eigen::Matrix3d& R);

}  // namespace lookout::calibrate
