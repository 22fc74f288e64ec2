// The values of one scan that the tracker uses. They are valid: wire.cpp lets no others in.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/pose.hpp"
#include "common/core/utime.hpp"

namespace lookout::tracker {

/// One obstacle of the scan, on the map.
struct Seen {
  std::int32_t segment_id = 0;
  Utime time;  // mean of its returns
  bool is_sure = true;
  bool is_land = false;
  double thing_probability = 1.0;  // 0 to 1, that it is no clutter; of a method that states none 0.9 where sure, 0.1 where tentative
  int num_returns = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();              // map
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();           // east, north
  Eigen::Matrix2d covariance_relative_m2 = Eigen::Matrix2d::Zero();  // without the error of the own position
  double top_above_water_m = 0.0;
  std::vector<Eigen::Vector2d> outline_m;    // map, counter-clockwise, at least one corner
  std::vector<Eigen::Vector2d> waterline_m;  // of land: open line
};

/// The beams of the scan: which water was looked through. Column-major: ring fastest.
struct Sweep {
  std::vector<float> elevation_rad;       // [rings] from the lowest up
  std::vector<float> azimuth_offset_rad;  // [rings]
  std::vector<float> azimuth_rad;         // [columns] increasing from the first, 0 to 2 pi, clockwise; a gap is where packets were lost
  std::vector<Utime> time;                // [columns]
  std::vector<float> range_m;             // [columns x rings] first return; 0 = none
  std::vector<std::int16_t> label;        // [columns x rings] of SEGMENTS: above 0 the segment's id; empty where SEGMENTS did not come
  std::vector<std::int16_t> piece;  // [columns x rings] of SEGMENTS: where a label is above 0 the piece, from 1; empty: each segment is one piece
};

struct ScanInput {
  Utime time;      // first firing
  Utime end_time;  // last shot: states are propagated to it
  std::int64_t seq = 0;
  std::int32_t flags = 0;
  Datum datum;
  std::vector<Seen> seen;
  std::optional<Pose> own_at_start;  // at time; nullopt: position or heading was not known
  std::optional<Pose> own;           // at end_time
  std::optional<Sweep> sweep;        // nullopt: LIDAR_SCAN did not come
};

}  // namespace lookout::tracker
