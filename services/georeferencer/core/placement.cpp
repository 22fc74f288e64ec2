#include "services/georeferencer/core/placement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/frames.hpp"
#include "common/core/geodesy.hpp"
#include "common/core/outlines.hpp"

namespace lookout::georeferencer {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Isometry3d TransformMapVessel(const Place& place) {
  Isometry3d T_map_vessel = Isometry3d::Identity();
  T_map_vessel.linear() = place.R_map_here * RotationMapVessel(place.heading_rad, place.pitch_rad, place.roll_rad);
  T_map_vessel.translation() = place.position_map_m;
  return T_map_vessel;
}

// Height above calm water of a point of the vessel; level where no pose is known.
double AboveWaterM(const Vector3d& p_vessel_m, const std::optional<Pose>& pose, double reference_point_above_water_m) {
  if (!pose) return p_vessel_m.z() + reference_point_above_water_m;
  const Vector3d p_level_m = RotationMapVessel(0.0, pose->pitch_rad, pose->roll_rad) * p_vessel_m;
  return p_level_m.z() + reference_point_above_water_m + pose->heave_m;
}

// Outline and waterline of a segment, thinned.
struct Corners {
  std::vector<HullVertex> hull;
  std::vector<HullVertex> waterline;
};

Corners UprightCorners(const Segment& segment, const Isometry3d& T_vessel_lidar) {
  Corners corners{Thinned(segment.hull), ThinnedLine(segment.waterline)};
  // A lidar that hangs upside down sees outline and waterline run the other way.
  if (T_vessel_lidar.linear()(2, 2) < 0.0) {
    std::ranges::reverse(corners.hull);
    std::ranges::reverse(corners.waterline);
  }
  return corners;
}

// Corners of a segment in the vessel frame, as they were seen, at the mean height of its returns.
std::vector<Vector3d> ToVessel(const std::vector<HullVertex>& corners, double height_lidar_m, const Isometry3d& T_vessel_lidar) {
  std::vector<Vector3d> corners_vessel_m;
  corners_vessel_m.reserve(corners.size());
  for (const auto& corner : corners) {
    corners_vessel_m.push_back(T_vessel_lidar * Vector3d(corner.p_lidar_m.x(), corner.p_lidar_m.y(), height_lidar_m));
  }
  return corners_vessel_m;
}

// Corners of a segment in the map frame, each by the pose at its own time; nullopt when a corner has no placed pose.
std::optional<std::vector<Vector3d>> PlaceCorners(const std::vector<HullVertex>& corners, const std::vector<Vector3d>& corners_vessel_m,
                                                  const PoseHistory& poses, const Datum& datum) {
  std::vector<Vector3d> corners_map_m;
  corners_map_m.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto place = poses.PlaceAt(corners[i].time, datum);
    if (!place || !place->is_placed) return std::nullopt;
    corners_map_m.push_back(TransformMapVessel(*place) * corners_vessel_m[i]);
  }
  return corners_map_m;
}

// Latest of the times of the segment and of all corners; `hull` is not empty, `waterline` may be.
Utime LastTime(Utime segment_time, const std::vector<HullVertex>& hull, const std::vector<HullVertex>& waterline) {
  Utime last_time = std::max(segment_time, std::ranges::max(hull, {}, &HullVertex::time).time);
  for (const auto& corner : waterline) last_time = std::max(last_time, corner.time);
  return last_time;
}

std::vector<Vector2d> SeenFromAbove(const std::vector<Vector3d>& points) {
  std::vector<Vector2d> flat;
  flat.reserve(points.size());
  for (const auto& point : points) flat.emplace_back(point.head<2>());
  return flat;
}

// Corners are placed at the mean height of their segment. On a level boat that does not matter; else their own height moves them by the lean of the
// lidar's axis. Heights are taken as evenly spread from the lowest to the highest return.
Matrix2d HeightCovariance(const Segment& segment, const Pose& pose, const PlacementParams& params) {
  Vector3d axis_here = RotationMapVessel(pose.heading_rad, pose.pitch_rad, pose.roll_rad) * params.T_vessel_lidar.linear().col(2);
  axis_here.z() = 0.0;
  const Vector2d lean_m = (segment.max_z_m - segment.min_z_m) / std::sqrt(12.0) * (pose.R_map_here * axis_here).head<2>();
  return lean_m * lean_m.transpose();
}

