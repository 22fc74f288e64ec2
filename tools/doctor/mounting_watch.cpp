#include "tools/doctor/mounting_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lookout/lidar_scan_t.hpp"
#include "lookout/pose_t.hpp"

namespace lookout::doctor {

namespace {

navigator::Params WithoutLidar(navigator::Params params) {
  params.reads_nav_raw = true;
  params.navigator.use_lidar_odometry = false;
  params.navigator.use_lidar_imu = false;
  return params;
}

// How well roll, pitch and heading are known, by their own stated deviations: root mean square about the axes of the vessel.
std::array<double, 3> ReferenceSds(const calibrate::PoseTrack& track) {
  std::array<double, 3> variances{};
  const auto count = static_cast<double>(std::max<std::size_t>(1, track.poses().size()));
  for (const auto& pose : track.poses()) {
    const Eigen::Matrix3d R_map_vessel = pose.T_map_vessel.linear();
    const Eigen::Matrix3d of_vessel = R_map_vessel.transpose() * pose.covariance.bottomRightCorner<3, 3>() * R_map_vessel;
    for (int i = 0; i < 3; ++i) variances.at(static_cast<std::size_t>(i)) += of_vessel(i, i) / count;
  }
  return {std::sqrt(variances[0]), std::sqrt(variances[1]), std::sqrt(variances[2])};
}

}  // namespace

MountingWatch::MountingWatch(const navigator::Params& params) : collector_(recording_, {}), navigator_(own_bus_, WithoutLidar(params)) {
  bus::Subscribe<pose_t>(own_bus_, bus::kPose, [this](const pose_t& message) { collector_.OnPose(message); });
}

void MountingWatch::ListenTo(bus::Bus& bus) {
  bus::Subscribe<lidar_scan_t>(bus, bus::kLidarScan, [this](const lidar_scan_t& message) { collector_.OnScan(message); });
  bus.SubscribeRaw(bus::kNavRaw, [this](std::string_view, Bytes bytes) {
    own_bus_.Publish(bus::kNavRaw, {bytes.begin(), bytes.end()});
    while (own_bus_.HandleOnce()) {
    }
  });
}

MountingSeen MountingOf(const calibrate::Calibration& calibration, const calibrate::PoseTrack& track) {
  MountingSeen seen;
  seen.watched_s = calibration.manoeuvres.seconds;
  seen.turned_in_words = calibration.turned_in_words;
  seen.missing = calibration.missing;
  if (calibration.IsRefused() && !calibration.is_only_weak) {
    seen.not_known = calibration.refusal;
    return seen;
  }
  const auto reference_sds_rad = ReferenceSds(track);
  for (std::size_t i = 0; i < seen.axes.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    seen.axes.at(i) = {calibration.turned_rad[axis], calibration.turned_sd_rad[axis], reference_sds_rad.at(i)};
  }
  return seen;
}

MountingSeen CompareMounting(const calibrate::Recording& recording, const calibrate::CalibrationParams& params) {
  return MountingOf(calibrate::Calibrate(recording, params), recording.track);
}

}  // namespace lookout::doctor
