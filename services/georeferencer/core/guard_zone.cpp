#include "services/georeferencer/core/guard_zone.hpp"

#include <vector>

namespace lookout::georeferencer {

std::optional<NearestPoint> NearestWithin(const Sector& bearing, const VesselOutline& outline) {
  const bool has_waterline = !outline.waterline_m.empty();
  std::vector<Eigen::Vector2d> corners_m;
  for (const auto& corner_m : has_waterline ? outline.waterline_m : outline.footprint_m) corners_m.emplace_back(corner_m.head<2>());
  const Eigen::Vector2d nearest_return_m = outline.nearest_m.head<2>();
  auto nearest = lookout::NearestWithin(bearing, {&nearest_return_m, 1}, false);
  KeepNearer(nearest, lookout::NearestWithin(bearing, corners_m, !has_waterline));
  return nearest;
}

std::optional<NearestPoint> NearestInZone(const GuardZoneParams& params, const SegmentPart& part, const Eigen::Isometry3d& T_vessel_lidar) {
  std::optional<NearestPoint> nearest;
  for (const auto& segment : part.segments) {
    if (segment.rating.confidence == Confidence::kTentative && !params.takes_tentative) continue;
    const auto point = NearestWithin(params.bearing, OutlineOf(segment, T_vessel_lidar));
    if (point && point->range_m <= params.range_m) KeepNearer(nearest, point);
  }
  return nearest;
}

}  // namespace lookout::georeferencer
