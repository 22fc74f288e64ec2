// Frames, right-handed: lidar (x along azimuth 0, y left, z up), vessel (x forward, y port, z up), map (east, north, up).
#pragma once

#include <Eigen/Geometry>

namespace lookout {

/// Direction of a beam in the lidar frame.
///
/// @param azimuth_rad    from the x axis, clockwise seen from above
/// @param elevation_rad  above the x-y plane
/// @return unit vector
Eigen::Vector3d BeamDirection(double azimuth_rad, double elevation_rad);

/// Rotations about one axis (x, y, z: 0, 1, 2), right-handed.
Eigen::Matrix3d RotationAbout(int axis, double angle_rad);
inline Eigen::Matrix3d RotationAboutX(double angle_rad) { return RotationAbout(0, angle_rad); }
inline Eigen::Matrix3d RotationAboutY(double angle_rad) { return RotationAbout(1, angle_rad); }
inline Eigen::Matrix3d RotationAboutZ(double angle_rad) { return RotationAbout(2, angle_rad); }

/// Place and attitude of a sensor in the vessel frame, as config gives it.
struct Mounting {
  Eigen::Vector3d p_vessel_m = Eigen::Vector3d::Zero();
  double roll_rad = 0.0;   // right-handed about x: positive turns y up
  double pitch_rad = 0.0;  // right-handed about y: positive turns x down
  double yaw_rad = 0.0;    // right-handed about z: counter-clockwise from above
};

/// @return T_vessel_sensor with rotation Rz(yaw) Ry(pitch) Rx(roll)
Eigen::Isometry3d TransformVesselSensor(const Mounting& mounting);

/// Rotation from the vessel frame to east, north, up.
///
/// @param heading_rad  from true north, clockwise
/// @param pitch_rad    positive bow up
/// @param roll_rad     positive starboard down
/// @return R_map_vessel = Rz(pi/2 - heading) Ry(-pitch) Rx(roll): heading first, then pitch, then roll, each about the turned axes
Eigen::Matrix3d RotationMapVessel(double heading_rad, double pitch_rad, double roll_rad);

}  // namespace lookout
