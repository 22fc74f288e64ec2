#include "services/georeferencer/params.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/georeferencer.pb.h"

namespace lookout::georeferencer {

namespace {

std::string InsideHullText(const GuardZoneParams& zone, const Eigen::AlignedBox3d& own_vessel_box_m) {
  return fmt::format(
      "the zone of {:.1f} m lies wholly inside own_vessel of boat.txtpb, which reaches {:.1f} m forward, {:.1f} m aft, {:.1f} m to port "
      "and {:.1f} m to starboard: returns in there are own boat, so nothing can ring the alarm",
      zone.range_m, own_vessel_box_m.max().x(), -own_vessel_box_m.min().x(), own_vessel_box_m.max().y(), -own_vessel_box_m.min().y());
}

}  // namespace

Params LoadParams(const std::filesystem::path& config_folder) {
  config::FaultList faults;
  const auto loaded_boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  const auto loaded = faults.Take([&] { return config::Load<config::Georeferencer>(config_folder, "georeferencer.txtpb"); });
  if (loaded && loaded->has_guard_zone() && loaded->guard_zone().to_bearing_deg() == loaded->guard_zone().from_bearing_deg()) {
    faults.Add(config::FaultLine(config_folder / "georeferencer.txtpb", "guard_zone.to_bearing_deg", "must differ from from_bearing_deg"));
  }
  faults.ThrowIfAny();
  const auto& boat = *loaded_boat;
  const auto& message = *loaded;
  Params params;
  params.placement.T_vessel_lidar = boat.T_vessel_lidar;
  params.placement.reference_point_above_water_m = boat.reference_point_above_water_m;
  params.placement.range_sd_m = message.range_sd_m();
  params.placement.azimuth_sd_rad = DegToRad(message.azimuth_sd_deg());
  params.placement.mounting_sd_rad = DegToRad(message.mounting_sd_deg());
  if (message.has_guard_zone()) {
    const auto& zone = message.guard_zone();
    const double width_deg = zone.to_bearing_deg() - zone.from_bearing_deg();
    params.guard_zone.range_m = zone.range_m();
    params.guard_zone.bearing = {WrapTo2Pi(DegToRad(zone.from_bearing_deg())),
                                 std::abs(width_deg) >= 360.0 ? kTwoPi : WrapTo2Pi(DegToRad(width_deg))};
    params.guard_zone.takes_tentative = zone.takes_tentative();
  }
  params.datum = boat.datum;
  if (message.has_guard_zone() && IsInsideBox(params.guard_zone, boat.own_vessel_box_m)) {
    faults.Add(
        config::FaultLine(config_folder / "georeferencer.txtpb", "guard_zone.range_m", InsideHullText(params.guard_zone, boat.own_vessel_box_m)));
  }
  faults.ThrowIfAny();
  params.pose_timeout = std::chrono::round<std::chrono::microseconds>(std::chrono::duration<double>(message.pose_timeout_s()));
  return params;
}

}  // namespace lookout::georeferencer
