// From a segment in the lidar frame to an obstacle on the earth.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "common/core/pose.hpp"
#include "services/georeferencer/core/obstacle.hpp"

namespace lookout::georeferencer {

struct PlacementParams {
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  double reference_point_above_water_m = 0.0;
  double range_sd_m = 0.0;       // of one range
  double azimuth_sd_rad = 0.0;   // of one return, about the lidar's axis
  double mounting_sd_rad = 0.0;  // of the mounting, about each of three axes
};

/// Outlines with more corners are thinned to this many, evenly by number. Of a circle of 100 m radius, thinned to 140 corners, no point is
/// farther than 25 mm from the outline; a range is off by 30 mm.
inline constexpr std::size_t kMaxFootprintVertices = 140;

/// A waterline of the segmenter has no more; a longer one, of another publisher, is thinned, evenly by number, both ends kept.
inline constexpr std::size_t kMaxWaterlineVertices = 256;

/// @return every vertex; of more than kMaxFootprintVertices so many, the first among them
std::vector<HullVertex> Thinned(const std::vector<HullVertex>& hull);

/// @return every vertex; of more than kMaxWaterlineVertices so many, the first and the last among them
std::vector<HullVertex> ThinnedLine(const std::vector<HullVertex>& line);

/// A segment's outline and waterline (thinned) and its nearest return in the vessel frame, as they were seen, at the mean height of its returns.
/// Seen from above the outline is counter-clockwise, the waterline clockwise, also where the lidar hangs upside down.
struct VesselOutline {
  std::vector<Eigen::Vector3d> footprint_m;
  std::vector<Eigen::Vector3d> waterline_m;
  Eigen::Vector3d nearest_m = Eigen::Vector3d::Zero();
};
VesselOutline OutlineOf(const Segment& segment, const Eigen::Isometry3d& T_vessel_lidar);

/// Centre of an outline, seen from above.
///
/// @param vertices  at least one; around the outline in either sense
/// @return the centroid of the area in x and y, with z of the surface at that place; where the outline has next to no area (a point, a line,
///         or less than a ten-thousandth of its extent squared) the mean of the vertices
Eigen::Vector3d FootprintCenter(const std::vector<Eigen::Vector3d>& vertices);

/// 2 x 2 covariance (east, north) of a point that was seen from the vessel.
///
/// Linear in the errors of position, roll, pitch, heading (with their covariances), of the mounting's three angles, of range and azimuth.
/// @param p_vessel_m  the point
/// @param pose        placed
/// @return NaN where the pose does not know its own
/// Error: within 5 % of a Monte Carlo run for standard deviations of up to 5 degrees (property test georeferencer_covariance).
Eigen::Matrix2d PositionCovariance(const Eigen::Vector3d& p_vessel_m, const Pose& pose, const PlacementParams& params);

/// PositionCovariance without the error of the vessel's position, for the point relative to the vessel's origin. Two points seen from one boat share
/// that error; their distance from each other and from the boat does not contain it.
Eigen::Matrix2d RelativeCovariance(const Eigen::Vector3d& p_vessel_m, const Pose& pose, const PlacementParams& params);

/// Places a segment. p_map = T_map_vessel * T_vessel_lidar * p_lidar, each corner of outline and waterline with T_map_vessel at its own time;
/// both lie at the mean height of the returns. Position is the centre of the outline in the map; center_vessel_m the same point, seen from the vessel
/// at the time of the segment.
///
/// @param datum  origin of the map frame; poses with another datum do not count
/// @return status kOk when the pose is placed at the time of the segment and of each corner of outline and waterline; else kPoseTimeout when one of
///         these times lies after the newest pose and `has_timed_out`, else kVesselFrameOnly. Without a pose the vessel counts as level.
/// Error: below 1 mm for points nearer than 200 m (property test georeferencer_round_trip).
Obstacle PlaceSegment(const Segment& segment, const PoseHistory& poses, const Datum& datum, bool has_timed_out, const PlacementParams& params);

}  // namespace lookout::georeferencer
