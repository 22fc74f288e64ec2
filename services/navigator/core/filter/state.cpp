#include "services/navigator/core/filter/state.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::navigator::filter {

namespace {

constexpr double kMaxIntervalS = 2.0;
constexpr double kStopS = 1.0;

// Priors: how fast a boat turns, its accelerations.
constexpr double kUnknownRateSdRadps = 0.2;
constexpr double kUnknownAccelerationSdMps2 = 0.5;
constexpr double kUnknownLevelSdM = 1.0;

// How long an IMU, or the lidar's motion, is not used that led the state astray.
constexpr double kFirstRefusalS = 10.0;
constexpr double kMaxRefusalS = 600.0;
// Where it was used for so many times as long since then, it is refused for as long as at first.
constexpr double kForgivenAfter = 10.0;
// A motion that was used within this time has led the state.
constexpr std::chrono::seconds kLedByLidar{5};
// A boat without an IMU goes up and down by so much.
constexpr double kUpSdMps = 0.5;
// A compass that turns around, with the greatest deviation of its card each way, and the lidar's own error: in deviations of the compass.
constexpr double kMostApartInSds = 5.0;

double NextRefusalS(const std::optional<Utime>& refused_until, double refusal_s, Utime time) {
  if (!refused_until || SecondsBetween(*refused_until, time) > kForgivenAfter * refusal_s) return kFirstRefusalS;
  return std::min(2.0 * refusal_s, kMaxRefusalS);
}

}  // namespace

// Not through ToSeconds: its nanoseconds overflow after 292 years, and times from outside may be 300 years apart.
double SecondsBetween(Utime from, Utime to) { return std::chrono::duration<double>(to - from).count(); }

double AidingStatus::HeadingDoubtRad() const {
  if (heading_error_model.kind != ErrorKind::kCompass) return 0.0;
  return std::max(std::abs(heading_apart_rad) - kMostApartInSds * heading_error_model.sd, 0.0);
}

void UseTimes::Use(Utime time) {
  if (last && time > *last) interval_s = std::min(SecondsBetween(*last, time), kMaxIntervalS);
  if (!last || time > *last) last = time;
}

bool UseTimes::IsStoppedAt(Utime time) const { return last && SecondsBetween(*last, time) > std::max(kStopS, 1.5 * interval_s + 0.5); }

State FreshState(Utime time, double tilt_sd_rad) {
  State state;
  state.time = time;
  ResetError3(kVelocity, kUnknownSpeedSdMps, state);
  ResetError3(kRotation, tilt_sd_rad, state);
  ResetError3(kRate, kUnknownRateSdRadps, state);
  ResetError3(kAcceleration, kUnknownAccelerationSdMps2, state);
  state.covariance(kPositionUp, kPositionUp) = kUnknownLevelSdM * kUnknownLevelSdM;
  state.covariance(kWaterLevel, kWaterLevel) = kUnknownLevelSdM * kUnknownLevelSdM;
  return state;
}

double State::HorizontalVarianceM2() const { return std::max(covariance(kPositionEast, kPositionEast), covariance(kPositionNorth, kPositionNorth)); }

Eigen::Vector3d AntennaLever(const FilterParams& params) { return params.p_vessel_antenna_m - params.p_vessel_imu_m; }

void RefuseImu(double tilt_sd_rad, State& state) {
  state.aiding.imu_refusal_s = NextRefusalS(state.aiding.imu_refused_until, state.aiding.imu_refusal_s, state.time);
  state.aiding.imu_refused_until = state.time + std::chrono::microseconds(std::llround(1e6 * state.aiding.imu_refusal_s));
  state.aiding.has_gyro = state.aiding.is_strapdown = false;
  state.aiding.last_gyro_bias_radps.setZero();
  state.aiding.last_accelerometer_bias_mps2.setZero();
  state.nominal.angular_velocity_radps.setZero();
  state.nominal.rate.setZero();
  state.nominal.acceleration.setZero();
  state.nominal.velocity_level_mps.z() = 0.0;
  ResetError3(kRate, kUnknownRateSdRadps, state);
  ResetError3(kAcceleration, kUnknownAccelerationSdMps2, state);
  ResetError<1>(kVelocityUp, Eigen::Matrix<double, 1, 1>(kUpSdMps), state);
  state.covariance.diagonal().segment<2>(kRotation).array() += tilt_sd_rad * tilt_sd_rad;
  BeginMeanForce(state);
}

