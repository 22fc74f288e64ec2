#include "common/core/frames.hpp"

#include "common/core/angles.hpp"

namespace lookout {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

Eigen::Vector3d BeamDirection(double azimuth_rad, double elevation_rad) {
  const double horizontal = std::cos(elevation_rad);
  return {horizontal * std::cos(azimuth_rad), -horizontal * std::sin(azimuth_rad), std::sin(elevation_rad)};
}

Eigen::Isometry3d TransformVesselSensor(const Mounting& mounting) {
  Eigen::Isometry3d T_vessel_sensor = Eigen::Isometry3d::Identity();
  T_vessel_sensor.linear() = (AngleAxisd(mounting.yaw_rad, Vector3d::UnitZ()) * AngleAxisd(mounting.pitch_rad, Vector3d::UnitY()) *
                              AngleAxisd(mounting.roll_rad, Vector3d::UnitX()))
                                 .toRotationMatrix();
  T_vessel_sensor.translation() = mounting.p_vessel_m;
  return T_vessel_sensor;
}

Eigen::Matrix3d RotationMapVessel(double heading_rad, double pitch_rad, double roll_rad) {
  return (AngleAxisd(kPi / 2.0 - heading_rad, Vector3d::UnitZ()) * AngleAxisd(-pitch_rad, Vector3d::UnitY()) *
          AngleAxisd(roll_rad, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace lookout
