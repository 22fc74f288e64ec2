#include "tools/calibrate/orientation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::calibrate {

namespace {

// The axis of the boat along which a vector points.
const char* DirectionOf(const Eigen::Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  constexpr std::array<const char*, 3> kPlus{"forward", "to port", "up"};
  constexpr std::array<const char*, 3> kMinus{"aft", "to starboard", "down"};
  return axis[largest] > 0.0 ? kPlus.at(static_cast<std::size_t>(largest)) : kMinus.at(static_cast<std::size_t>(largest));
}

}  // namespace

Angles AnglesOf(const Eigen::Matrix3d& R_vessel_lidar) {
  const double sine = std::clamp(-R_vessel_lidar(2, 0), -1.0, 1.0);
  Angles angles;
  angles.pitch_rad = std::asin(sine);
  // Straight up or down yaw and roll turn about one axis: roll is then 0.
  constexpr double kNearlyOne = 1.0 - 1e-12;
  if (std::abs(sine) > kNearlyOne) {
    angles.yaw_rad = std::atan2(-R_vessel_lidar(0, 1), R_vessel_lidar(1, 1));
    return angles;
  }
  angles.roll_rad = std::atan2(R_vessel_lidar(2, 1), R_vessel_lidar(2, 2));
  angles.yaw_rad = std::atan2(R_vessel_lidar(1, 0), R_vessel_lidar(0, 0));
  return angles;
}

Eigen::Matrix3d RotationOf(const Angles& angles) {
  return RotationAboutZ(angles.yaw_rad) * RotationAboutY(angles.pitch_rad) * RotationAboutX(angles.roll_rad);
}

std::vector<Eigen::Matrix3d> CubeRotations() {
  std::vector<Eigen::Matrix3d> rotations;
  rotations.reserve(24);
  // Where x goes, then where y goes; z follows.
  for (int x = 0; x < 6; ++x) {
    for (int y = 0; y < 6; ++y) {
      if (x / 2 == y / 2) continue;
      Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
      R(x / 2, 0) = x % 2 == 0 ? 1.0 : -1.0;
      R(y / 2, 1) = y % 2 == 0 ? 1.0 : -1.0;
      R.col(2) = R.col(0).cross(R.col(1)).eval();
      rotations.push_back(R);
    }
  }
  const auto identity = std::ranges::find_if(rotations, [](const Eigen::Matrix3d& R) { return R.isIdentity(); });
  std::iter_swap(rotations.begin(), identity);
  return rotations;
}

double AngleOf(const Eigen::Matrix3d& R) { return std::acos(std::clamp(0.5 * (R.trace() - 1.0), -1.0, 1.0)); }

std::string TurnInWords(const Eigen::Matrix3d& turned) {
  if (turned.isIdentity(1e-6)) return "";
  if (turned(2, 2) > 0.5) {  // about up
    const double yaw_deg = RadToDeg(std::atan2(turned(1, 0), turned(0, 0)));
    if (std::abs(yaw_deg) > 135.0) return "turned by 180 deg about up: what counts as ahead is astern";
    return yaw_deg > 0.0 ? "turned by 90 deg to port: what counts as ahead is to port"
                         : "turned by 90 deg to starboard: what counts as ahead is to starboard";
  }
  const std::string axes =
      std::string("what counts as ahead is ") + DirectionOf(turned.col(0)) + ", what counts as up is " + DirectionOf(turned.col(2));
  if (turned(2, 2) < -0.5) return "upside down: " + axes;
  if (turned(0, 0) > 0.5) return "rolled by 90 deg: " + axes;
  if (turned(1, 1) > 0.5) return "pitched by 90 deg: " + axes;
  return "its axes are swapped: " + axes;
}

Eigen::Matrix3d NearestCubeRotation(const Eigen::Matrix3d& R) {
  const auto rotations = CubeRotations();
  return *std::ranges::min_element(rotations, {}, [&R](const Eigen::Matrix3d& cube) { return -(cube.transpose() * R).trace(); });
}

}  // namespace lookout::calibrate
