// F3D: runs along each ring, merged with runs of the ring above.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "lab/eval/baselines/peer.hpp"

namespace lookout::eval {

/// Defaults: the paper's.
struct GroundPlaneParams {
  int num_segments = 3;  // along x, of equal length; each has a plane of its own
  int num_iterations = 3;
  int num_lowest = 20;          // whose mean height is the ground's to begin with
  double seed_height_m = 0.4;   // points lower than that over it are the first guess
  double max_distance_m = 0.2;  // of ground from the plane, above it; all below is ground too
};

/// The ground as planes fitted to the lowest points.
///
/// @param points_m  x forward, z up
/// @return [points] whether it is ground
/// Source: as F3dGrouping, algorithm 1.
std::vector<bool> FitGround(std::span<const Eigen::Vector3d> points_m, const GroundPlaneParams& params);

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