void RefuseOdometry(const std::optional<Utime>& led, State& state) {
  auto& aiding = state.aiding;
  if (IsOdometryRefused(state) || !led || state.time - *led > kLedByLidar) return;
  aiding.odometry_refusal_s = NextRefusalS(aiding.odometry_refused_until, aiding.odometry_refusal_s, state.time);
  aiding.odometry_refused_until = state.time + std::chrono::microseconds(std::llround(1e6 * aiding.odometry_refusal_s));
}

bool IsOdometryRefused(const State& state) { return state.aiding.odometry_refused_until && state.time < *state.aiding.odometry_refused_until; }

void BeginMeanForce(State& state) {
  state.aiding.num_forces = 0;
  state.aiding.force_sum_mps2.setZero();
}

bool IsImuRefused(const State& state) { return state.aiding.imu_refused_until && state.time < *state.aiding.imu_refused_until; }

void Inject(const ErrorVector& error, State& state) {
  state.nominal.p_level_m += error.segment<3>(kPosition);
  state.nominal.velocity_level_mps += error.segment<3>(kVelocity);
  state.nominal.q_level_vessel = (RotationBy(error.segment<3>(kRotation)) * state.nominal.q_level_vessel).normalized();
  state.nominal.rate += error.segment<3>(kRate);
  state.nominal.acceleration += error.segment<3>(kAcceleration);
  state.nominal.fix_error_m += error.segment<3>(kFixError);
  state.nominal.heading_error_rad += error[kHeadingError];
  state.nominal.water_level_m += error[kWaterLevel];
  state.nominal.scan_p_level_m += error.segment<2>(kScanPlace);
  state.nominal.scan_heading_rad -= error[kScanRotation];
  state.nominal.angular_velocity_radps += (state.aiding.has_gyro ? -1.0 : 1.0) * error.segment<3>(kRate);
}

void ResetError3(int part, double sd, State& state) { ResetError<3>(part, Eigen::Vector3d::Constant(sd), state); }

Eigen::Vector3d AnglesOf(const Eigen::Matrix3d& R) {
  return {Atan2(R(2, 1), R(2, 2)), Asin(std::clamp(R(2, 0), -1.0, 1.0)), WrapTo2Pi(Atan2(R(0, 0), R(1, 0)))};
}

// A small rotation r changes the bow b = R e_x by r x b, and the up row u of R, of which roll and pitch are read, by (r_x R_north - r_y R_east).
Eigen::Matrix3d AngleJacobian(const Eigen::Matrix3d& R) {
  constexpr double kSmall = 1e-6;
  const double side2 = std::max(R(2, 1) * R(2, 1) + R(2, 2) * R(2, 2), kSmall);
  const double cosine = std::sqrt(side2);
  const double level2 = std::max(R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0), kSmall);
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
  jacobian(0, 0) = (R(2, 2) * R(1, 1) - R(2, 1) * R(1, 2)) / side2;
  jacobian(0, 1) = -(R(2, 2) * R(0, 1) - R(2, 1) * R(0, 2)) / side2;
  jacobian(1, 0) = R(1, 0) / cosine;
  jacobian(1, 1) = -R(0, 0) / cosine;
  jacobian(2, 0) = R(2, 0) * R(0, 0) / level2;
  jacobian(2, 1) = R(2, 0) * R(1, 0) / level2;
  jacobian(2, 2) = -1.0;
  return jacobian;
}

Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

