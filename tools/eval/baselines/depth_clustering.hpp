// Depth clustering: neighbours in the range image are one where the line between them faces the sensor steeply enough.
#pragma once

#include <optional>

#include "common/core/angles.hpp"
#include "tools/eval/baselines/depth_ground.hpp"
#include "tools/eval/baselines/peer.hpp"

namespace lookout::eval {

/// Defaults: the papers' 10 degrees; ground and least size as in the authors' program for KITTI.
struct DepthClusteringParams {
  std::optional<DepthGroundParams> ground = DepthGroundParams{};  // nullopt = no ground is sought, and no gap filled
  double angle_rad = DegToRad(10);
  // The next pixel with a return counts as the neighbour, if it is at most so many columns or rings away.
  int reach_columns = 1;
  int reach_rings = 1;
  SizeLimits limits{20, 100'000};
};

/// Connected components of the image by beta = atan2(d2 sin a, d1 - d2 cos a) > angle, d1 >= d2, a the angle between the beams.
///
/// The image has the scan's own columns, and in dual return all returns of a shot; of these the ground step sees the nearest.
/// Source: I. Bogoslavskyi and C. Stachniss, "Fast Range Image-Based Segmentation of Sparse 3D Laser Scans for Online Operation", IROS 2016, and
/// "Efficient Online Segmentation for Sparse 3D Laser Scans", PFG 85 (2017). Written from these. Cost: proportional to the pixels.
Grouping DepthGrouping(const DepthClusteringParams& params);

}  // namespace lookout::eval
