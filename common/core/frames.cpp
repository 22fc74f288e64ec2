#include "common/core/frames.hpp"

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout {

Eigen::Vector3d BeamDirection(double azimuth_rad, double elevation_rad) {
  const auto [sin_elevation, cos_elevation] = SinCosOf(elevation_rad);
  const auto [sin_azimuth, cos_azimuth] = SinCosOf(azimuth_rad);
  return {cos_elevation * cos_azimuth, -cos_elevation * sin_azimuth, sin_elevation};
}

Eigen::Matrix3d RotationAbout(int axis, double angle_rad) {
  const auto [sine, cosine] = SinCosOf(angle_rad);
  const int next = (axis + 1) % 3;
  const int last = (axis + 2) % 3;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation(next, next) = rotation(last, last) = cosine;
  rotation(next, last) = -sine;
  rotation(last, next) = sine;
  return rotation;
}

Eigen::Isometry3d TransformVesselSensor(const Mounting& mounting) {
  Eigen::Isometry3d T_vessel_sensor = Eigen::Isometry3d::Identity();
  T_vessel_sensor.linear() = RotationAboutZ(mounting.yaw_rad) * RotationAboutY(mounting.pitch_rad) * RotationAboutX(mounting.roll_rad);
  T_vessel_sensor.translation() = mounting.p_vessel_m;
  return T_vessel_sensor;
}

Eigen::Matrix3d RotationMapVessel(double heading_rad, double pitch_rad, double roll_rad) {
  return RotationAboutZ(kPi / 2.0 - heading_rad) * RotationAboutY(-pitch_rad) * RotationAboutX(roll_rad);
}

}  // namespace lookout
