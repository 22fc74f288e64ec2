// Motions of KISS-ICP as LIDAR_ODOMETRY tells them, on the scans of the odometer.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/utime.hpp"
#include "lab/eval/baselines/kiss_icp.hpp"
#include "lookout/lidar_odometry_t.hpp"
#include "services/odometer/core/standing.hpp"

namespace lookout::eval {

/// All returns of a scan with their times, by column, then ring, without returns of the own vessel.
std::vector<LidarPoint> LidarPoints(const odometer::Scan& scan, const config::BoatFacts& boat);

/// KISS-ICP on a boat. It follows the lidar in six degrees of freedom and knows no vertical. It is told the roll and pitch of the boat at the first
/// scan, and from there on its own attitude says what is level. A motion is that of the reference point and of the bow, seen from above.
class KissIcpMotions {
 public:
  /// @param R_level_vessel  of the boat at the end of the first scan
  KissIcpMotions(const config::BoatFacts& boat, const Eigen::Matrix3d& R_level_vessel, const KissIcpParams& params = {});

  /// @return of the first scan unknown, of all others known; without a covariance (NaN)
  lidar_odometry_t Consume(const odometer::Scan& scan);

 private:
  config::BoatFacts boat_;
  Eigen::Isometry3d T_level_map_;  // of the method's map
  KissIcp method_;
  std::optional<Utime> time_;  // end of the last scan
  Eigen::Isometry3d T_level_vessel_ = Eigen::Isometry3d::Identity();
};

}  // namespace lookout::eval
