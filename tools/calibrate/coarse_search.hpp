// The mounting to a few degrees, whatever boat.txtpb says: of all orientations, the one with which what stands keeps its place while the boat moves.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "services/odometer/core/standing.hpp"
#include "tools/calibrate/pose_track.hpp"
#include "tools/calibrate/surroundings.hpp"

namespace lookout::calibrate {

struct CoarseResult {
  Eigen::Matrix3d R_vessel_lidar = Eigen::Matrix3d::Identity();
  double share = 1.0;       // cubes that the returns of all moments fill, as a share of those that each moment fills alone: lower is sharper
  double next_share = 1.0;  // the same share of the best mounting that is turned by 45 deg or more from this one
  bool is_clear = false;    // all such other mountings are clearly less sharp
};

/// Looks at 24 moments of the 12 s in which the boat turns most, with 6 directions of the lidar's axis and 24 of yaw, and refines the best.
///
/// @param assumed  holds the mounting of boat.txtpb
/// @return nullopt where there are too few returns
std::optional<CoarseResult> SearchCoarsely(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed);

}  // namespace lookout::calibrate
