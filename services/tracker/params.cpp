#include "services/tracker/params.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/lidar.pb.h"
#include "config/schema/segmenter.pb.h"
#include "config/schema/tracker.pb.h"

namespace lookout::tracker {

namespace {

// The hull in the middle of the box of own returns, no larger than it; the whole box where the size of the hull is not set.
std::vector<Eigen::Vector2d> OwnHull(const config::BoatFacts& boat) {
  const Eigen::Vector2d center_m = boat.own_vessel_box_m.center().head<2>();
  Eigen::Vector2d half_m = boat.own_vessel_box_m.sizes().head<2>() / 2.0;
  if (boat.hull_m) half_m = half_m.cwiseMin(Eigen::Vector2d(boat.hull_m->length_m, boat.hull_m->beam_m) / 2.0);
  const Eigen::Vector2d mirrored_m(half_m.x(), -half_m.y());
  return {center_m - half_m, center_m + mirrored_m, center_m + half_m, center_m - mirrored_m};
}

std::string InsideHullText(const GuardZoneParams& zone, const Eigen::AlignedBox3d& own_vessel_box_m) {
  return fmt::format(
      "the zone of {:.1f} m lies wholly inside own_vessel of boat.txtpb, which reaches {:.1f} m forward, {:.1f} m aft, {:.1f} m to port "
      "and {:.1f} m to starboard: returns in there are own boat, so nothing can raise an alert",
      zone.range_m, own_vessel_box_m.max().x(), -own_vessel_box_m.min().x(), own_vessel_box_m.max().y(), -own_vessel_box_m.min().y());
}

GuardZoneParams ToGuardZone(const config::GuardZone& zone) {
  constexpr double kWholeCircleDeg = 360.0;
  const double width_deg = zone.to_bearing_deg() - zone.from_bearing_deg();
  return {.range_m = zone.range_m(),
          .bearing = {WrapTo2Pi(DegToRad(zone.from_bearing_deg())), std::abs(width_deg) >= kWholeCircleDeg ? kTwoPi : WrapTo2Pi(DegToRad(width_deg))},
          .takes_tentative = zone.takes_tentative()};
}

// Of the lidar that lidar.txtpb names. Where there is none, or it is wrong, those of a VLP-16: they serve for words alone.
std::vector<float> ExpectedElevations(const std::filesystem::path& config_folder) {
  constexpr int kNumBeams = 16;
  double most_deg = 15.0;  // VLP-16 User Manual 63-9243 Rev E; Puck Hi-Res 63-9318
  config::FaultList untold;
  untold.Try([&] {
    const auto lidar = config::Load<config::Lidar>(config_folder, "lidar.txtpb");
    if (lidar.model() == config::Lidar::MODEL_PUCK_HI_RES) most_deg = 10.0;
  });
  std::vector<float> elevation_rad;
  elevation_rad.reserve(kNumBeams);
  for (int i = 0; i < kNumBeams; ++i) elevation_rad.push_back(static_cast<float>(DegToRad(most_deg * (2.0 * i / (kNumBeams - 1) - 1.0))));
  return elevation_rad;
}

ZoneSightParams ToZoneSight(const GuardZoneParams& zone, const config::BoatFacts& boat, const config::Segmenter& segmenter) {
  constexpr double kWholeCircleDeg = 360.0;
  ZoneSightParams params;
  params.zone = zone;
  params.T_vessel_lidar = boat.T_vessel_lidar;
  params.reference_point_above_water_m = boat.reference_point_above_water_m;
  params.min_range_m = segmenter.min_range_m();
  params.max_range_m = segmenter.max_range_m();
  if (segmenter.field_of_view_width_deg() < kWholeCircleDeg)
    params.field_of_view = {DegToRad(segmenter.field_of_view_start_deg()), DegToRad(segmenter.field_of_view_width_deg())};
  params.own_vessel_box_m = boat.own_vessel_box_m;
  for (const auto& corner : OwnHull(boat)) params.own_hull_m.extend(corner);
  return params;
}

LookOutParams ToLookOut(const config::Tracker& message, const GuardZoneParams& zone) {
  LookOutParams params;
  params.alerts = {message.raise_probability(), message.clear_probability(), message.clear_s()};
  params.ability = {message.reaction_s(), message.deceleration_mps2(), DegToRad(message.turn_rate_degps())};
  params.limits.guard_zone = zone;
  params.limits.cpa_limit_m = message.cpa_limit_m();
  params.limits.mode = static_cast<Mode>(message.mode());
  params.limits.harbour_margin_m = message.harbour_margin_m();
  params.limits.harbour_cpa_limit_m = message.harbour_cpa_limit_m();
  params.limits.least_guard_zone_m = message.least_guard_zone_m();
  params.limits.most_guard_zone_m = message.most_guard_zone_m();
  params.limits.least_cpa_limit_m = message.least_cpa_limit_m();
  params.limits.most_cpa_limit_m = message.most_cpa_limit_m();
  return params;
}

}  // namespace

Params LoadParams(const std::filesystem::path& config_folder) {
  const auto file = config_folder / "tracker.txtpb";
  config::FaultList faults;
  const auto boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  const auto segmenter = faults.Take([&] { return config::Load<config::Segmenter>(config_folder, "segmenter.txtpb"); });
  const auto message = faults.Take([&] { return config::Load<config::Tracker>(config_folder, "tracker.txtpb"); });
  if (message && message->clear_probability() > message->raise_probability()) {
    faults.Add(config::FaultLine(file, "clear_probability", "must not be above raise_probability"));
  }
  if (message && message->end_probability() >= message->confirm_probability()) {
    faults.Add(config::FaultLine(file, "end_probability", "must be below confirm_probability"));
  }
  if (message && message->least_guard_zone_m() > message->most_guard_zone_m()) {
    faults.Add(config::FaultLine(file, "least_guard_zone_m", "must not be above most_guard_zone_m"));
  }
  if (message && message->least_cpa_limit_m() > message->most_cpa_limit_m()) {
    faults.Add(config::FaultLine(file, "least_cpa_limit_m", "must not be above most_cpa_limit_m"));
  }
  if (message && message->has_guard_zone() && message->guard_zone().to_bearing_deg() == message->guard_zone().from_bearing_deg()) {
    faults.Add(config::FaultLine(file, "guard_zone.to_bearing_deg", "must differ from from_bearing_deg"));
  }
  faults.ThrowIfAny();

  Params params;
  auto& zone = params.look_out.limits.guard_zone;
  if (message->has_guard_zone()) {
    zone = ToGuardZone(message->guard_zone());
    if (IsInsideBox(zone, boat->own_vessel_box_m)) {
      faults.Add(config::FaultLine(file, "guard_zone.range_m", InsideHullText(zone, boat->own_vessel_box_m)));
      faults.ThrowIfAny();
    }
  }
  params.zone_sight = ToZoneSight(zone, *boat, *segmenter);
  params.cover = {boat->T_vessel_lidar, segmenter->min_range_m(), params.zone_sight.field_of_view, boat->own_vessel_box_m};
  params.zone_sight.expected_elevation_rad = ExpectedElevations(config_folder);
  params.tracker.T_vessel_lidar = boat->T_vessel_lidar;
  params.tracker.reference_point_above_water_m = boat->reference_point_above_water_m;
  params.tracker.max_range_m = segmenter->max_range_m();
  params.tracker.own_hull_m = OwnHull(*boat);
  params.tracker.encounter = {message->cpa_limit_m(), message->look_ahead_s()};
  params.tracker.moving_probability = message->moving_probability();
  params.tracker.confirm_probability = message->confirm_probability();
  params.tracker.end_probability = message->end_probability();
  params.look_out = ToLookOut(*message, zone);
  const Eigen::AlignedBox2d own_box_m(boat->own_vessel_box_m.min().head<2>(), boat->own_vessel_box_m.max().head<2>());
  params.look_out.limits.own_reach_m = own_box_m.min().cwiseAbs().cwiseMax(own_box_m.max().cwiseAbs()).norm();
  params.wait_timeout = std::chrono::round<std::chrono::microseconds>(std::chrono::duration<double>(message->wait_timeout_s()));
  return params;
}

}  // namespace lookout::tracker
