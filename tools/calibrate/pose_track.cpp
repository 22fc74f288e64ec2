#include "tools/calibrate/pose_track.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"

namespace lookout::calibrate {

bool PoseTrack::Add(const TrackPose& pose) {
  if (!poses_.empty() && pose.time <= poses_.back().time) return false;
  poses_.push_back(pose);
  return true;
}

std::optional<TrackPose> PoseTrack::At(Utime time, double later_s) const {
  // Poses are 20 ms apart: a whole microsecond is fine enough for the search, not for the share between them.
  const auto whole = std::chrono::microseconds(static_cast<std::int64_t>(std::floor(later_s * 1e6)));
  const Utime wanted = time + whole;
  const double rest_s = later_s - static_cast<double>(whole.count()) * 1e-6;
  const auto after = std::ranges::upper_bound(poses_, wanted, {}, &TrackPose::time);
  if (after == poses_.begin() || after == poses_.end()) return std::nullopt;
  const auto before = std::prev(after);
  const double span_s = ToSeconds(after->time - before->time);
  if (span_s > kMaxBracketS) return std::nullopt;
  const double share = (ToSeconds(wanted - before->time) + rest_s) / span_s;
  TrackPose pose = share < 0.5 ? *before : *after;
  pose.time = wanted;
  pose.T_map_vessel.translation() = (1.0 - share) * before->T_map_vessel.translation() + share * after->T_map_vessel.translation();
  const Eigen::Quaterniond from(before->T_map_vessel.linear());
  const Eigen::Quaterniond to(after->T_map_vessel.linear());
  pose.T_map_vessel.linear() = from.slerp(share, to).toRotationMatrix();
  pose.heave_m = (1.0 - share) * before->heave_m + share * after->heave_m;
  return pose;
}

std::optional<TrackPose> PoseTrack::At(Utime time, const Latency& latency) const {
  auto pose = At(time, latency.heading_s);
  if (!pose || latency.heading_s == latency.tilt_s) return pose;
  const auto tilted = At(time, latency.tilt_s);
  if (!tilted) return std::nullopt;
  const double turn_rad = HeadingOf(tilted->T_map_vessel) - HeadingOf(pose->T_map_vessel);
  pose->T_map_vessel.linear() = RotationAboutZ(turn_rad) * tilted->T_map_vessel.linear();
  pose->heave_m = tilted->heave_m;
  return pose;
}

double HeadingOf(const Eigen::Isometry3d& T_map_vessel) {
  const Eigen::Vector3d bow = T_map_vessel.linear().col(0);
  return WrapTo2Pi(std::atan2(bow.x(), bow.y()));
}

}  // namespace lookout::calibrate
