// KISS-ICP: odometry of a lidar by points alone, after its publication.
//
// Source: I. Vizzo, T. Guadagnino, B. Mersch, L. Wiesmann, J. Behley, C. Stachniss: "KISS-ICP: In Defense of Point-to-Point ICP - Simple, Accurate,
// and Robust Registration If Done the Right Way", IEEE Robotics and Automation Letters 8 (2), 2023.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "services/odometer/core/local_map.hpp"

namespace lookout::eval {

/// The published defaults, as the authors' program has them.
struct KissIcpParams {
  double min_range_m = 0.0;
  double max_range_m = 100.0;
  double voxel_m = 1.0;               // of the map: a hundredth of the greatest range
  double map_sample_per_voxel = 0.5;  // voxels in which one return is kept for the map
  double sample_per_voxel = 1.5;      // and of these one to be registered
  std::size_t max_points_per_voxel = 20;
  double initial_threshold_m = 2.0;
  double min_deviation_m = 0.1;  // from the expected motion: a smaller deviation does not count
  double convergence = 1e-4;     // length of a step of m and rad
  int max_iterations = 500;
};

/// A return at the time of its shot.
struct LidarPoint {
  Eigen::Vector3d p_lidar_m;
  double before_end_s = 0.0;  // time from its shot to the last shot of the scan
};

/// A constant velocity of the lidar.
struct LidarVelocity {
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_radps = Eigen::Vector3d::Zero();  // right-handed, about the lidar's axes

  /// Precondition: for_s is above 0, and the rotation is below pi.
  static LidarVelocity Of(const Eigen::Isometry3d& motion, double for_s);
  /// @return T_begin_end
  Eigen::Isometry3d MotionOver(double for_s) const;
};

/// All returns in the lidar's frame at the last shot of the scan.
std::vector<Eigen::Vector3d> Deskewed(std::span<const LidarPoint> points, const LidarVelocity& velocity);

/// How far the boat departs from a constant velocity.
class AdaptiveThreshold {
 public:
  explicit AdaptiveThreshold(const KissIcpParams& params) : params_(params) {}

  /// @param deviation  of the motion that was found from the expected one
  void Add(const Eigen::Isometry3d& deviation);
  /// Root mean square of the deviations that count, each the greatest displacement of a return; the initial one before there is any.
  double SigmaM() const;

 private:
  KissIcpParams params_;
  double sum_m2_ = 0.0;
  std::int64_t num_deviations_ = 0;
};

/// Points on a grid of voxels, at most so many in each, the first that came.
class VoxelMap {
 public:
  VoxelMap(double voxel_m, std::size_t max_points_per_voxel) : voxel_m_(voxel_m), max_points_per_voxel_(max_points_per_voxel) {}

  void Add(const Eigen::Vector3d& p_map_m);
  /// Voxels whose first point lies farther than this from `center_m` are forgotten.
  void Forget(const Eigen::Vector3d& center_m, double radius_m);
  /// The nearest point of the voxel and of the 26 around it; at equal distance the point of the lower voxel by x, y, z, then the point that came
  /// first.
  std::optional<Eigen::Vector3d> Nearest(const Eigen::Vector3d& p_map_m) const;
  bool empty() const { return voxels_.empty(); }

 private:
  struct Voxel {
    Eigen::Vector3i place;
    std::vector<Eigen::Vector3d> points_m;
  };

  double voxel_m_;
  std::size_t max_points_per_voxel_;
  odometer::CubeIndex index_;
  std::vector<Voxel> voxels_;  // by the index
};

/// Moves points onto the map, point to point. Without a nearest point it is the place where it begins.
///
/// @param points_m        lidar frame
/// @param begin           T_map_lidar where the search begins
/// @param max_distance_m  of a point from its nearest
/// @param kernel          of Geman-McClure's function; it is added to the squared distance
/// @return T_map_lidar
Eigen::Isometry3d AlignPoints(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Isometry3d& begin, double max_distance_m, double kernel,
                              const VoxelMap& map, const KissIcpParams& params);

/// Place and attitude of a lidar from scan to scan. The map is its frame at the end of the first scan. A motion is always given: where nothing is in
/// sight the motion before.
class KissIcp {
 public:
  explicit KissIcp(const KissIcpParams& params = {}) : params_(params), threshold_(params), map_(params.voxel_m, params.max_points_per_voxel) {}

  /// @param since_s  from the end of the scan before to the end of this one; of the first scan any
  /// @return T_map_lidar at the end of the scan
  Eigen::Isometry3d Register(std::span<const LidarPoint> points, double since_s);

 private:
  KissIcpParams params_;
  AdaptiveThreshold threshold_;
  VoxelMap map_;
  bool is_first_ = true;
  LidarVelocity velocity_;
  Eigen::Isometry3d T_map_lidar_ = Eigen::Isometry3d::Identity();
};

}  // namespace lookout::eval
