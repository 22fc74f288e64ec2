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
  double share = 1.0;       // of cubes that the returns fill, against returns that fit nowhere: lower is sharper
  double next_share = 1.0;  // the best of those that are turned against it by 45 deg or more
  bool is_clear = false;    // the others are clearly less sharp
};

/// Looks at 24 moments of the 12 s in which the boat turns most, with 6 directions of the lidar's axis and 24 of yaw, and refines the best.
///
/// @param assumed  its mounting is that of boat.txtpb
/// @return nullopt where there are too few returns
std::optional<CoarseResult> SearchCoarsely(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed);

}  // namespace lookout::calibrate
