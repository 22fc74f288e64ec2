#include "lab/eval/baselines/kiss_icp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/elementary.hpp"
#include "services/odometer/core/registration.hpp"

namespace lookout::eval {

namespace {

using odometer::Matrix6;
using odometer::Vector6;

// Angle of a rotation by less than pi.
double AngleOf(const Eigen::Matrix3d& R) { return Atan2(odometer::RotationVector(R).norm(), 0.5 * (R.trace() - 1.0)); }

std::vector<Eigen::Vector3d> FirstOfEachVoxel(const std::vector<Eigen::Vector3d>& points_m, double voxel_m) {
  std::vector<Eigen::Vector3d> first_m;
  for (const auto i : odometer::FirstOfEachCube(points_m, voxel_m)) first_m.push_back(points_m[i]);
  return first_m;
}

}  // namespace

LidarVelocity LidarVelocity::Of(const Eigen::Isometry3d& motion, double for_s) {
  // Along the axis, as long as the sine of the angle.
  const Eigen::Vector3d axis = odometer::RotationVector(motion.linear());
  const double sine = axis.norm();
  const double factor = sine > 1e-12 ? AngleOf(motion.linear()) / sine : 1.0;
  return {motion.translation() / for_s, factor * axis / for_s};
}

Eigen::Isometry3d LidarVelocity::MotionOver(double for_s) const {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = odometer::RotationBy(rotation_radps * for_s);
  motion.translation() = velocity_mps * for_s;
  return motion;
}

std::vector<Eigen::Vector3d> Deskewed(std::span<const LidarPoint> points, const LidarVelocity& velocity) {
  std::vector<Eigen::Vector3d> deskewed_m;
  deskewed_m.reserve(points.size());
  for (const auto& point : points) deskewed_m.emplace_back(velocity.MotionOver(point.before_end_s).inverse() * point.p_lidar_m);
  return deskewed_m;
}

void AdaptiveThreshold::Add(const Eigen::Isometry3d& deviation) {
  // Displacement of a return at the greatest range.
  const double by_rotation_m = 2.0 * params_.max_range_m * Sin(0.5 * AngleOf(deviation.linear()));
  const double deviation_m = by_rotation_m + deviation.translation().norm();
  if (deviation_m <= params_.min_deviation_m) return;
  sum_m2_ += deviation_m * deviation_m;
  ++num_deviations_;
}

double AdaptiveThreshold::SigmaM() const {
  return num_deviations_ > 0 ? std::sqrt(sum_m2_ / static_cast<double>(num_deviations_)) : params_.initial_threshold_m;
}

void VoxelMap::Add(const Eigen::Vector3d& p_map_m) {
  const auto place = odometer::CubeOf(p_map_m, voxel_m_);
  const auto [number, is_new] = index_.Insert(place);
  if (is_new) voxels_.push_back({place, {}});
  auto& points_m = voxels_[static_cast<std::size_t>(number)].points_m;
  if (points_m.size() < max_points_per_voxel_) points_m.push_back(p_map_m);
}

void VoxelMap::Forget(const Eigen::Vector3d& center_m, double radius_m) {
  const auto is_far = [&](const Voxel& voxel) { return (voxel.points_m.front() - center_m).norm() > radius_m; };
  if (std::erase_if(voxels_, is_far) == 0) return;
  index_.Clear();
  for (const auto& voxel : voxels_) index_.Insert(voxel.place);
}

std::optional<Eigen::Vector3d> VoxelMap::Nearest(const Eigen::Vector3d& p_map_m) const {
  const auto middle = odometer::CubeOf(p_map_m, voxel_m_);
  const Eigen::Vector3d* nearest = nullptr;
  double nearest_m2 = 0.0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const auto number = index_.Find(middle + Eigen::Vector3i(x, y, z));
        if (number == odometer::CubeIndex::kNone) continue;
        for (const auto& other_m : voxels_[static_cast<std::size_t>(number)].points_m) {
          const double distance_m2 = (other_m - p_map_m).squaredNorm();
          if (nearest != nullptr && distance_m2 >= nearest_m2) continue;
          nearest = &other_m;
          nearest_m2 = distance_m2;
        }
      }
    }
  }
  if (nearest == nullptr) return std::nullopt;
  return *nearest;
}

Eigen::Isometry3d AlignPoints(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Isometry3d& begin, double max_distance_m, double kernel,
                              const VoxelMap& map, const KissIcpParams& params) {
  Eigen::Isometry3d T_map_lidar = begin;
  if (map.empty()) return T_map_lidar;
  for (int i = 0; i < params.max_iterations; ++i) {
    Matrix6 information = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero();
    for (const auto& p_lidar_m : points_m) {
      const Eigen::Vector3d arm_m = T_map_lidar.linear() * p_lidar_m;
      const Eigen::Vector3d p_map_m = T_map_lidar.translation() + arm_m;
      const auto nearest_m = map.Nearest(p_map_m);
      if (!nearest_m) continue;
      const Eigen::Vector3d difference_m = p_map_m - *nearest_m;
      const double distance_m2 = difference_m.squaredNorm();
      if (distance_m2 >= max_distance_m * max_distance_m) continue;
      const double ratio = kernel / (kernel + distance_m2);
      Eigen::Matrix<double, 3, 6> jacobian;
      jacobian.leftCols<3>().setIdentity();
      // Of a small rotation about the lidar, along the map's axes.
      jacobian.rightCols<3>() << 0.0, arm_m.z(), -arm_m.y(), -arm_m.z(), 0.0, arm_m.x(), arm_m.y(), -arm_m.x(), 0.0;
      const double weight = ratio * ratio;
      information += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * difference_m;
    }
    const Vector6 step = -information.ldlt().solve(gradient);
    // Fewer than three points leave directions open, in which a step may have any length.
    if (!step.allFinite() || step.head<3>().norm() > params.max_range_m) break;
    T_map_lidar.translation() += step.head<3>();
    T_map_lidar.linear() = odometer::RotationBy(step.tail<3>()) * T_map_lidar.linear();
    if (step.norm() < params.convergence) break;
  }
  return T_map_lidar;
}

Eigen::Isometry3d KissIcp::Register(std::span<const LidarPoint> points, double since_s) {
  std::vector<LidarPoint> in_range;
  in_range.reserve(points.size());
  for (const auto& point : points) {
    const double range_m = point.p_lidar_m.norm();
    if (range_m > params_.min_range_m && range_m < params_.max_range_m) in_range.push_back(point);
  }
  const auto for_map_m = FirstOfEachVoxel(Deskewed(in_range, velocity_), params_.map_sample_per_voxel * params_.voxel_m);
  const auto source_m = FirstOfEachVoxel(for_map_m, params_.sample_per_voxel * params_.voxel_m);
  const Eigen::Isometry3d T_map_expected = T_map_lidar_ * velocity_.MotionOver(since_s);
  const double sigma_m = threshold_.SigmaM();
  const Eigen::Isometry3d T_map_found = AlignPoints(source_m, T_map_expected, 3.0 * sigma_m, sigma_m / 3.0, map_, params_);
  threshold_.Add(T_map_expected.inverse() * T_map_found);
  for (const auto& p_lidar_m : for_map_m) map_.Add(T_map_found * p_lidar_m);
  map_.Forget(T_map_found.translation(), params_.max_range_m);
  if (!std::exchange(is_first_, false)) velocity_ = LidarVelocity::Of(T_map_lidar_.inverse() * T_map_found, since_s);
  T_map_lidar_ = T_map_found;
  return T_map_lidar_;
}

}  // namespace lookout::eval
