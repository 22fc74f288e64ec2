#include "services/georeferencer/params.hpp"

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/georeferencer.pb.h"

namespace lookout::georeferencer {

Params LoadParams(const std::filesystem::path& config_folder) {
  config::FaultList faults;
  const auto loaded_boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  const auto loaded = faults.Take([&] { return config::Load<config::Georeferencer>(config_folder, "georeferencer.txtpb"); });
  faults.ThrowIfAny();
  const auto& boat = *loaded_boat;
  const auto& message = *loaded;
  Params params;
  params.placement.T_vessel_lidar = boat.T_vessel_lidar;
  if (boat.lidar_2) params.T_vessel_lidar_2 = TransformVesselSensor(*boat.lidar_2);
  params.placement.reference_point_above_water_m = boat.reference_point_above_water_m;
  params.placement.range_sd_m = message.range_sd_m();
  params.placement.azimuth_sd_rad = DegToRad(message.azimuth_sd_deg());
  params.placement.mounting_sd_rad = DegToRad(message.mounting_sd_deg());
  params.datum = boat.datum;
  params.pose_timeout = std::chrono::round<std::chrono::microseconds>(std::chrono::duration<double>(message.pose_timeout_s()));
  return params;
}

}  // namespace lookout::georeferencer
