// Input and output of the georeferencer: the segments of one SEGMENTS message, and their obstacles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/core/pose.hpp"
#include "common/core/utime.hpp"

namespace lookout::georeferencer {

/// A corner of a segment's outline or waterline, lidar frame, with the time at which it was seen.
struct HullVertex {
  Eigen::Vector2d p_lidar_m;
  Utime time;
};

// Both enumerations have the numbers of the wire.
enum class Confidence : std::int32_t { kTentative = 1, kSure = 2 };
enum class Kind : std::int32_t { kObstacle = 0, kLand = 1 };

/// How the segmenter rates a segment; its obstacle repeats it.
struct Rating {
  Confidence confidence = Confidence::kSure;
  std::int32_t grounds = 0;  // bits of the wire: why the segment is tentative
  Kind kind = Kind::kObstacle;
  float thing_probability = std::numeric_limits<float>::quiet_NaN();  // 0 to 1, that the segment is no clutter; NaN = not stated
  float seen_share = 1.0F;                                            // 0 to 1, of the columns from the segment's first to its last
};

/// Members that an obstacle takes from its segment.
struct Seen {
  Utime time;  // mean of the times of the segment's returns
  std::int32_t id = 0;
  Rating rating;
  std::int32_t num_points = 0;
  float length_m = 0.0F;
  float width_m = 0.0F;
  float mean_reflectivity = 0.0F;
};

/// One segment in the lidar frame. Numbers are finite, times within the scan, the hull is not empty.
struct Segment : Seen {
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d nearest_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d top_m = Eigen::Vector3d::Zero();  // highest return along the vessel's z axis
  double min_z_m = 0.0;
  double max_z_m = 0.0;
  std::vector<HullVertex> hull;       // counter-clockwise seen from the lidar's z axis
  std::vector<HullVertex> waterline;  // of land, an open line, clockwise seen from the lidar's z axis; empty for others
};

/// Members that a SEGMENTS message and its OBSTACLES share.
struct ScanHead {
  Utime time;
  Utime end_time;  // last laser shot
  std::int64_t seq = 0;
  std::int64_t raw_seq = 0;
  std::int32_t scan_flags = 0;
  std::int32_t part_index = 0;
  std::int32_t num_parts = 1;
  std::int32_t num_scan_segments = 0;
};

/// One SEGMENTS message: a scan, or a part of one.
struct SegmentPart {
  ScanHead head;
  std::vector<Segment> segments;
  std::int64_t num_returns = 0;  // of the columns of this part, in segments or not
};

// The numbers are those of the wire.
enum class ObstacleStatus : std::int32_t { kOk = 0, kVesselFrameOnly = 1, kPoseTimeout = 2 };

/// One obstacle. Members for the map are NaN, footprint_map_m and waterline_map_m are empty, unless status is kOk.
struct Obstacle : Seen {
  ObstacleStatus status = ObstacleStatus::kVesselFrameOnly;
  double latitude_deg = kNan;
  double longitude_deg = kNan;
  Eigen::Vector2d position_map_m = Eigen::Vector2d::Constant(kNan);
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Constant(kNan);           // east, north
  Eigen::Matrix2d covariance_relative_m2 = Eigen::Matrix2d::Constant(kNan);  // east, north; without the error of the own position
  double top_above_water_m = 0.0;
  Eigen::Vector2d center_vessel_m = Eigen::Vector2d::Zero();
  Eigen::Vector3d nearest_vessel_m = Eigen::Vector3d::Zero();
  double range_m = 0.0;      // horizontal, from the vessel's origin to the nearest return
  double bearing_rad = 0.0;  // of the nearest return, from the bow clockwise, 0 to 2 pi
  double height_m = 0.0;
  std::vector<Eigen::Vector2d> footprint_vessel_m;  // counter-clockwise seen from above
  std::vector<Eigen::Vector2d> footprint_map_m;
  std::vector<Eigen::Vector2d> waterline_vessel_m;  // clockwise seen from above
  std::vector<Eigen::Vector2d> waterline_map_m;
};

/// One SEGMENTS message, placed.
struct ObstaclePart {
  ScanHead head;
  Datum datum;  // origin of the map frame of the obstacles
  std::vector<Obstacle> obstacles;
};

}  // namespace lookout::georeferencer
