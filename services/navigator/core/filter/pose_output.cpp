#include "services/navigator/core/filter/pose_output.hpp"

#include <chrono>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::navigator::filter {

namespace {

// Order of PoseCovariance.
enum Row { kRowPosition = 0, kRowVelocity = 3, kRowAngles = 6, kRowHeading = 8, kNumRows = 9 };

void Unknown(int first, int size, PoseCovariance& covariance) {
  covariance.middleRows(first, size).setConstant(kNan);
  covariance.middleCols(first, size).setConstant(kNan);
}

}  // namespace

Pose ToPose(const State& state, const std::optional<Datum>& datum, const LocalFrame* map, const FilterParams& params) {
  Pose pose;
  pose.time = state.time;
  if (datum) pose.datum = *datum;
  const Eigen::Matrix3d R_level_vessel = state.nominal.R_level_vessel();
  const Eigen::Vector3d& p_vessel_origin_m = params.p_vessel_imu_m;
  Eigen::Vector3d reference_level_m = -(R_level_vessel * p_vessel_origin_m);  // from the origin
  Eigen::Vector3d swing_level_mps = -(R_level_vessel * state.nominal.angular_velocity_radps.cross(p_vessel_origin_m));
  if (!state.aiding.has_heading) {
    reference_level_m.head<2>().setZero();
    swing_level_mps.setZero();
  }

  const Here here = HereOf(state);
  const Eigen::Matrix3d R_here_vessel = here.R_here_level * R_level_vessel;
  const bool is_placed = state.aiding.has_position && state.nominal.level && map != nullptr;
  const Eigen::Isometry3d T_map_level = is_placed ? map->TransformFrom(state.nominal.level->frame) : Eigen::Isometry3d::Identity();

  Eigen::Matrix<double, kNumRows, kNumErrors> jacobian = Eigen::Matrix<double, kNumRows, kNumErrors>::Zero();
  jacobian.block<3, 3>(kRowPosition, kPosition) = T_map_level.linear();
  jacobian.block<3, 3>(kRowVelocity, kVelocity) = T_map_level.linear();
  jacobian.block<3, 3>(kRowPosition, kRotation) = -(T_map_level.linear() * Cross(reference_level_m));
  jacobian.block<3, 3>(kRowAngles, kRotation) = AngleJacobian(R_here_vessel) * here.R_here_level;
  jacobian.block<1, 3>(kRowHeading, kPosition) = here.heading_per_east_radpm * here.R_here_level.row(0);
  pose.covariance = jacobian * state.covariance * jacobian.transpose();
  pose.covariance = (0.5 * (pose.covariance + pose.covariance.transpose())).eval();

  const Eigen::Vector3d angles_rad = AnglesOf(R_here_vessel);
  pose.has_attitude = state.aiding.has_tilt;
  pose.roll_rad = state.aiding.has_tilt ? angles_rad[0] : 0.0;
  pose.pitch_rad = state.aiding.has_tilt ? angles_rad[1] : 0.0;
  if (state.aiding.heave.IsWithin(state.time, params.max_attitude_age)) {
    pose.heave_m = state.nominal.p_level_m.z() - state.nominal.water_level_m - (R_level_vessel * p_vessel_origin_m - p_vessel_origin_m).z();
  }
  if (state.aiding.has_heading) {
    pose.heading_rad = angles_rad[2];
    pose.heading_source = state.aiding.heading_source;
  } else {
    Unknown(kRowHeading, 1, pose.covariance);
    // Position is that of the antenna.
    const double lever_m = params.p_vessel_antenna_m.head<2>().norm();
    pose.covariance.diagonal().head<2>().array() += lever_m * lever_m;
  }
  if (is_placed) {
    Eigen::Vector3d p_level_m = state.nominal.p_level_m + reference_level_m;
    if (!state.aiding.has_height) p_level_m.z() = 0.0;  // the height of the datum
    pose.p_map_m = T_map_level * p_level_m;
    pose.velocity_map_mps = T_map_level.linear() * (state.nominal.velocity_level_mps + swing_level_mps);
    const GeodeticPlace place = state.nominal.level->frame.Reverse(p_level_m);
    pose.latitude_deg = place.latitude_deg;
    pose.longitude_deg = place.longitude_deg;
    pose.ellipsoid_height_m = place.ellipsoid_height_m;
    if (!state.aiding.has_height) {
      pose.ellipsoid_height_m = kNan;
      Unknown(kRowPosition + 2, 1, pose.covariance);
    }
  } else {
    Unknown(kRowPosition, 3, pose.covariance);
    Unknown(kRowVelocity, 3, pose.covariance);
  }

  const bool is_fix_stopped = state.aiding.fix.IsStoppedAt(state.time);
  if (state.aiding.has_position && state.aiding.has_heading) {
    pose.status = is_fix_stopped || state.aiding.heading().IsStoppedAt(state.time) ? PoseStatus::kCoasting : PoseStatus::kOk;
  } else if (state.aiding.has_position) {
    pose.status = PoseStatus::kNoHeading;
  } else if (state.aiding.has_heading) {
    pose.status = PoseStatus::kNoPosition;
  }
  return pose;
}

std::string StoppedInputs(const State& state) {
  std::string text;
  const auto say = [&](const UseTimes& input, const char* name) {
    if (!input.IsStoppedAt(state.time)) return;
    const auto since = std::chrono::floor<std::chrono::seconds>(state.time - *input.last).count();
    if (!text.empty()) text += ", ";
    text += "no " + std::string(name) + " for " + std::to_string(since) + " s";
  };
  say(state.aiding.fix, "position fix");
  say(state.aiding.sensor_heading, "heading");
  say(state.aiding.tilt, "attitude");
  say(state.aiding.imu, "IMU");
  if (IsImuRefused(state)) text += std::string(text.empty() ? "" : ", ") + "IMU not used: it contradicts fixes or attitudes";
  return text;
}

}  // namespace lookout::navigator::filter
