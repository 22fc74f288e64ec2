#include "services/navigator/core/filter/motion.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::navigator::filter {

namespace {

// The lidar's turns add up to a degree within minutes; a compass that drifts, or is drawn, goes on.
constexpr double kApartTimeS = 300.0;

// Longer intervals are propagated in steps: the turn of the lever arms is linear in each.
constexpr double kMaxStepS = 0.1;
// After so long without any item nothing of the state is valid.
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

// Least knowledge of the gyroscope's bias when the IMU comes back.
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

// Variance that a Gauss-Markov process of this deviation gains in a step, and the share that it keeps.
struct Fading {
  Fading(double sd, double time_constant_s, double step_s) : kept(Exp(-step_s / time_constant_s)), added_variance(sd * sd * (1.0 - kept * kept)) {}
  double kept;
  double added_variance;
};

void SwitchGyro(bool has_gyro, const FilterParams& params, State& state) {
  if (has_gyro == state.aiding.has_gyro) return;
  state.aiding.has_gyro = has_gyro;
  if (has_gyro) {
    const bool is_new = state.aiding.last_gyro_bias_radps.isZero();
    state.nominal.rate = state.aiding.last_gyro_bias_radps;
    ResetError3(kRate, is_new ? params.gyro_bias_sd_radps : kReturnedGyroBiasSdRadps, state);
  } else {
    state.aiding.last_gyro_bias_radps = state.nominal.rate;
    state.nominal.rate = state.nominal.angular_velocity_radps;
    ResetError<3>(kRate, Eigen::Vector3d(kSwingSdRadps, kSwingSdRadps, kTurnSdRadps), state);
  }
}

void SwitchStrapdown(bool is_strapdown, const FilterParams& params, State& state) {
  if (is_strapdown == state.aiding.is_strapdown) return;
  state.aiding.is_strapdown = is_strapdown;
  if (is_strapdown) {
    const bool is_new = state.aiding.last_accelerometer_bias_mps2.isZero();
    state.nominal.acceleration = state.aiding.last_accelerometer_bias_mps2;
    ResetError3(kAcceleration, is_new ? params.accelerometer_bias_sd_mps2 : kReturnedAccelerometerBiasSdMps2, state);
  } else {
    state.aiding.last_accelerometer_bias_mps2 = state.nominal.acceleration;
    state.nominal.acceleration.setZero();
    ResetError3(kAcceleration, kAccelerationSdMps2, state);
  }
}

// By the gyroscopes, or the rate that fades. A tilt that was not measured stays.
void PropagateAttitude(const ImuSample* sample, double step_s, const Earth& earth, State& state) {
  if (sample != nullptr) {
    const Eigen::Vector3d earth_rate_radps = state.nominal.q_level_vessel.conjugate() * earth.rate_level_radps;
    state.nominal.angular_velocity_radps = sample->angular_velocity_radps - state.nominal.rate - earth_rate_radps;
  } else {
    if (!state.aiding.has_tilt) state.nominal.rate.head<2>().setZero();
    state.nominal.angular_velocity_radps = state.nominal.rate;
  }
  state.nominal.q_level_vessel = (state.nominal.q_level_vessel * RotationBy(state.nominal.angular_velocity_radps * step_s)).normalized();
}

void PropagateStep(const ImuSample* sample, double step_s, const Earth& earth, const FilterParams& params, State& state) {
  auto& covariance = state.covariance;
  const Eigen::Matrix3d R_begin = state.nominal.R_level_vessel();
  PropagateAttitude(sample, step_s, earth, state);
  state.aiding.heading_apart_rad *= Exp(-step_s / kApartTimeS);
  const Eigen::Matrix3d R_middle = (R_begin * RotationBy(state.nominal.angular_velocity_radps * (step_s / 2.0)).toRotationMatrix()).eval();
  const double half_step2_s2 = step_s * step_s / 2.0;

  Eigen::Vector3d acceleration_level_mps2 = state.nominal.acceleration;
  Eigen::Matrix3d velocity_by_rotation = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d velocity_by_acceleration = Eigen::Matrix3d::Identity() * step_s;
  if (state.aiding.is_strapdown) {
    const Eigen::Vector3d force_level_mps2 = R_middle * (sample->specific_force_mps2 - state.nominal.acceleration);
    acceleration_level_mps2 =
        force_level_mps2 - Eigen::Vector3d(0.0, 0.0, earth.gravity_mps2) - 2.0 * earth.rate_level_radps.cross(state.nominal.velocity_level_mps);
    velocity_by_rotation = -step_s * Cross(force_level_mps2);
    velocity_by_acceleration = -step_s * R_middle;
  }
  state.nominal.p_level_m += step_s * state.nominal.velocity_level_mps + half_step2_s2 * acceleration_level_mps2;
  state.nominal.velocity_level_mps += step_s * acceleration_level_mps2;
  const Eigen::Matrix3d rotation_by_rate = (sample != nullptr ? -step_s : step_s) * R_middle;

  // Position integrates velocity; velocity attitude and acceleration; attitude rate: each of the step before.
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
    const double scale_noise_radps_rthz = kGyroScaleErrorRootS * state.nominal.angular_velocity_radps.norm();
    AddVariance(kRotation, added(Hypot(params.gyro_noise_radps_rthz, scale_noise_radps_rthz), step_s), covariance);
    AddVariance(kRate, wander(kGyroBiasWanderRadps), covariance);
  } else {
    const Fading swing(kSwingSdRadps, kSwingTimeS, step_s);
    const Fading turn(kTurnSdRadps, kTurnTimeS, step_s);
    state.nominal.rate = state.nominal.rate.cwiseProduct(Eigen::Vector3d(swing.kept, swing.kept, turn.kept));
    Scale(kRate, 2, swing.kept, covariance);
    Scale(kRate + 2, 1, turn.kept, covariance);
    AddVariance(kRate, {swing.added_variance, swing.added_variance, turn.added_variance}, covariance);
    if (!state.aiding.has_tilt) {
      covariance.middleRows<2>(kRate).setZero();
      covariance.middleCols<2>(kRate).setZero();
    }
  }
  if (state.aiding.is_strapdown) {
    AddVariance(kVelocity, added(params.accelerometer_noise_mps2_rthz, step_s), covariance);
    AddVariance(kAcceleration, wander(kAccelerometerBiasWanderMps2), covariance);
  } else {
    const Fading acceleration(kAccelerationSdMps2, kAccelerationTimeS, step_s);
    state.nominal.acceleration *= acceleration.kept;
    Scale(kAcceleration, 3, acceleration.kept, covariance);
    AddVariance(kAcceleration, Eigen::Vector3d::Constant(acceleration.added_variance), covariance);
  }
  const Fading fix(state.aiding.fix_error_model.sd, state.aiding.fix_error_model.time_constant_s, step_s);
  state.nominal.fix_error_m *= fix.kept;
  Scale(kFixError, 3, fix.kept, covariance);
  const double up_factor2 = state.aiding.fix_error_model.up_factor * state.aiding.fix_error_model.up_factor;
  AddVariance(kFixError, {fix.added_variance, fix.added_variance, up_factor2 * fix.added_variance}, covariance);
  const Fading heading(state.aiding.heading_error_model.sd, state.aiding.heading_error_model.time_constant_s, step_s);
  state.nominal.heading_error_rad *= heading.kept;
  Scale(kHeadingError, 1, heading.kept, covariance);
  covariance(kHeadingError, kHeadingError) += heading.added_variance;
  covariance(kWaterLevel, kWaterLevel) += kWaterLevelMPerRootS * kWaterLevelMPerRootS * step_s;
}

