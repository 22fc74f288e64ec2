#include "services/odometer/params.hpp"

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/odometer.pb.h"

namespace lookout::odometer {

namespace {

config::Odometer LoadMessage(const std::filesystem::path& config_folder) {
  const auto file = config_folder / "odometer.txtpb";
  auto message = config::Load<config::Odometer>(config_folder, "odometer.txtpb");
  config::FaultList faults;
  if (message.max_range_m() <= message.min_range_m()) faults.Add(config::FaultLine(file, "max_range_m", "must be greater than min_range_m"));
  faults.ThrowIfAny();
  return message;
}

}  // namespace

Params LoadParams(const std::filesystem::path& config_folder) {
  config::FaultList faults;
  const auto boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  const auto message = faults.Take([&] { return LoadMessage(config_folder); });
  faults.ThrowIfAny();
  Params params;
  params.standing.min_range_m = message->min_range_m();
  params.standing.max_range_m = message->max_range_m();
  params.standing.min_height_m = message->min_height_m();
  params.standing.reference_point_above_water_m = boat->reference_point_above_water_m;
  params.standing.T_vessel_lidar = boat->T_vessel_lidar;
  params.standing.own_vessel_box_m = boat->own_vessel_box_m;
  params.acceleration_sd_mps2 = message->acceleration_sd_mps2();
  params.turn_acceleration_sd_radps2 = DegToRad(message->turn_acceleration_sd_degps2());
  return params;
}

}  // namespace lookout::odometer
