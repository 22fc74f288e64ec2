// The alarm for what comes too near: watches a sector around the boat, like the guard zone of a radar.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/core/angles.hpp"
#include "services/georeferencer/core/obstacle.hpp"
#include "services/georeferencer/core/placement.hpp"

namespace lookout::georeferencer {

struct GuardZoneParams {
  double range_m = 0.0;          // horizontal, from the vessel's origin; 0 = no alarm
  Sector bearing;                // of the sector, from the bow clockwise
  bool takes_tentative = false;  // whether a tentative obstacle, which may be spray, raises the alarm too
};

/// Whether the whole zone lies within a box, seen from above. In the box around the own hull nothing can be seen that is not own boat.
bool IsInsideBox(const GuardZoneParams& params, const Eigen::AlignedBox3d& box_m);

/// The point of an obstacle's seen outline that is nearest to the boat within a sector.
struct NearestPoint {
  double range_m = 0.0;      // horizontal, from the vessel's origin
  double bearing_rad = 0.0;  // from the bow clockwise, 0 to 2 pi
};

/// Keeps the nearer of two.
inline void KeepNearer(std::optional<NearestPoint>& nearest, const std::optional<NearestPoint>& other) {
  if (other && (!nearest || other->range_m < nearest->range_m)) nearest = other;
}

/// Along the outline: the footprint, or of land its waterline where there is one. Not only its corners: a long wall is nearest between two.
///
/// @return nullopt when nothing of the outline lies within the sector
std::optional<NearestPoint> NearestWithin(const Sector& bearing, const VesselOutline& outline);

/// What a SEGMENTS message shows of the zone. In the vessel frame: it needs no POSE and waits for none.
///
/// @return nullopt when nothing that counts lies within range and sector
std::optional<NearestPoint> NearestInZone(const GuardZoneParams& params, const SegmentPart& part, const Eigen::Isometry3d& T_vessel_lidar);

}  // namespace lookout::georeferencer
