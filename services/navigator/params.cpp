#include "services/navigator/params.hpp"

#include <chrono>
#include <cmath>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/navigator.pb.h"
#include "services/navigator/inputs.hpp"

namespace lookout::navigator {

namespace {

std::chrono::microseconds ToMicroseconds(double duration_s) { return std::chrono::microseconds(std::llround(duration_s * 1e6)); }

}  // namespace

Params LoadParams(const std::filesystem::path& config_folder) {
  Params params;
  config::FaultList faults;
  const auto loaded_boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  const auto loaded = faults.Take([&] { return config::Load<config::Navigator>(config_folder, "navigator.txtpb"); });
  if (loaded && loaded->max_sentence_latency_s() > loaded->max_attitude_age_s()) {
    faults.Add(config::FaultLine(config_folder / "navigator.txtpb", "max_sentence_latency_s", "must not be greater than max_attitude_age_s"));
  }
  if (loaded) faults.Try([&] { TakeInputs(config_folder, *loaded, params); });
  faults.ThrowIfAny();
  const auto& boat = *loaded_boat;
  const auto& message = *loaded;
  params.input = message.source() == config::Navigator::LOG ? Input::kLog : Input::kOutside;
  params.use_lidar_nmea = message.use_lidar_nmea();

  auto& navigator = params.navigator;
  navigator.max_sentence_latency = ToMicroseconds(message.max_sentence_latency_s());
  navigator.position_sd_m = message.position_sd_m();
  navigator.heading_offset_rad = DegToRad(message.heading_offset_deg());
  navigator.pitch_offset_rad = DegToRad(message.pitch_offset_deg());
  navigator.roll_offset_rad = DegToRad(message.roll_offset_deg());

  auto& filter = navigator.filter;
  if (boat.datum) filter.datum = Datum{boat.datum->latitude_deg, boat.datum->longitude_deg, boat.datum->ellipsoid_height_m};
  filter.p_vessel_antenna_m = boat.p_vessel_antenna_m;
  filter.p_vessel_imu_m = boat.p_vessel_imu_m;
  filter.gyro_noise_radps_rthz = DegToRad(message.gyro_noise_degps_rthz());
  filter.gyro_bias_sd_radps = DegToRad(message.gyro_bias_sd_degps());
  filter.accelerometer_noise_mps2_rthz = message.accelerometer_noise_mps2_rthz();
  filter.accelerometer_bias_sd_mps2 = message.accelerometer_bias_sd_mps2();
  filter.max_latency = navigator.max_sentence_latency;
  filter.max_position_age = ToMicroseconds(message.max_position_age_s());
  filter.max_coast_sd_m = message.max_coast_sd_m();
  filter.max_attitude_age = ToMicroseconds(message.max_attitude_age_s());
  filter.max_heading_coast_sd_rad = DegToRad(message.max_heading_coast_sd_deg());
  filter.velocity_sd_mps = message.velocity_sd_mps();
  filter.heading_sd_rad = DegToRad(message.heading_sd_deg());
  filter.tilt_sd_rad = DegToRad(message.tilt_sd_deg());
  filter.use_course_as_heading = message.use_course_as_heading();
  filter.min_course_speed_mps = message.min_course_speed_mps();
  filter.course_heading_sd_rad = DegToRad(message.course_heading_sd_deg());
  filter.unmeasured_tilt_sd_rad = DegToRad(message.unmeasured_tilt_sd_deg());
  return params;
}

}  // namespace lookout::navigator