// The lidar carries them no longer than so: what it takes for a shore may be a ship that leaves, and the stated deviation does not hold that.
constexpr std::chrono::seconds kMaxCarriedPosition(120);
constexpr std::chrono::seconds kMaxCarriedHeading(600);

// Gives up values that were measured too long ago.
void ForgetOld(const FilterParams& params, State& state) {
  if (state.aiding.has_heading) {
    const double heading_variance = state.covariance(kRotationUp, kRotationUp);
    const auto& source = state.aiding.heading();
    const auto max_age = state.aiding.heading_source == HeadingSource::kCourse ? params.max_position_age : params.max_attitude_age;
    // Gyroscopes and the lidar tell the turn.
    const bool is_turn_known = state.aiding.has_gyro || (state.aiding.odometry.IsWithin(state.time, params.max_attitude_age) &&
                                                         source.IsWithin(state.time, kMaxCarriedHeading));
    const bool is_carried =
        is_turn_known ? heading_variance <= params.max_heading_coast_sd_rad * params.max_heading_coast_sd_rad : source.IsWithin(state.time, max_age);
    if (!is_carried && !source.IsWithin(state.time, params.max_attitude_age)) {
      // Without heading the position is the antenna's again.
      if (state.aiding.has_position) ShiftPosition(state.nominal.R_level_vessel() * AntennaLever(params), state);
      state.aiding.has_heading = false;
      state.aiding.heading_source = HeadingSource::kNone;
      state.aiding.heading_refusals = {};
    }
  }
  if (state.aiding.has_tilt && !state.aiding.has_gyro && !state.aiding.tilt.IsWithin(state.time, params.max_attitude_age)) {
    // Level, as boats lie in the mean.
    state.aiding.has_tilt = false;
    const double heading_rad = AnglesOf(state.nominal.R_level_vessel())[2];
    state.nominal.q_level_vessel = RotationBy(Eigen::Vector3d(0.0, 0.0, kPi / 2.0 - heading_rad));
    const double heading_variance = state.covariance(kRotationUp, kRotationUp);
    state.aiding.scan_place = {};
    ResetError<3>(kRotation, Eigen::Vector3d(params.unmeasured_tilt_sd_rad, params.unmeasured_tilt_sd_rad, std::sqrt(heading_variance)), state);
  }
  if (state.aiding.has_position) {
    const double variance = state.HorizontalVarianceM2();
    const double max_variance = state.aiding.position_sd_at_fix_m * state.aiding.position_sd_at_fix_m + params.max_coast_sd_m * params.max_coast_sd_m;
    const bool is_way_known =
        state.aiding.fix.IsWithin(state.time, params.max_position_age) ||
        (state.aiding.odometry.IsWithin(state.time, params.max_position_age) && state.aiding.fix.IsWithin(state.time, kMaxCarriedPosition));
    const bool is_carried = is_way_known && variance <= max_variance;
    // Contradicting fixes are not forgotten: they tell the next one what was wrong.
    if (!is_carried && state.aiding.fix.IsStoppedAt(state.time)) ForgetPlace(state);
  }
  if (!state.aiding.has_position) {
    state.nominal.p_level_m.head<2>().setZero();
    ResetError<2>(kPosition, Eigen::Vector2d::Zero(), state);
    if (state.covariance(kVelocityEast, kVelocityEast) > kUnknownSpeedSdMps * kUnknownSpeedSdMps) {
      state.nominal.velocity_level_mps.head<2>().setZero();
      ResetError<2>(kVelocity, Eigen::Vector2d::Constant(kUnknownSpeedSdMps), state);
    }
  }
}

}  // namespace

