// The guard zone around the boat, as of a radar: a sector, and the nearest point of an outline in it.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "common/core/angles.hpp"

namespace lookout {

struct GuardZoneParams {
  double range_m = 0.0;          // horizontal, from the vessel's origin; 0 = no alarm
  Sector bearing;                // of the sector, from the bow clockwise
  bool takes_tentative = false;  // whether tentative obstacles, which may be spray, raise the alarm too
};

/// Whether the whole zone lies within a box, seen from above. In the box around the own hull nothing can be seen that is not own boat.
bool IsInsideBox(const GuardZoneParams& params, const Eigen::AlignedBox3d& box_m);

/// The point of an outline that is nearest to the boat within a sector.
struct NearestPoint {
  double range_m = 0.0;      // horizontal, from the vessel's origin
  double bearing_rad = 0.0;  // from the bow clockwise, 0 to 2 pi
};

/// Keeps the nearer of two.
inline void KeepNearer(std::optional<NearestPoint>& nearest, const std::optional<NearestPoint>& other) {
  if (other && (!nearest || other->range_m < nearest->range_m)) nearest = other;
}

/// Along the edges too, not only at the corners: a long wall is nearest between two.
///
/// @param corners_vessel_m  x forward, y port; of an outline or an open line
/// @param is_closed         whether the last corner has an edge to the first
/// @return nullopt when no part of the outline lies within the sector. An outline around the boat is as near as its edge
std::optional<NearestPoint> NearestWithin(const Sector& bearing, std::span<const Eigen::Vector2d> corners_vessel_m, bool is_closed);

}  // namespace lookout
