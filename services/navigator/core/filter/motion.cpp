#include "services/navigator/core/filter/motion.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::navigator::filter {

namespace {

// Longer ways are gone in steps: the turn of the lever arms is linear in each.
constexpr double kMaxStepS = 0.1;
// After so long without any item nothing is left of what was known.
constexpr double kMaxSilenceS = 60.0;

// Assumptions on small boats without an IMU. A course is changed, a wave passed, within seconds.
constexpr double kAccelerationSdMps2 = 0.5;
constexpr double kAccelerationTimeS = 2.0;
// Roll and pitch swing within one to four seconds, a turn lasts.
constexpr double kSwingSdRadps = DegToRad(15.0);
constexpr double kSwingTimeS = 0.5;
constexpr double kTurnSdRadps = DegToRad(10.0);
constexpr double kTurnTimeS = 3.0;

// Bias of an IMU while it runs: how far it wanders (twice the start of Analog Devices' and Honeywell's industrial MEMS, 8 deg/h and 13 ug, for heat
// and ageing), and how fast.
constexpr double kGyroBiasWanderRadps = DegToRad(0.005);
constexpr double kAccelerometerBiasWanderMps2 = 0.003;
constexpr double kBiasTimeS = 300.0;

// Scale and misalignment of the gyroscopes are known to 0.2 % (Bosch BMI088 data sheet, table 3: cross axis sensitivity 1 %, most of which stays the
// same; ADIS16470: 0.2 %), and a turn keeps its sense for about a second.
constexpr double kGyroScaleErrorRootS = 0.002;

// Tide, trim and load: a decimetre in a minute.
constexpr double kWaterLevelMPerRootS = 0.013;

// What of the gyroscope's bias is known when the IMU comes back, at least.
constexpr double kReturnedGyroBiasSdRadps = DegToRad(0.05);
constexpr double kReturnedAccelerometerBiasSdMps2 = 0.03;

// P <- F P F' for F that adds `factor` times part `from` to part `to`, rows first; columns in a second pass.
template <typename Factor>
void AddRows(int to, const Factor& factor, int from, ErrorCovariance& covariance) {
  covariance.middleRows<3>(to) += factor * covariance.middleRows<3>(from);
}
template <typename Factor>
void AddCols(int to, const Factor& factor_transposed, int from, ErrorCovariance& covariance) {
  covariance.middleCols<3>(to) += covariance.middleCols<3>(from) * factor_transposed;
}

void Scale(int part, int size, double factor, ErrorCovariance& covariance) {
  covariance.middleRows(part, size) *= factor;
  covariance.middleCols(part, size) *= factor;
}

void AddVariance(int part, const Eigen::Vector3d& variance, ErrorCovariance& covariance) { covariance.diagonal().segment<3>(part) += variance; }

// Variance that a Gauss-Markov process of this deviation takes up in a step, and what it keeps.
struct Fading {
  Fading(double sd, double time_constant_s, double step_s) : kept(Exp(-step_s / time_constant_s)), added_variance(sd * sd * (1.0 - kept * kept)) {}
  double kept;
  double added_variance;
};

void SwitchGyro(bool has_gyro, const FilterParams& params, State& state) {
  if (has_gyro == state.has_gyro) return;
  state.has_gyro = has_gyro;
  if (has_gyro) {
    const bool is_new = state.last_gyro_bias_radps.isZero();
    state.rate = state.last_gyro_bias_radps;
    Renew3(kRate, is_new ? params.gyro_bias_sd_radps : kReturnedGyroBiasSdRadps, state);
  } else {
    state.last_gyro_bias_radps = state.rate;
    state.rate = state.angular_velocity_radps;
    Renew<3>(kRate, Eigen::Vector3d(kSwingSdRadps, kSwingSdRadps, kTurnSdRadps), state);
  }
}

void SwitchStrapdown(bool is_strapdown, const FilterParams& params, State& state) {
  if (is_strapdown == state.is_strapdown) return;
  state.is_strapdown = is_strapdown;
  if (is_strapdown) {
    const bool is_new = state.last_accelerometer_bias_mps2.isZero();
    state.acceleration = state.last_accelerometer_bias_mps2;
    Renew3(kAcceleration, is_new ? params.accelerometer_bias_sd_mps2 : kReturnedAccelerometerBiasSdMps2, state);
  } else {
    state.last_accelerometer_bias_mps2 = state.acceleration;
    state.acceleration.setZero();
    Renew3(kAcceleration, kAccelerationSdMps2, state);
  }
}

// Attitude: gyroscopes, or the rate that fades. A tilt that nobody measures stays.
void Turn(const InertialSample* sample, double step_s, const Earth& earth, State& state) {
  if (sample != nullptr) {
    const Eigen::Vector3d earth_rate_radps = state.q_level_vessel.conjugate() * earth.rate_level_radps;
    state.angular_velocity_radps = sample->angular_velocity_radps - state.rate - earth_rate_radps;
  } else {
    if (!state.has_tilt) state.rate.head<2>().setZero();
    state.angular_velocity_radps = state.rate;
  }
  state.q_level_vessel = (state.q_level_vessel * RotationBy(state.angular_velocity_radps * step_s)).normalized();
}

void Step(const InertialSample* sample, double step_s, const Earth& earth, const FilterParams& params, State& state) {
  auto& covariance = state.covariance;
  const Eigen::Matrix3d R_begin = state.R_level_vessel();
  Turn(sample, step_s, earth, state);
  const Eigen::Matrix3d R_middle = (R_begin * RotationBy(state.angular_velocity_radps * (step_s / 2.0)).toRotationMatrix()).eval();
  const double half_step2_s2 = step_s * step_s / 2.0;

  Eigen::Vector3d acceleration_level_mps2 = state.acceleration;
  Eigen::Matrix3d velocity_by_rotation = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_acceleration = Eigen::Matrix3d::Identity() * step_s;
  if (state.is_strapdown) {
    const Eigen::Vector3d force_level_mps2 = R_middle * (sample->specific_force_mps2 - state.acceleration);
    acceleration_level_mps2 =
        force_level_mps2 - Eigen::Vector3d(0.0, 0.0, earth.gravity_mps2) - 2.0 * earth.rate_level_radps.cross(state.velocity_level_mps);
    velocity_by_rotation = -step_s * Cross(force_level_mps2);
    velocity_by_acceleration = -step_s * R_middle;
  }
  state.p_level_m += step_s * state.velocity_level_mps + half_step2_s2 * acceleration_level_mps2;
  state.velocity_level_mps += step_s * acceleration_level_mps2;
  const Eigen::Matrix3d rotation_by_rate = (sample != nullptr ? -step_s : step_s) * R_middle;

  // Position takes up velocity, velocity attitude and acceleration, attitude rate, each as it was.
  AddRows(kPosition, step_s, kVelocity, covariance);
  AddRows(kPosition, (step_s / 2.0 * velocity_by_acceleration).eval(), kAcceleration, covariance);
  AddRows(kVelocity, velocity_by_rotation, kRotation, covariance);
  AddRows(kVelocity, velocity_by_acceleration, kAcceleration, covariance);
  AddRows(kRotation, rotation_by_rate, kRate, covariance);
  AddCols(kPosition, step_s, kVelocity, covariance);
  AddCols(kPosition, (step_s / 2.0 * velocity_by_acceleration.transpose()).eval(), kAcceleration, covariance);
  AddCols(kVelocity, velocity_by_rotation.transpose().eval(), kRotation, covariance);
  AddCols(kVelocity, velocity_by_acceleration.transpose().eval(), kAcceleration, covariance);
  AddCols(kRotation, rotation_by_rate.transpose().eval(), kRate, covariance);

  const auto added = [](double sd_per_root_s, double duration_s) -> Eigen::Vector3d {
    return Eigen::Vector3d::Constant(sd_per_root_s * sd_per_root_s * duration_s);
  };
  const auto wander = [&](double sd) { return added(sd * std::sqrt(2.0 / kBiasTimeS), step_s); };
  if (sample != nullptr) {
    const double scale_noise_radps_rthz = kGyroScaleErrorRootS * state.angular_velocity_radps.norm();
    AddVariance(kRotation, added(Hypot(params.gyro_noise_radps_rthz, scale_noise_radps_rthz), step_s), covariance);
    AddVariance(kRate, wander(kGyroBiasWanderRadps), covariance);
  } else {
    const Fading swing(kSwingSdRadps, kSwingTimeS, step_s);
    const Fading turn(kTurnSdRadps, kTurnTimeS, step_s);
    state.rate = state.rate.cwiseProduct(Eigen::Vector3d(swing.kept, swing.kept, turn.kept));
    Scale(kRate, 2, swing.kept, covariance);
    Scale(kRate + 2, 1, turn.kept, covariance);
    AddVariance(kRate, {swing.added_variance, swing.added_variance, turn.added_variance}, covariance);
    if (!state.has_tilt) {
      covariance.middleRows<2>(kRate).setZero();
      covariance.middleCols<2>(kRate).setZero();
    }
  }
  if (state.is_strapdown) {
    AddVariance(kVelocity, added(params.accelerometer_noise_mps2_rthz, step_s), covariance);
    AddVariance(kAcceleration, wander(kAccelerometerBiasWanderMps2), covariance);
  } else {
    const Fading acceleration(kAccelerationSdMps2, kAccelerationTimeS, step_s);
    state.acceleration *= acceleration.kept;
    Scale(kAcceleration, 3, acceleration.kept, covariance);
    AddVariance(kAcceleration, Eigen::Vector3d::Constant(acceleration.added_variance), covariance);
  }
  const Fading fix(state.fix_error_model.sd, state.fix_error_model.time_constant_s, step_s);
  state.fix_error_m *= fix.kept;
  Scale(kFixError, 3, fix.kept, covariance);
  const double up_factor2 = state.fix_error_model.up_factor * state.fix_error_model.up_factor;
  AddVariance(kFixError, {fix.added_variance, fix.added_variance, up_factor2 * fix.added_variance}, covariance);
  const Fading heading(state.heading_error_model.sd, state.heading_error_model.time_constant_s, step_s);
  state.heading_error_rad *= heading.kept;
  Scale(kHeadingError, 1, heading.kept, covariance);
  covariance(kHeadingError, kHeadingError) += heading.added_variance;
  covariance(kWaterLevel, kWaterLevel) += kWaterLevelMPerRootS * kWaterLevelMPerRootS * step_s;
}

// What may no longer be told from what was measured long ago.
void Forget(const FilterParams& params, State& state) {
  if (state.has_heading) {
    const double heading_variance = state.covariance(kRotation + 2, kRotation + 2);
    const auto& source = state.heading_source == HeadingSource::kCourse ? state.course : state.sensor_heading;
    const auto max_age = state.heading_source == HeadingSource::kCourse ? params.max_position_age : params.max_attitude_age;
    const bool is_carried =
        state.has_gyro ? heading_variance <= params.max_heading_coast_sd_rad * params.max_heading_coast_sd_rad : source.IsWithin(state.time, max_age);
    if (!is_carried && !source.IsWithin(state.time, params.max_attitude_age)) {
      // Position is that of the antenna again.
      if (state.has_position) ShiftPosition(state.R_level_vessel() * AntennaLever(params), state);
      state.has_heading = false;
      state.heading_source = HeadingSource::kNone;
      state.heading_refusals = {};
    }
  }
  if (state.has_tilt && !state.has_gyro && !state.tilt.IsWithin(state.time, params.max_attitude_age)) {
    // Level, as boats lie in the mean.
    state.has_tilt = false;
    const double heading_rad = AnglesOf(state.R_level_vessel())[2];
    state.q_level_vessel = RotationBy(Eigen::Vector3d(0.0, 0.0, kPi / 2.0 - heading_rad));
    const double heading_variance = state.covariance(kRotation + 2, kRotation + 2);
    Renew<3>(kRotation, Eigen::Vector3d(params.unmeasured_tilt_sd_rad, params.unmeasured_tilt_sd_rad, std::sqrt(heading_variance)), state);
  }
  if (state.has_position) {
    const double variance = std::max(state.covariance(0, 0), state.covariance(1, 1));
    const double max_variance = state.position_sd_at_fix_m * state.position_sd_at_fix_m + params.max_coast_sd_m * params.max_coast_sd_m;
    const bool is_carried = state.fix.IsWithin(state.time, params.max_position_age) && variance <= max_variance;
    // Fixes that contradicted are not forgotten: they tell the next one what was wrong.
    if (!is_carried && state.fix.IsStoppedAt(state.time)) ForgetPlace(state);
  }
  if (!state.has_position) {
    state.p_level_m.head<2>().setZero();
    Renew<2>(kPosition, Eigen::Vector2d::Zero(), state);
    if (state.covariance(kVelocity, kVelocity) > kUnknownSpeedSdMps * kUnknownSpeedSdMps) {
      state.velocity_level_mps.head<2>().setZero();
      Renew<2>(kVelocity, Eigen::Vector2d::Constant(kUnknownSpeedSdMps), state);
    }
  }
}

}  // namespace