void Propagate(const ImuSample* sample, Utime time, const FilterParams& params, State& state) {
  FollowBoat(state);
  double remaining_s = SecondsBetween(state.time, time);
  if (remaining_s > kMaxSilenceS) {
    State fresh = FreshState(time, params.unmeasured_tilt_sd_rad);
    fresh.nominal.level = state.nominal.level;
    // HEALTH names the sensors that do not come back.
    fresh.aiding.fix = state.aiding.fix;
    fresh.aiding.sensor_heading = state.aiding.sensor_heading;
    fresh.aiding.tilt = state.aiding.tilt;
    fresh.aiding.imu = state.aiding.imu;
    state = fresh;
    return;
  }
  if (remaining_s <= 0.0) return;
  if (IsImuRefused(state)) sample = nullptr;
  SwitchGyro(sample != nullptr, params, state);
  while (remaining_s > 0.0) {
    SwitchStrapdown(sample != nullptr && state.aiding.has_position && state.aiding.has_heading && state.aiding.has_tilt, params, state);
    const double step_s = std::min(remaining_s, kMaxStepS);
    remaining_s -= step_s;
    state.time = remaining_s > 0.0 ? time - std::chrono::microseconds(std::llround(remaining_s * 1e6)) : time;
    PropagateStep(sample, step_s, EarthOf(state), params, state);
    FollowBoat(state);
    ForgetOld(params, state);
  }
}

}  // namespace lookout::navigator::filter
