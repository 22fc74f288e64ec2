#include "services/tracker/core/dangers.hpp"

#include <algorithm>

namespace lookout::tracker {

namespace {

// Half a knot: below any way that steers.
constexpr double kOwnStillMps = 0.26;
// Longer than a moored boat sways to one side, shorter than it takes to cast off.
constexpr double kOwnAverageS = 5.0;

std::vector<Eigen::Vector2d> InVessel(std::span<const Eigen::Vector2d> corners_map_m, const Pose& own) {
  const auto [sine, cosine] = SinCosOf(own.heading_rad);
  std::vector<Eigen::Vector2d> corners_m;
  for (const auto& corner : corners_map_m) {
    const Eigen::Vector2d offset = corner - own.position_map_m.head<2>();
    corners_m.emplace_back(offset.x() * sine + offset.y() * cosine, offset.y() * sine - offset.x() * cosine);
  }
  return corners_m;
}

Danger InZone(std::int64_t track_id, const NearestPoint& point) {
  return {.cause = AlertCause::kGuardZone,
          .track_id = track_id,
          .probability = 1.0,
          .distance_m = point.range_m,
          .bearing_rad = point.bearing_rad,
          .is_inside = true};
}

}  // namespace

std::vector<Danger> GuardZoneDangers(const GuardZoneParams& params, const Picture& picture, std::span<const Seen> seen, const Pose& own) {
  std::vector<Danger> dangers;
  if (params.range_m <= 0.0) return dangers;
  const auto nearest_in_zone = [&](std::span<const Eigen::Vector2d> corners_map_m, bool is_closed) {
    auto nearest = NearestWithin(params.bearing, InVessel(corners_map_m, own), is_closed);
    if (nearest && nearest->range_m > params.range_m) nearest.reset();
    return nearest;
  };
  std::optional<NearestPoint> land;
  for (const auto& thing : seen) {
    if (!thing.is_land && std::ranges::count(picture.land_segment_ids, thing.segment_id) == 0) continue;
    if (!thing.is_sure && !params.takes_tentative) continue;
    const bool has_waterline = !thing.waterline_m.empty();
    KeepNearer(land, nearest_in_zone(has_waterline ? thing.waterline_m : thing.outline_m, !has_waterline));
  }
  if (land) dangers.push_back(InZone(0, *land));
  for (const auto& track : picture.tracks) {
    if (track.status == TrackStatus::kLost || (track.status == TrackStatus::kTentative && !params.takes_tentative)) continue;
    if (const auto nearest = nearest_in_zone(track.outline_m, true)) dangers.push_back(InZone(track.id, *nearest));
  }
  return dangers;
}

std::vector<Danger> GuardZoneDangers(const GuardZoneParams& params, std::span<const VesselOutline> outlines) {
  if (params.range_m <= 0.0) return {};
  std::optional<NearestPoint> nearest;
  for (const auto& outline : outlines) {
    if (!outline.is_sure && !params.takes_tentative) continue;
    const auto point = NearestWithin(params.bearing, outline.corners_m, !outline.is_line);
    if (point && point->range_m <= params.range_m) KeepNearer(nearest, point);
  }
  if (!nearest) return {};
  return {InZone(0, *nearest)};
}

bool StillWatch::Update(Utime time, const Eigen::Vector2d& velocity_mps) {
  const double step_s = ToSeconds(time - newest_);
  newest_ = time;
  if (mean_mps_.hasNaN() || velocity_mps.hasNaN() || step_s < 0.0 || step_s > 1.0) {
    mean_mps_ = velocity_mps;
  } else {
    mean_mps_ += step_s / (kOwnAverageS + step_s) * (velocity_mps - mean_mps_);
  }
  return mean_mps_.norm() < kOwnStillMps;  // false where it is NaN
}

std::vector<Danger> ClosestApproachDangers(double limit_m, const Picture& picture, bool is_own_still) {
  std::vector<Danger> dangers;
  for (const auto& track : picture.tracks) {
    if (track.status != TrackStatus::kConfirmed && track.status != TrackStatus::kCoasting) continue;
    if (is_own_still && track.velocity_mps.isZero(0.0)) continue;
    dangers.push_back({.cause = AlertCause::kClosestApproach,
                       .track_id = track.id,
                       .probability = track.approach.probability,
                       .tcpa_s = track.approach.tcpa_s,
                       .distance_m = track.approach.distance_m,
                       .bearing_rad = track.bearing_rad,
                       .cpa_m = track.approach.cpa_m,
                       .is_inside = track.approach.distance_m < limit_m});
  }
  return dangers;
}

}  // namespace lookout::tracker
