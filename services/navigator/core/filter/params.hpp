// Parameters of the filter: the boat and its sensors.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <optional>

#include "services/navigator/core/pose.hpp"

namespace lookout::navigator {

struct FilterParams {
  std::optional<GeodeticPlace> datum;  // origin of the map frame; nullopt: the first fix
  Eigen::Vector3d p_vessel_antenna_m = Eigen::Vector3d::Zero();

  Eigen::Vector3d p_vessel_imu_m = Eigen::Vector3d::Zero();
  double gyro_noise_radps_rthz = 0.0;          // of each axis
  double accelerometer_noise_mps2_rthz = 0.0;  // of each axis, with the engine's vibration
  double gyro_bias_sd_radps = 0.0;             // at the start
  double accelerometer_bias_sd_mps2 = 0.0;     // at the start

  /// Measurements that are older than this when they come are not used.
  std::chrono::microseconds max_latency{0};
  std::chrono::microseconds max_position_age{0};  // propagated without a fix for at most so long,
  double max_coast_sd_m = 0.0;                    // and while the position's deviation has not grown by more than this
  std::chrono::microseconds max_attitude_age{0};  // heading and tilt likewise, where no IMU propagates them
  double max_heading_coast_sd_rad = 0.0;

  // Standard deviations where the sentence states none.
  double velocity_sd_mps = 0.0;
  double heading_sd_rad = 0.0;
  double tilt_sd_rad = 0.0;
  // Course over ground stands in for heading above min_course_speed_mps, where allowed.
  bool use_course_as_heading = false;
  double min_course_speed_mps = 0.0;
  double course_heading_sd_rad = 0.0;
  double unmeasured_tilt_sd_rad = 0.0;
};

}  // namespace lookout::navigator
