#include "services/tracker/core/dangers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include "common/core/angles.hpp"

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

// What is in the zone under one name.
struct InZone {
  std::optional<NearestPoint> nearest;
  std::vector<NearestPoint> things;  // the nearest point of each obstacle
};

Danger DangerOf(std::int64_t track_id, const NearestPoint& nearest, const std::vector<NearestPoint>& places, const std::optional<Pose>& own) {
  Danger danger{.cause = AlertCause::kGuardZone,
                .track_id = track_id,
                .probability = 1.0,
                .distance_m = nearest.range_m,
                .bearing_rad = nearest.bearing_rad,
                .is_inside = true};
  for (const auto& place : places) {
    DangerPlace told{place.range_m, place.bearing_rad};
    if (own) {
      const auto [sine, cosine] = SinCosOf(own->heading_rad + place.bearing_rad);
      told.position_map_m = own->position_map_m.head<2>() + place.range_m * Eigen::Vector2d(sine, cosine);
    }
    danger.places.push_back(told);
  }
  return danger;
}

// The nearest land of the zone in each bin of bearing: of what is land, an acknowledgement covers these.
class ShoreBearings {
 public:
  explicit ShoreBearings(const GuardZoneParams& zone) : zone_(zone) {}

  void Add(const NearestPoint& point) {
    if (point.range_m > zone_.range_m || !zone_.bearing.Contains(point.bearing_rad)) return;
    KeepNearer(nearest_.at(std::min(static_cast<std::size_t>(point.bearing_rad / kBinRad), kBins - 1)), point);
  }

  // All along the edges.
  void Add(std::span<const Eigen::Vector2d> corners_m, bool is_closed) {
    for (std::size_t i = 0; i + 1 < corners_m.size(); ++i) AddEdge(corners_m[i], corners_m[i + 1]);
    if (is_closed && corners_m.size() > 2) AddEdge(corners_m.back(), corners_m.front());
  }

  std::vector<NearestPoint> Places() const {
    std::vector<NearestPoint> places;
    for (const auto& point : nearest_) {
      if (point) places.push_back(*point);
    }
    return places;
  }

 private:
  static constexpr std::size_t kBins = 72;
  static constexpr double kBinRad = kTwoPi / kBins;
  static_assert(kBinRad <= 0.5 * ToldPlaces::kBesideRad);

  // In steps that pass over no bin.
  void AddEdge(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    const double length_m = (to_m - from_m).norm();
    if (length_m == 0.0) return;
    const Eigen::Vector2d along = (to_m - from_m) / length_m;
    // What of it lies within the range.
    const double middle_m = -from_m.dot(along);
    const double half2_m2 = zone_.range_m * zone_.range_m - (from_m + middle_m * along).squaredNorm();
    if (half2_m2 < 0.0) return;
    const double end_m = std::min(length_m, middle_m + std::sqrt(half2_m2));
    for (double at_m = std::max(0.0, middle_m - std::sqrt(half2_m2)); at_m <= end_m;) {
      const Eigen::Vector2d point = from_m + at_m * along;
      const double range_m = point.norm();
      Add({range_m, WrapTo2Pi(Atan2(-point.y(), point.x()))});
      at_m += std::max(kLeastStepM, 0.5 * kBinRad * range_m);
    }
  }

  static constexpr double kLeastStepM = 0.05;

  const GuardZoneParams& zone_;
  std::array<std::optional<NearestPoint>, kBins> nearest_;
};

}  // namespace

std::vector<Danger> GuardZoneDangers(const GuardZoneParams& params, const Picture& picture, std::span<const VesselOutline> outlines,
                                     const std::optional<Pose>& own) {
  if (params.range_m <= 0.0) return {};
  std::map<std::int64_t, InZone> in_zone;  // of each track, land and what has no name
  ShoreBearings shore(params);
  const auto add = [&](std::int64_t track_id, const std::optional<NearestPoint>& point) {
    if (!point || point->range_m > params.range_m) return;
    KeepNearer(in_zone[track_id].nearest, point);
    in_zone[track_id].things.push_back(*point);
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
    auto nearest = NearestWithin(params.bearing, outline.corners_m, !outline.is_line);
    if (!outline.nearest_m.hasNaN()) KeepNearer(nearest, NearestWithin(params.bearing, {&outline.nearest_m, 1}, false));
    add(track_id, nearest);
    if (track_id != kLandTrack) continue;
    if (nearest) shore.Add(*nearest);
    shore.Add(outline.corners_m, !outline.is_line);
  }
  if (own) {
    for (const auto& track : picture.tracks) {
      if (IsConfirmed(track) || (track.status == TrackStatus::kTentative && params.takes_tentative))
        add(track.id, NearestWithin(params.bearing, InVessel(track.outline_m, *own), true));
    }
  }

  std::vector<Danger> dangers;
  dangers.reserve(in_zone.size());
  for (const auto& [track_id, found] : in_zone) {
    dangers.push_back(DangerOf(track_id, *found.nearest, track_id == kLandTrack ? shore.Places() : found.things, own));
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
  if (picture.land_approach && !is_own_still) {
    const auto& [approach, land_limit_m, bearing_rad, places] = *picture.land_approach;
    dangers.push_back({.cause = AlertCause::kClosestApproach,
                       .track_id = kLandTrack,
                       .probability = approach.probability,
                       .tcpa_s = approach.tcpa_s,
                       .distance_m = approach.distance_m,
                       .bearing_rad = bearing_rad,
                       .cpa_m = approach.cpa_m,
                       .is_inside = approach.distance_m < land_limit_m,
                       .places = places});
  }
  return dangers;
}

}  // namespace lookout::tracker
