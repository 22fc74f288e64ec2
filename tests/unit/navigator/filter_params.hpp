// Parameters of the filter for tests: those of config/schema/navigator.proto, and an antenna at the reference point.
#pragma once

#include "common/core/angles.hpp"
#include "services/navigator/core/filter/params.hpp"

namespace lookout::navigator {

inline FilterParams TestFilterParams() {
  using namespace std::chrono_literals;
  FilterParams params;
  params.gyro_noise_radps_rthz = DegToRad(0.016);
  params.accelerometer_noise_mps2_rthz = 0.0015;
  params.gyro_bias_sd_radps = DegToRad(0.2);
  params.accelerometer_bias_sd_mps2 = 0.05;
  params.max_latency = 500ms;
  params.max_position_age = 30s;
  params.max_coast_sd_m = 2.5;
  params.max_attitude_age = 1s;
  params.max_heading_coast_sd_rad = DegToRad(5.0);
  params.velocity_sd_mps = 0.1;
  params.heading_sd_rad = DegToRad(1.0);
  params.tilt_sd_rad = DegToRad(0.5);
  params.use_course_as_heading = true;
  params.min_course_speed_mps = 1.0;
  params.course_heading_sd_rad = DegToRad(10.0);
  params.unmeasured_tilt_sd_rad = DegToRad(5.0);
  return params;
}

}  // namespace lookout::navigator
