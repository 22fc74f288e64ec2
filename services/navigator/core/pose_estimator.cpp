#include "services/navigator/core/pose_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"

namespace lookout::navigator {

namespace {

// Order of the covariance.
enum State { kEast, kNorth, kUp, kVelocityEast, kVelocityNorth, kVelocityUp, kRoll, kPitch, kHeading, kNumStates };

using StandardDeviations = Eigen::Matrix<double, kNumStates, 1>;  // NaN = not known

// First form: diagonal. What is not known has a row and a column of NaN.
PoseCovariance Covariance(const StandardDeviations& sd) {
  PoseCovariance covariance = PoseCovariance::Zero();
  for (int state = 0; state < kNumStates; ++state) {
    if (std::isnan(sd[state])) {
      covariance.row(state).setConstant(kNan);
      covariance.col(state).setConstant(kNan);
    } else if (!std::isnan(covariance(state, state))) {
      covariance(state, state) = sd[state] * sd[state];
    }
  }
  return covariance;
}

}  // namespace

PoseEstimator::PoseEstimator(const PoseParams& params) : params_(params), antenna_(params.antenna), attitude_(params.attitude) {}

std::optional<HeadingEstimate> PoseEstimator::HeadingAt(Utime time) const {
  if (const auto heading = attitude_.HeadingAt(time)) return heading;
  if (!params_.use_course_as_heading) return std::nullopt;
  const auto course = antenna_.CourseAt(time);
  if (!course || course->speed_mps < params_.min_course_speed_mps) return std::nullopt;
  return HeadingEstimate{HeadingSource::kCourse, course->course_rad, params_.course_heading_sd_rad, 0.0};
}

Pose PoseEstimator::At(Utime time) const {
  Pose pose;
  pose.time = time;
  StandardDeviations sd = StandardDeviations::Constant(kNan);

  const auto tilt = attitude_.TiltAt(time);
  pose.has_attitude = tilt.has_value();
  pose.roll_rad = tilt ? tilt->roll_rad : 0.0;
  pose.pitch_rad = tilt ? tilt->pitch_rad : 0.0;
  sd[kRoll] = tilt ? tilt->roll_sd_rad : params_.unmeasured_tilt_sd_rad;
  sd[kPitch] = tilt ? tilt->pitch_sd_rad : params_.unmeasured_tilt_sd_rad;
  pose.heave_m = attitude_.HeaveAt(time).value_or(kNan);

  const auto heading = HeadingAt(time);
  if (heading) {
    pose.heading_rad = heading->heading_rad;
    pose.heading_source = heading->source;
    sd[kHeading] = heading->sd_rad;
  }
  // From the reference point to the antenna. Without heading only its height is known.
  const Eigen::Vector3d& lever_vessel_m = params_.p_vessel_antenna_m;
  Eigen::Vector3d lever_map_m = RotationMapVessel(heading ? heading->heading_rad : 0.0, pose.pitch_rad, pose.roll_rad) * lever_vessel_m;
  if (!heading) lever_map_m.head<2>().setZero();

  if (const auto velocity = antenna_.VelocityAt(time)) {
    pose.velocity_map_mps = velocity->map_mps;
    // The antenna is swung around the reference point; heading goes clockwise, against the up axis.
    if (heading) pose.velocity_map_mps -= Eigen::Vector3d(0.0, 0.0, -heading->rate_radps).cross(lever_map_m);
    sd[kVelocityEast] = sd[kVelocityNorth] = velocity->horizontal_sd_mps;
    sd[kVelocityUp] = velocity->vertical_sd_mps;
  }

  if (antenna_.datum()) pose.datum = *antenna_.datum();
  const auto antenna = antenna_.PositionAt(time);
  if (antenna) {
    pose.p_map_m = antenna->p_map_m - lever_map_m;
    antenna_.map()->Reverse(pose.p_map_m.x(), pose.p_map_m.y(), pose.p_map_m.z(), pose.latitude_deg, pose.longitude_deg, pose.ellipsoid_height_m);
    const double lever_m = lever_vessel_m.head<2>().norm();
    sd[kEast] = sd[kNorth] =
        heading ? std::hypot(antenna->horizontal_sd_m, lever_m * std::min(heading->sd_rad, 1.0)) : antenna->horizontal_sd_m + lever_m;
    if (antenna->has_height) {
      sd[kUp] = antenna->vertical_sd_m;
    } else {
      pose.ellipsoid_height_m = kNan;
      pose.p_map_m.z() = 0.0;
    }
  }

  if (antenna && heading) {
    pose.status = PoseStatus::kOk;
  } else if (antenna) {
    pose.status = PoseStatus::kNoHeading;
  } else if (heading) {
    pose.status = PoseStatus::kNoPosition;
  }
  pose.covariance = Covariance(sd);
  return pose;
}

}  // namespace lookout::navigator