void PlaceOnEarth(const Segment& segment, const std::vector<Vector3d>& outline_map_m, const Pose& pose, const PlacementParams& params,
                  Obstacle& obstacle) {
  // Seen from above where the boat is, which need not be above the map.
  std::vector<Vector3d> outline_here_m;
  outline_here_m.reserve(outline_map_m.size());
  for (const auto& corner_map_m : outline_map_m) outline_here_m.push_back(pose.R_map_here.transpose() * (corner_map_m - pose.position_map_m));
  const Vector3d center_map_m = pose.position_map_m + pose.R_map_here * FootprintCenter(outline_here_m);
  const Vector3d center_vessel_m = TransformMapVessel(pose).inverse() * center_map_m;
  const Datum& datum = pose.datum;
  if (!datum.IsRelative()) {
    const GeodeticPlace place = datum.Map().Reverse(center_map_m);
    obstacle.latitude_deg = place.latitude_deg;
    obstacle.longitude_deg = place.longitude_deg;
  }
  obstacle.status = ObstacleStatus::kOk;
  obstacle.position_map_m = center_map_m.head<2>();
  obstacle.center_vessel_m = center_vessel_m.head<2>();
  const Matrix2d by_height_m2 = HeightCovariance(segment, pose, params);
  obstacle.covariance_m2 = PositionCovariance(center_vessel_m, pose, params) + by_height_m2;
  obstacle.covariance_relative_m2 = RelativeCovariance(center_vessel_m, pose, params) + by_height_m2;
  obstacle.footprint_map_m = SeenFromAbove(outline_map_m);
}

}  // namespace

std::vector<HullVertex> Thinned(const std::vector<HullVertex>& hull) {
  if (hull.size() <= kMaxFootprintVertices) return hull;
  std::vector<HullVertex> thinned;
  for (std::size_t i = 0; i < kMaxFootprintVertices; ++i) thinned.push_back(hull[i * hull.size() / kMaxFootprintVertices]);
  return thinned;
}

std::vector<HullVertex> ThinnedLine(const std::vector<HullVertex>& line) {
  if (line.size() <= kMaxWaterlineVertices) return line;
  std::vector<HullVertex> thinned;
  for (std::size_t i = 0; i < kMaxWaterlineVertices; ++i) thinned.push_back(line[i * (line.size() - 1) / (kMaxWaterlineVertices - 1)]);
  return thinned;
}

VesselOutline OutlineOf(const Segment& segment, const Isometry3d& T_vessel_lidar) {
  const auto corners = UprightCorners(segment, T_vessel_lidar);
  return {ToVessel(corners.hull, segment.centroid_m.z(), T_vessel_lidar), ToVessel(corners.waterline, segment.centroid_m.z(), T_vessel_lidar),
          T_vessel_lidar * segment.nearest_m};
}

Vector3d FootprintCenter(const std::vector<Vector3d>& vertices) { return AreaCenter(vertices); }