Eigen::Quaterniond RotationBy(const Eigen::Vector3d& rotation_rad) {
  const double angle_rad = rotation_rad.norm();
  // Below it the sine of half the angle over the angle is one half to the last bit.
  constexpr double kSmallRad = 1e-8;
  const auto [sin_half, cos_half] = SinCosOf(angle_rad / 2.0);
  const double factor = angle_rad > kSmallRad ? sin_half / angle_rad : 0.5;
  Eigen::Quaterniond q;
  q.w() = cos_half;
  q.vec() = factor * rotation_rad;
  return q;
}

void TurnClockwise(double angle_rad, State& state) {
  const Eigen::Quaterniond turn = RotationBy(Eigen::Vector3d(0.0, 0.0, -angle_rad));
  const Eigen::Matrix3d R = turn.toRotationMatrix();
  state.aiding.scan_place = {};
  state.nominal.q_level_vessel = (turn * state.nominal.q_level_vessel).normalized();
  state.covariance.middleRows<3>(kRotation) = (R * state.covariance.middleRows<3>(kRotation)).eval();
  state.covariance.middleCols<3>(kRotation) = (state.covariance.middleCols<3>(kRotation) * R.transpose()).eval();
}

void BeginTilt(const Eigen::Quaterniond& q_level_vessel, double sd_rad, State& state) {
  const double heading_rad = AnglesOf(state.nominal.R_level_vessel())[2];
  const double heading_variance = state.covariance(kRotationUp, kRotationUp);
  state.nominal.q_level_vessel = q_level_vessel.normalized();
  state.nominal.q_level_vessel =
      (RotationBy(Eigen::Vector3d(0.0, 0.0, AnglesOf(state.nominal.R_level_vessel())[2] - heading_rad)) * state.nominal.q_level_vessel).normalized();
  state.aiding.scan_place = {};
  ResetError<2>(kRotation, Eigen::Vector2d::Constant(sd_rad), state);
  state.covariance(kRotationUp, kRotationUp) = heading_variance;
  state.aiding.has_tilt = true;
}

PlanarPlace PlanarPlaceOf(const FilterParams& params, const State& state) {
  PlanarPlace place;
  const Eigen::Matrix3d R_level_vessel = state.nominal.R_level_vessel();
  const Eigen::Vector3d reference_level_m = -(R_level_vessel * params.p_vessel_imu_m);  // from the origin
  place.p_level_m = (state.nominal.p_level_m + reference_level_m).head<2>();
  place.heading_rad = AnglesOf(R_level_vessel)[2];
  place.jacobian.block<2, 2>(0, kPosition).setIdentity();
  place.jacobian.block<2, 3>(0, kRotation) = -Cross(reference_level_m).topRows<2>();
  place.jacobian.block<1, 3>(2, kRotation) = -AngleJacobian(R_level_vessel).row(2);
  return place;
}

void SetScanPlace(const FilterParams& params, State& state) {
  const auto place = PlanarPlaceOf(params, state);
  state.nominal.scan_p_level_m = place.p_level_m;
  state.nominal.scan_heading_rad = place.heading_rad;
  ResetError<3>(kScanPlace, Eigen::Vector3d::Zero(), state);
  const Eigen::Matrix<double, 3, kNumErrors> rows = place.jacobian * state.covariance;
  state.covariance.middleRows<3>(kScanPlace) = rows;
  state.covariance.middleCols<3>(kScanPlace) = rows.transpose();
  state.covariance.block<3, 3>(kScanPlace, kScanPlace) = rows * place.jacobian.transpose();
  state.aiding.scan_place = {state.time, state.aiding.has_position, state.aiding.has_heading};
}

void ShiftPosition(const Eigen::Vector3d& lever_level_m, State& state) {
  state.aiding.scan_place = {};
  state.nominal.p_level_m.head<2>() += lever_level_m.head<2>();
  const Eigen::Matrix<double, 2, 3> by_rotation = -Cross(lever_level_m).topRows<2>();
  state.covariance.middleRows<2>(kPosition) += by_rotation * state.covariance.middleRows<3>(kRotation);
  state.covariance.middleCols<2>(kPosition) += state.covariance.middleCols<3>(kRotation) * by_rotation.transpose();
}

}  // namespace lookout::navigator::filter
