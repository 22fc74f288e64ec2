// The fifth step: what is said of each segment.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/utime.hpp"
#include "services/segmenter/core/breadth_first_search.hpp"
#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

struct HullCorner {
  float x_m = 0.0F;
  float y_m = 0.0F;
  std::int32_t time_us = 0;  // of the return at this corner, since ScanHead::time, rounded down
};

/// One obstacle in the lidar frame.
struct Segment {
  Utime time;  // mean of the times of its returns, rounded down
  std::int32_t id = 0;
  std::int32_t num_points = 0;
  Point centroid;
  Point nearest;  // return nearest to the sensor; of equals the first
  Utime nearest_time;
  Point top;  // highest return along the vessel's up axis; of equals the first
  float length_m = 0.0F;
  float width_m = 0.0F;
  float length_azimuth_rad = 0.0F;
  float min_z_m = 0.0F;
  float max_z_m = 0.0F;
  float mean_reflectivity = 0.0F;
  std::int32_t max_reflectivity = 0;
  std::vector<HullCorner> hull;  // counter-clockwise, 1 to kMaxHullCorners
};

/// @param segments  groups of the returns; group i gets the id i + 1
/// @param up        the vessel's z axis in the lidar frame, a unit vector: a lidar that is mounted tilted sees its own z axis lean
/// @return [segments.count] by id
std::vector<Segment> Measure(const Scan& scan, std::span<const Return> returns, const Groups& segments, const Eigen::Vector3d& up);

}  // namespace lookout::segmenter
