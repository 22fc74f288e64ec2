// F3D: runs along each ring, merged with those of the ring above.
#pragma once

#include <optional>

#include "tools/eval/baselines/ground_plane.hpp"
#include "tools/eval/baselines/peer.hpp"

namespace lookout::eval {

/// Defaults: the paper's.
struct F3dParams {
  std::optional<GroundPlaneParams> ground = GroundPlaneParams{};  // nullopt = no ground is sought
  double run_distance_m = 0.5;                                    // Th_run: between successive returns of a ring
  double merge_distance_m = 1.0;                                  // Th_merge: to the nearest return of the ring above
};

/// Scan line run: on each ring, successive returns near each other are a run, which is closed around the circle; from the top down, each return
/// takes the label of the nearest one of the ring above if that is near, and labels that meet so become one.
///
/// In dual return all returns of a shot follow all of the shot before.
/// Source: D. Zermas, I. Izzat and N. Papanikolopoulos, "Fast Segmentation of 3D Point Clouds: A Paradigm on LiDAR Data for Autonomous Vehicle
/// Applications", ICRA 2017, algorithms 1 and 2. Written from these. Cost: a search in a k-d tree of one ring per return.
///
/// @param T_vessel_lidar  of the filter: ground is sought in the frame of the vessel
Grouping F3dGrouping(const F3dParams& params, const Eigen::Isometry3d& T_vessel_lidar);

}  // namespace lookout::eval
