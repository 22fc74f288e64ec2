// The box of the own vessel, whose returns are no obstacle.
#pragma once

#include <Eigen/Geometry>

namespace lookout {

/// Most points are too far away and take one comparison.
class OwnVessel {
 public:
  /// @param box_m  vessel frame; empty = none
  OwnVessel(const Eigen::AlignedBox3d& box_m, const Eigen::Isometry3d& T_vessel_lidar) : box_m_(box_m), T_vessel_lidar_(T_vessel_lidar) {
    if (box_m_.isEmpty()) return;
    const Eigen::Vector3d p_lidar_m = T_vessel_lidar_.translation();
    const Eigen::Vector3d reach_m = (box_m_.min() - p_lidar_m).cwiseAbs().cwiseMax((box_m_.max() - p_lidar_m).cwiseAbs());
    squared_reach_m2_ = reach_m.squaredNorm() * kMargin;
  }

  /// Whether the box reaches so far from the lidar.
  bool ReachesTo(double range_m) const { return range_m * range_m <= squared_reach_m2_; }
  bool Contains(const Eigen::Vector3d& p_lidar_m) const {
    return p_lidar_m.squaredNorm() <= squared_reach_m2_ && box_m_.contains(T_vessel_lidar_ * p_lidar_m);
  }

 private:
  static constexpr double kMargin = 1.0 + 1e-9;  // for rounding

  Eigen::AlignedBox3d box_m_;
  Eigen::Isometry3d T_vessel_lidar_;
  double squared_reach_m2_ = -1.0;  // no box
};

}  // namespace lookout