Matrix2d PositionCovariance(const Vector3d& p_vessel_m, const Pose& pose, const PlacementParams& params) {
  const Matrix3d by_heading = pose.R_map_here * RotationAboutZ(kPi / 2.0 - pose.heading_rad);
  const Matrix3d by_pitch = RotationAboutY(-pose.pitch_rad);
  const Matrix3d by_roll = RotationAboutX(pose.roll_rad);
  const Vector3d rolled_m = by_roll * p_vessel_m;
  const Vector3d levelled_m = by_pitch * rolled_m;
  const Vector3d p_m = by_heading * levelled_m;  // map axes, from the vessel's origin

  // A rotation about an axis moves a point by axis x point. Heading and pitch are counted against the right-handed sense.
  Eigen::Matrix<double, 2, 5> jacobian;
  jacobian.leftCols<2>().setIdentity();
  jacobian.col(2) = (by_heading * (by_pitch * Vector3d::UnitX().cross(rolled_m))).head<2>();
  jacobian.col(3) = -(by_heading * Vector3d::UnitY().cross(levelled_m)).head<2>();
  jacobian.col(4) = -pose.R_map_here.col(2).cross(p_m).head<2>();

  const Matrix3d R_map_vessel = by_heading * by_pitch * by_roll;
  const Vector3d beam_m = p_m - R_map_vessel * params.T_vessel_lidar.translation();
  const double beam_m2 = beam_m.squaredNorm();
  const Matrix2d along_m2 = (beam_m * beam_m.transpose()).topLeftCorner<2, 2>();

  Matrix2d covariance_m2 = jacobian * pose.covariance * jacobian.transpose();
  covariance_m2 += params.mounting_sd_rad * params.mounting_sd_rad * (beam_m2 * Matrix2d::Identity() - along_m2);
  // An azimuth rotates the beam about the lidar's axis.
  const Vector3d across_m = (R_map_vessel * params.T_vessel_lidar.linear().col(2)).cross(beam_m);
  covariance_m2 += params.azimuth_sd_rad * params.azimuth_sd_rad * (across_m * across_m.transpose()).topLeftCorner<2, 2>();
  if (beam_m2 > 0.0) covariance_m2 += params.range_sd_m * params.range_sd_m / beam_m2 * along_m2;
  return covariance_m2;
}

Matrix2d RelativeCovariance(const Vector3d& p_vessel_m, const Pose& pose, const PlacementParams& params) {
  Pose known = pose;
  known.covariance.topRows<2>().setZero();
  known.covariance.leftCols<2>().setZero();
  return PositionCovariance(p_vessel_m, known, params);
}

Obstacle PlaceSegment(const Segment& segment, const PoseHistory& poses, const Datum& datum, bool has_timed_out, const PlacementParams& params) {
  const Isometry3d& T_vessel_lidar = params.T_vessel_lidar;
  const auto [hull, waterline] = UprightCorners(segment, T_vessel_lidar);
  const auto outline_vessel_m = ToVessel(hull, segment.centroid_m.z(), T_vessel_lidar);
  const auto waterline_vessel_m = ToVessel(waterline, segment.centroid_m.z(), T_vessel_lidar);
  const auto pose = poses.At(segment.time);

  Obstacle obstacle;
  static_cast<Seen&>(obstacle) = static_cast<const Seen&>(segment);
  obstacle.center_vessel_m = FootprintCenter(outline_vessel_m).head<2>();
  obstacle.nearest_vessel_m = T_vessel_lidar * segment.nearest_m;
  obstacle.range_m = obstacle.nearest_vessel_m.head<2>().norm();
  obstacle.bearing_rad = WrapTo2Pi(Atan2(-obstacle.nearest_vessel_m.y(), obstacle.nearest_vessel_m.x()));
  obstacle.height_m = segment.max_z_m - segment.min_z_m;
  obstacle.footprint_vessel_m = SeenFromAbove(outline_vessel_m);
  obstacle.waterline_vessel_m = SeenFromAbove(waterline_vessel_m);
  obstacle.top_above_water_m = AboveWaterM(T_vessel_lidar * segment.top_m, pose, params.reference_point_above_water_m);

  const bool is_placed = pose && pose->is_placed && pose->datum.IsSameAs(datum);
  const auto outline_map_m = PlaceCorners(hull, outline_vessel_m, poses, datum);
  const auto waterline_map_m = PlaceCorners(waterline, waterline_vessel_m, poses, datum);
  if (is_placed && outline_map_m && waterline_map_m) {
    PlaceOnEarth(segment, *outline_map_m, *pose, params, obstacle);
    obstacle.waterline_map_m = SeenFromAbove(*waterline_map_m);
  } else if (has_timed_out) {
    const Utime last_time = LastTime(segment.time, hull, waterline);
    if (poses.newest() == nullptr || poses.newest()->time < last_time) obstacle.status = ObstacleStatus::kPoseTimeout;
  }
  return obstacle;
}

}  // namespace lookout::georeferencer