void CarryOn(const InertialSample* sample, Utime time, const FilterParams& params, State& state) {
  FollowBoat(state);
  double remaining_s = SecondsBetween(state.time, time);
  if (remaining_s > kMaxSilenceS) {
    State fresh = FreshState(time, params.unmeasured_tilt_sd_rad);
    fresh.level = state.level;
    // Which inputs there were: HEALTH names those that do not come back.
    fresh.fix = state.fix;
    fresh.sensor_heading = state.sensor_heading;
    fresh.tilt = state.tilt;
    fresh.imu = state.imu;
    state = fresh;
    return;
  }
  if (remaining_s <= 0.0) return;
  if (IsImuRefused(state)) sample = nullptr;
  SwitchGyro(sample != nullptr, params, state);
  while (remaining_s > 0.0) {
    SwitchStrapdown(sample != nullptr && state.has_position && state.has_heading && state.has_tilt, params, state);
    const double step_s = std::min(remaining_s, kMaxStepS);
    remaining_s -= step_s;
    state.time = remaining_s > 0.0 ? time - std::chrono::microseconds(std::llround(remaining_s * 1e6)) : time;
    Step(sample, step_s, EarthOf(state), params, state);
    FollowBoat(state);
    Forget(params, state);
  }
}

}  // namespace lookout::navigator::filter
