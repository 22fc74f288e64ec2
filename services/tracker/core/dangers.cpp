#include "services/tracker/core/dangers.hpp"

#include <algorithm>
#include <map>

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

bool IsConfirmed(const Track& track) { return track.status == TrackStatus::kConfirmed || track.status == TrackStatus::kCoasting; }

Danger InZone(std::int64_t track_id, const NearestPoint& point) {
  return {.cause = AlertCause::kGuardZone,
          .track_id = track_id,
          .probability = 1.0,
          .distance_m = point.range_m,
          .bearing_rad = point.bearing_rad,
          .is_inside = true};
}

}  // namespace

std::vector<Danger> GuardZoneDangers(const GuardZoneParams& params, const Picture& picture, std::span<const VesselOutline> outlines,
                                     const std::optional<Pose>& own) {
  if (params.range_m <= 0.0) return {};
  std::map<std::int64_t, std::optional<NearestPoint>> nearest;  // of each track, land and what has no name
  const auto add = [&](std::int64_t track_id, std::span<const Eigen::Vector2d> corners_m, bool is_closed) {
    const auto point = NearestWithin(params.bearing, corners_m, is_closed);
    if (point && point->range_m <= params.range_m) KeepNearer(nearest[track_id], point);
  };

  std::map<std::int32_t, const Track*> track_of;
  for (const auto& track : picture.tracks) {
    for (const auto id : track.segment_ids) track_of.emplace(id, &track);
  }
  for (const auto& outline : outlines) {
    const auto found = track_of.find(outline.segment_id);
    const Track* track = found == track_of.end() ? nullptr : found->second;
    if (!outline.is_sure && !params.takes_tentative && (track == nullptr || !IsConfirmed(*track))) continue;
    const bool is_land = outline.is_land || std::ranges::count(picture.land_segment_ids, outline.segment_id) > 0;
    const auto track_id = track != nullptr ? track->id : is_land ? kLandTrack : kUnnamed;
    if (!outline.nearest_m.hasNaN()) add(track_id, {&outline.nearest_m, 1}, false);
    add(track_id, outline.corners_m, !outline.is_line);
  }
  if (own) {
    for (const auto& track : picture.tracks) {
      if (IsConfirmed(track) || (track.status == TrackStatus::kTentative && params.takes_tentative))
        add(track.id, InVessel(track.outline_m, *own), true);
    }
  }

  std::vector<Danger> dangers;
  for (const auto& [track_id, point] : nearest) {
    if (point) dangers.push_back(InZone(track_id, *point));
  }
  return dangers;
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
    if (!IsConfirmed(track)) continue;
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
