#include "tools/calibrate/collector.hpp"

#include <cmath>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/core/frames.hpp"
#include "common/messages/checks.hpp"
#include "common/messages/pose_message.hpp"
#include "services/odometer/wire.hpp"

namespace lookout::calibrate {

namespace {

// Roll turns about the bow, pitch about the beam, heading about up.
Eigen::Matrix<double, 6, 6> CovarianceOf(const pose_t& message, const Eigen::Matrix3d& R_map_vessel) {
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) covariance(i, k) = message.covariance[i][k];
  }
  // A height that nobody measures says nothing.
  constexpr double kUnknownHeightM2 = 100.0;
  if (!std::isfinite(covariance(2, 2))) {
    covariance.row(2).setZero();
    covariance.col(2).setZero();
    covariance(2, 2) = kUnknownHeightM2;
  }
  const Eigen::Vector3d variances(message.covariance[6][6], message.covariance[7][7], message.covariance[8][8]);
  Eigen::Matrix3d axes;
  axes << R_map_vessel.col(0), R_map_vessel.col(1), Eigen::Vector3d::UnitZ();
  covariance.bottomRightCorner<3, 3>() = axes * variances.asDiagonal() * axes.transpose();
  return covariance;
}

}  // namespace

void Collector::OnScan(const lidar_scan_t& message) {
  if (messages::FaultOf(message, bus::kMaxMessageBytes)) return;
  const auto parts = assembler_.Add(message).whole;
  if (parts.empty()) return;
  auto scan = odometer::ToScan(parts);
  if (!scan) return;
  if (!first_) first_ = scan->time;
  const double since_s = ToSeconds(scan->time - *first_);
  if (since_s < stretch_.begin_s || since_s > stretch_.begin_s + stretch_.seconds) return;
  if (!recording_.scans.empty() && scan->end_time <= recording_.scans.back().end_time) return;
  recording_.scans.push_back(std::move(*scan));
}

void Collector::OnPose(const pose_t& message) {
  const auto checked = messages::ToPose(message);
  const auto* pose = std::get_if<Pose>(&checked);
  if (pose == nullptr) return;
  ++recording_.num_poses;
  const bool is_whole = message.status == pose_t::STATUS_OK;
  if (!is_whole || !pose->is_placed || pose->datum.IsRelative()) {
    ++recording_.num_no_place;
    return;
  }
  if (message.heading_source == pose_t::HEADING_COURSE) {
    ++recording_.num_course_alone;
    return;
  }
  if (!message.has_attitude) {
    ++recording_.num_no_attitude;
    return;
  }
  if (!datum_) datum_ = pose->datum;
  if (!datum_->IsSameAs(pose->datum)) {
    ++recording_.num_no_place;
    return;
  }
  TrackPose kept;
  kept.time = pose->time;
  kept.T_map_vessel.linear() = pose->R_map_here * RotationMapVessel(pose->heading_rad, pose->pitch_rad, pose->roll_rad);
  kept.T_map_vessel.translation() = pose->position_map_m;
  kept.heave_m = std::isfinite(message.heave_m) ? message.heave_m : 0.0;
  kept.covariance = CovarianceOf(message, kept.T_map_vessel.linear());
  if (!kept.covariance.allFinite()) return;
  recording_.track.Add(kept);
}

}  // namespace lookout::calibrate
