// The poses of a recording, and the vessel at any time between them.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::calibrate {

/// A pose on the earth: position, heading, roll and pitch are measured.
struct TrackPose {
  Utime time;
  Eigen::Isometry3d T_map_vessel = Eigen::Isometry3d::Identity();
  double heave_m = 0.0;  // 0 where not known
  /// Covariance of position (east, north, up; m) and rotation about the axes of the map (rad).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// How late POSE is: the state of a time stands in POSE this much later. Heading and position have one latency, roll and pitch another, as they may
/// come from different sensors.
struct Latency {
  double heading_s = 0.0;
  double tilt_s = 0.0;
};

class PoseTrack {
 public:
  /// Between poses farther apart than this nothing is known.
  static constexpr double kMaxBracketS = 0.1;

  /// @return false, and adds nothing, where the pose is not later than the last
  bool Add(const TrackPose& pose);

  /// Linear between the neighbours; nullopt outside and in gaps.
  /// @param later_s  is added to `time`
  std::optional<TrackPose> At(Utime time, double later_s) const;

  /// The vessel as it was at `time`.
  std::optional<TrackPose> At(Utime time, const Latency& latency) const;

  bool empty() const { return poses_.empty(); }
  const std::vector<TrackPose>& poses() const { return poses_; }

 private:
  std::vector<TrackPose> poses_;  // increasing in time
};

/// Heading of the bow from north, clockwise; roll positive starboard down; pitch positive bow up; rad.
double HeadingOf(const Eigen::Isometry3d& T_map_vessel);

}  // namespace lookout::calibrate
