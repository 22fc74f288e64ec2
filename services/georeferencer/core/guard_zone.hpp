// The alarm for what comes too near: watches a sector around the boat, like the guard zone of a radar.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/core/guard_sector.hpp"
#include "services/georeferencer/core/obstacle.hpp"
#include "services/georeferencer/core/placement.hpp"

namespace lookout::georeferencer {

/// Along the outline: the footprint, or of land its waterline where there is one. Not only its corners: a long wall is nearest between two.
///
/// @return nullopt when nothing of the outline lies within the sector
std::optional<NearestPoint> NearestWithin(const Sector& bearing, const VesselOutline& outline);

/// What a SEGMENTS message shows of the zone. In the vessel frame: it needs no POSE and waits for none.
///
/// @return nullopt when nothing that counts lies within range and sector
std::optional<NearestPoint> NearestInZone(const GuardZoneParams& params, const SegmentPart& part, const Eigen::Isometry3d& T_vessel_lidar);

}  // namespace lookout::georeferencer
