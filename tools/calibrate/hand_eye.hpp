// Mounting and latency out of relative motions: A X = X B. Pure.
//
// Between two moments i and j the lidar saw that it moved by A (vessel frame as it is assumed to be), and POSE says that the vessel moved by B. With
// the right mounting both are one. The correction D of the mounting (p_vessel = D p_assumed) and the latency are those with which A = D^-1 B D, for
// all pairs at once, by weighted least squares with Cauchy's function. Rotations show how the axes lie against each other: about the axis of a turn
// nothing, so a turn shows roll and pitch, rolling and pitching in waves show yaw. Displacements show yaw by the direction of the way.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "common/core/utime.hpp"
#include "services/odometer/core/registration.hpp"
#include "tools/calibrate/pose_track.hpp"

namespace lookout::calibrate {

using odometer::Matrix6;
using odometer::RotationBy;
using odometer::Vector6;

/// A motion that the lidar saw, between the ends of two scans.
struct RelativeMotion {
  Utime begin;
  Utime end;
  Eigen::Isometry3d T_begin_end = Eigen::Isometry3d::Identity();  // assumed vessel frame
  /// Inverse of the covariance of displacement (m) and rotation (rad), both along the axes of the vessel at the begin.
  Matrix6 information = Matrix6::Zero();
};

/// The unknowns: a small rotation of the assumed mounting (about the axes of the vessel), the place of the lidar relative to that in boat.txtpb
/// (vessel frame), and the latency.
struct Correction {
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
  Latency latency;
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();

  static constexpr int kNumNumbers = 8;
  using Numbers = Eigen::Matrix<double, kNumNumbers, 1>;  // in this order
  Numbers ToNumbers() const;
  static Correction FromNumbers(const Numbers& numbers);
};

struct HandEyeParams {
  /// Deviation of the place in boat.txtpb, as measured with a ruler.
  double place_sd_m = 0.05;
  /// Blocks of time of the jackknife that estimates the deviations.
  int num_blocks = 12;
  /// Whether deviations are estimated: this takes as many fits as blocks.
  bool wants_deviations = true;
};

struct HandEyeResult {
  Correction correction;
  /// The larger of the formal deviation (scaled by the residuals) and the deviation by the jackknife.
  Correction::Numbers sd = Correction::Numbers::Zero();
  Correction::Numbers formal_sd = Correction::Numbers::Zero();
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();  // of correction.rotation_rad, with these deviations
  std::vector<Matrix6> weights;                                   // [motions] of the residuals: inverse of the covariance of registration and POSE
  std::size_t num_pairs = 0;                                      // pairs that were used: POSE is known at both ends
  double displacement_rms_m = 0;                                  // of the residuals, each pair weighted as in the fit
  double rotation_rms_rad = 0;
};

/// The difference between a motion by the lidar and the motion by POSE with this correction: displacement (m), rotation (rad), along the axes of
/// the vessel at the begin. nullopt where POSE is not known at both ends.
std::optional<Vector6> Residual(const RelativeMotion& motion, const PoseTrack& track, const Eigen::Vector3d& p_vessel_lidar_m,
                                const Correction& correction);

/// @param p_vessel_lidar_m  of boat.txtpb: the mounting turns about it
/// @return nullopt where fewer than 10 motions can be used
std::optional<HandEyeResult> SolveHandEye(const std::vector<RelativeMotion>& motions, const PoseTrack& track, const Eigen::Vector3d& p_vessel_lidar_m,
                                          const Correction& start, const HandEyeParams& params);

/// The vector of any rotation: axis times angle.
Eigen::Vector3d RotationVectorOf(const Eigen::Matrix3d& R);

}  // namespace lookout::calibrate
