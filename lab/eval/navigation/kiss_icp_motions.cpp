#include "lab/eval/navigation/kiss_icp_motions.hpp"

#include <cmath>
#include <cstddef>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/frames.hpp"

namespace lookout::eval {

namespace {

// Bearing of the bow, counter-clockwise seen from above.
double BearingOf(const Eigen::Isometry3d& T_level_vessel) { return Atan2(T_level_vessel.linear()(1, 0), T_level_vessel.linear()(0, 0)); }

}  // namespace

std::vector<LidarPoint> LidarPoints(const odometer::Scan& scan, const config::BoatFacts& boat) {
  std::vector<LidarPoint> points;
  const std::int64_t end_ns = (scan.end_time - scan.time).count() * 1000;
  const std::size_t num_rings = scan.rings.size();
  for (std::size_t column = 0; column < scan.azimuth_rad.size(); ++column) {
    for (std::size_t i = 0; i < num_rings; ++i) {
      const auto range = scan.range[column * num_rings + i];
      if (range == 0) continue;
      const auto& ring = scan.rings[i];
      Eigen::Vector3d p_lidar_m = range * scan.range_unit_m * BeamDirection(scan.azimuth_rad[column] + ring.azimuth_offset_rad, ring.elevation_rad);
      p_lidar_m.z() += ring.origin_height_m;
      if (!boat.own_vessel_box_m.isEmpty() && boat.own_vessel_box_m.contains(boat.T_vessel_lidar * p_lidar_m)) continue;
      points.push_back({p_lidar_m, static_cast<double>(end_ns - scan.time_ns[column] - ring.time_offset_ns) * 1e-9});
    }
  }
  return points;
}

KissIcpMotions::KissIcpMotions(const config::BoatFacts& boat, const Eigen::Matrix3d& R_level_vessel, const KissIcpParams& params)
    : boat_(boat), T_level_map_(Eigen::Isometry3d(R_level_vessel) * boat.T_vessel_lidar), method_(params) {}

lidar_odometry_t KissIcpMotions::Consume(const odometer::Scan& scan) {
  const bool is_first = !time_;
  const Utime begin = time_.value_or(scan.end_time);
  const auto T_map_lidar = method_.Register(LidarPoints(scan, boat_), ToSeconds(scan.end_time - begin));
  const Eigen::Isometry3d T_level_vessel = T_level_map_ * T_map_lidar * boat_.T_vessel_lidar.inverse();
  const double begin_rad = BearingOf(T_level_vessel_);
  const Eigen::Vector3d way_m = RotationAboutZ(-begin_rad) * (T_level_vessel.translation() - T_level_vessel_.translation());
  const auto known = [is_first](double value) { return is_first ? kNan : Canonical(value); };
  lidar_odometry_t message{};
  message.utime_us = ToUtimeUs(scan.end_time);
  message.begin_utime_us = ToUtimeUs(begin);
  message.seq = scan.seq;
  message.raw_seq = scan.raw_seq;
  message.status = static_cast<std::int32_t>(is_first ? +lidar_odometry_t::STATUS_UNKNOWN : +lidar_odometry_t::STATUS_OK);
  message.reason = static_cast<std::int32_t>(is_first ? +lidar_odometry_t::REASON_FIRST_SCAN : +lidar_odometry_t::REASON_NONE);
  message.displacement_m[0] = known(way_m.x());
  message.displacement_m[1] = known(way_m.y());
  message.turn_rad = known(-WrapToPi(BearingOf(T_level_vessel) - begin_rad));
  for (auto& line : message.covariance) {
    for (double& value : line) value = kNan;
  }
  time_ = scan.end_time;
  T_level_vessel_ = T_level_vessel;
  return message;
}

}  // namespace lookout::eval
