// The ground as planes fitted to the lowest points: the first step of F3D.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace lookout::eval {

/// Defaults: the paper's.
struct GroundPlaneParams {
  int num_segments = 3;  // along x, of equal length; each has a plane of its own
  int num_iterations = 3;
  int num_lowest = 20;          // whose mean height is the ground's to begin with
  double seed_height_m = 0.4;   // points lower than that over it are the first guess
  double max_distance_m = 0.2;  // of ground from the plane, above it; what lies below is ground too
};

/// @param points_m  x forward, z up
/// @return [points] whether it is ground
/// Source: D. Zermas, I. Izzat and N. Papanikolopoulos, "Fast Segmentation of 3D Point Clouds: A Paradigm on LiDAR Data for Autonomous Vehicle
/// Applications", ICRA 2017, algorithm 1.
std::vector<bool> FitGround(std::span<const Eigen::Vector3d> points_m, const GroundPlaneParams& params);

}  // namespace lookout::eval
