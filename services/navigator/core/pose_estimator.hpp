// POSE: where the vessel's reference point is, at any time near the last measurements. First form: measurements are carried on, not filtered.
#pragma once

#include <Eigen/Core>

#include "services/navigator/core/antenna_tracker.hpp"
#include "services/navigator/core/attitude_tracker.hpp"
#include "services/navigator/core/pose.hpp"

namespace lookout::navigator {

struct PoseParams {
  AntennaParams antenna;
  AttitudeParams attitude;
  Eigen::Vector3d p_vessel_antenna_m = Eigen::Vector3d::Zero();
  // Course over ground stands in for heading above min_course_speed_mps, where allowed.
  bool use_course_as_heading = false;
  double min_course_speed_mps = 0.0;
  double course_heading_sd_rad = 0.0;
  double unmeasured_tilt_sd_rad = 0.0;
};

class PoseEstimator {
 public:
  explicit PoseEstimator(const PoseParams& params);

  AntennaTracker& antenna() { return antenna_; }
  const AntennaTracker& antenna() const { return antenna_; }
  AttitudeTracker& attitude() { return attitude_; }

  /// @param time  near the last measurements: before the older of them, values are held
  Pose At(Utime time) const;

 private:
  std::optional<HeadingEstimate> HeadingAt(Utime time) const;

  PoseParams params_;
  AntennaTracker antenna_;
  AttitudeTracker attitude_;
};

}  // namespace lookout::navigator
