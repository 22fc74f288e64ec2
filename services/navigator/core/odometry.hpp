// Own motion by the lidar, as NAV_RAW holds it: one line of text for each LIDAR_ODOMETRY that navigator used.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/utime.hpp"

namespace lookout::navigator {

/// With variances times this, the covariance of a motion is positive definite, also where the text has rounded it.
inline constexpr double kInflatedVariance = 1.01;

/// Least deviation of a motion in each direction, m; those stated are of the fit alone.
inline constexpr double kMotionSdM = 0.03;

/// Motion over the water from `begin` to `end`, in the levelled vessel frame at `begin`.
struct OdometryMotion {
  Utime begin;
  Utime end;
  bool is_known = false;                                     // else only the times count
  Eigen::Vector2d displacement_m = Eigen::Vector2d::Zero();  // of the reference point: forward, port
  double turn_rad = 0.0;                                     // clockwise
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();      // of forward, port, turn
};

/// "$PLKODO,begin,end,K,forward,port,turn,6 of the covariance*hh": microseconds since 1970, metres, radians; K known, U unknown.
std::string ToSentence(const OdometryMotion& motion);

/// @return nullopt where the line is not one of these, or a value is missing or out of range
std::optional<OdometryMotion> ParseOdometry(std::string_view line);

}  // namespace lookout::navigator
