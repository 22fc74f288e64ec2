#include "services/navigator/core/filter/aiding.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/navigator/core/filter/kalman.hpp"

namespace lookout::navigator::filter {

namespace {

using namespace std::chrono_literals;

// A prior that says nothing, against which any measurement counts alone: m, m/s, rad. No boat has gone faster than 142 m/s (the world water speed
// record).
constexpr double kAnywhereM = 1000.0;
constexpr double kAnySpeedMps = 150.0;
constexpr double kAnyHeadingRad = 10.0;
constexpr double kAnyTiltRad = 10.0;

// Errors of a receiver's positions change over minutes (satellites, ionosphere, reflections): Kaplan, Hegarty, "Understanding GPS", 3rd edition,
// chapter 10. Phase solutions (RTK) say a decimetre or less, and half of their error is of that kind, of the others nearly all.
constexpr double kRtkMaxSdM = 0.1;
constexpr double kRtkSlowShare = 0.5;
constexpr double kGnssSlowShare = 0.95;
constexpr double kFixErrorTimeS = 60.0;
constexpr double kSameErrorRatio = 0.6;
// Two antennas say half a degree or less, and err by noise. A compass has a deviation that stays while the boat keeps its heading, and so has the
// course against the heading (leeway, current).
constexpr double kTwoAntennasMaxSdRad = DegToRad(0.5);
constexpr double kTwoAntennasSlowShare = 0.25;
constexpr double kCompassSlowShare = 0.95;
constexpr double kHeadingErrorTimeS = 30.0;
// Attitude sensors send the same error again and again: their output is filtered. So long two samples count as one.
constexpr double kHeadingCorrelationS = 0.1;
constexpr double kTiltCorrelationS = 0.5;
// Velocities of receivers without phase solution are filtered, and at walking pace off by the same decimetre a second for many seconds: propagated as
// white noise they led 20 m away from the fixes of a recording (signalk_gps.log).
constexpr double kVelocityCorrelationS = 10.0;
// Accuracy of heave: 5 cm or 5 % (Kongsberg MRU and Seapath data sheets).
constexpr double kHeaveSdM = 0.05;

// A contradiction that lasts this long without changing is a fault of the state.
constexpr auto kMaxRefusal = 3s;
// The bound for positions while accelerometers are used: by then the propagated position is off by less than 1 m, so a jump is rather a fault of the
// receiver.
constexpr auto kMaxStrapdownRefusal = 10s;
constexpr double kEvenInSds = 5.0;
// A difference that changes, while the refused measurements agree with each other, is of the state too: an IMU leads it away ever faster. A compass
// beside gyroscopes is disturbed for so long by things that the boat passes.
constexpr auto kMaxAgreeingRefusal = 3s;
constexpr auto kMaxCompassRefusal = 10s;
// How far successive measurements may differ: by their deviations, and by the boat's motion meanwhile. Longer apart they say nothing of each other.
constexpr double kAgreeInSds = 7.0;
constexpr double kMostAccelerationMps2 = 5.0;
constexpr double kMostSpeedMps = 30.0;
constexpr double kMostTurnRadps = 1.0;
constexpr auto kMaxApart = 2500ms;

// How fast the lever arm swings while the heading is unknown.
constexpr double kUnknownTurnRadps = 0.2;
// A velocity without a time of its own is late by some tenths of a second, in which a boat changes it by so much.
constexpr double kLateVelocitySdMps = 0.15;
constexpr auto kTimedVelocityAge = 2s;

// Accelerations of a boat that cannot be distinguished from gravity: 0.5 m/s2 for 2 s, a wave's (motion.cpp). Their remainder when the IMU is calm.
constexpr double kForceSdMps2 = 0.5;
constexpr double kForceTimeS = 2.0;
constexpr double kCalmForceSdMps2 = 0.1;
constexpr double kLevelPeriodS = 0.1;
constexpr double kCalmMeanTimeS = 1.0;
constexpr double kCalmMaxVariance = 0.05 * 0.05;
constexpr double kCalmMaxRateRadps = DegToRad(2.0);

// Heave of small boats, and how fast.
constexpr double kFloatingSdM = 0.5;
constexpr double kFloatingSdMps = 0.5;
constexpr auto kWaterPeriod = 1s;

// @return whether the measurement was accepted
template <int kSize>
bool Update(const Innovation<kSize>& innovation, bool is_forced, State& state, GateCounts& counts) {
  const auto correction = Correct(innovation, is_forced, state);
  if (!is_forced) {
    counts.nis_sum += correction.nis;
    counts.num_degrees += kSize;
  }
  counts.num_gated += correction.is_accepted ? 0 : 1;
  return correction.is_accepted;
}

// The verdict of refused measurements on the state. A sensor's fault changes; a wrong state differs by the same all the time. The state was led away
// where refused measurements have agreed with each other for long while their difference from the state changed.
struct StateFault {
  bool is_wrong = false;
  bool is_led_away = false;

  explicit operator bool() const { return is_wrong || is_led_away; }
};

// Counts a refusal.
StateFault AddRefusal(const Eigen::Vector3d& residual, double sd, bool agrees, Utime time, std::chrono::seconds max_even,
                      std::chrono::seconds max_agreeing, Refusals& refusals) {
  if (!refusals.since || (residual - refusals.first_residual).norm() > kEvenInSds * sd) {
    refusals.since = time;
    refusals.first_residual = residual;
  }
  if (!agrees || !refusals.agreeing_since || time - refusals.last > kMaxApart) refusals.agreeing_since = time;
  refusals.last = time;
  return {time - *refusals.since >= max_even, *refusals.since > *refusals.agreeing_since && time - *refusals.agreeing_since >= max_agreeing};
}

// A value that repeats to the last digit is frozen: it agrees with nothing.
bool AgreesWithLast(const FixMeasurement& fix, const State& state) {
  const auto& refusals = state.aiding.fix_refusals;
  const bool is_frozen =
      refusals.last_place.latitude_deg == fix.antenna.latitude_deg && refusals.last_place.longitude_deg == fix.antenna.longitude_deg;
  if (!refusals.agreeing_since || is_frozen) return false;
  const double since_s = SecondsBetween(refusals.last, state.time);
  Eigen::Vector2d way_m = LocalFrame(OnEllipsoid(refusals.last_place)).Forward(OnEllipsoid(fix.antenna)).head<2>();
  double most_m = kAgreeInSds * fix.horizontal_sd_m;
  if (fix.velocity) {
    way_m -= since_s * fix.velocity->east_north_mps;
    most_m += since_s * kAgreeInSds * fix.velocity->sd_mps + 0.5 * kMostAccelerationMps2 * since_s * since_s;
  } else {
    most_m += kMostSpeedMps * since_s;
  }
  return way_m.norm() <= most_m;
}

// @param angles_rad  of which those count that the measurement has; the others are 0
bool AgreesWithLast(const Eigen::Vector3d& angles_rad, double sd_rad, Utime time, const Refusals& refusals) {
  if (!refusals.agreeing_since || angles_rad == refusals.last_angles_rad) return false;
  const double most_rad = kAgreeInSds * sd_rad + kMostTurnRadps * SecondsBetween(refusals.last, time);
  for (int i = 0; i < 3; ++i) {
    if (std::abs(WrapToPi(angles_rad[i] - refusals.last_angles_rad[i])) > most_rad) return false;
  }
  return true;
}

// Adds a refusal of angles. @return whether the attitude is given up for it
bool IsAttitudeGivenUp(const Eigen::Vector3d& angles_rad, const Eigen::Vector3d& residual_rad, double sd_rad, std::chrono::seconds max_agreeing,
                       const FilterParams& params, Refusals& refusals, State& state, GateCounts& counts) {
  const bool agrees = AgreesWithLast(angles_rad, sd_rad, state.time, refusals);
  const auto fault = AddRefusal(residual_rad, sd_rad, agrees, state.time, kMaxRefusal, max_agreeing, refusals);
  refusals.last_angles_rad = angles_rad;
  if (!fault) return false;
  ++counts.num_renewed;
  if (fault.is_led_away && state.aiding.has_gyro) RefuseImu(params.tilt_sd_rad, state);
  return true;
}

// The lever arm in the level frame. Without heading its east and north parts are 0, as the position is then the antenna's.
Eigen::Vector3d LeverLevel(const FilterParams& params, const State& state) {
  Eigen::Vector3d lever_level_m = state.nominal.q_level_vessel * AntennaLever(params);
  if (!state.aiding.has_heading) lever_level_m.head<2>().setZero();
  return lever_level_m;
}

double White(double sd, double slow_sd) { return std::sqrt(std::max(sd * sd - slow_sd * slow_sd, 0.01 * sd * sd)); }

// Satellites that come and go change the deviation that a receiver states, and its error. A small change leaves the error as it is, a great change
// begins another error. Small steps do not each begin an error, or many steps would count as many independent measurements.
void UseFixErrorModel(const ErrorModel& model, State& state) {
  const double ratio = model.sd / state.aiding.fix_error_begun_sd_m;
  if (model.kind != state.aiding.fix_error_model.kind || ratio < kSameErrorRatio || ratio * kSameErrorRatio > 1.0) {
    state.nominal.fix_error_m.setZero();
    state.aiding.fix_error_begun_sd_m = model.sd;
    ResetError<3>(kFixError, Eigen::Vector3d(model.sd, model.sd, model.up_factor * model.sd), state);
  }
  state.aiding.fix_error_model = model;
}

void UseHeadingErrorModel(const ErrorModel& model, State& state) {
  if (model.kind != state.aiding.heading_error_model.kind) {
    state.nominal.heading_error_rad = 0.0;
    state.aiding.heading_apart_rad = 0.0;
    ResetError<1>(kHeadingError, Eigen::Matrix<double, 1, 1>(model.sd), state);
  }
  state.aiding.heading_error_model = model;
}

// Hysteresis: while a heading error is of the current kind, its bound is larger, so that a value close to the bound does not toggle.
double Bound(double max_sd, bool is_of_kind) { return is_of_kind ? max_sd / kSameErrorRatio : max_sd; }

Eigen::Vector3d AntennaOf(const FixMeasurement& fix, const State& state) { return state.nominal.level->frame.Forward(fix.antenna); }

// Precondition, as of all that follows about places: there is a level frame.
Innovation<2> HorizontalOf(const FixMeasurement& fix, const FilterParams& params, const State& state) {
  const Eigen::Vector3d lever_level_m = LeverLevel(params, state);
  Innovation<2> innovation;
  innovation.residual = (AntennaOf(fix, state) - state.nominal.p_level_m - lever_level_m - state.nominal.fix_error_m).head<2>();
  innovation.jacobian.middleCols<2>(kPosition).setIdentity();
  innovation.jacobian.middleCols<2>(kFixError).setIdentity();
  if (state.aiding.has_heading) innovation.jacobian.middleCols<3>(kRotation) = -Cross(lever_level_m).topRows<2>();
  const double white_m = White(fix.horizontal_sd_m, state.aiding.fix_error_model.sd);
  innovation.noise.diagonal().setConstant(white_m * white_m);
  return innovation;
}

void ApplyHorizontal(const FixMeasurement& fix, const FilterParams& params, State& state, GateCounts& counts) {
  const bool is_accepted = state.aiding.has_position && !fix.begins_anew && Update(HorizontalOf(fix, params, state), false, state, counts);
  if (!is_accepted && state.aiding.has_position) {
    Eigen::Vector3d residual_m = Eigen::Vector3d::Zero();
    residual_m.head<2>() = HorizontalOf(fix, params, state).residual;
    const auto max_refusal = state.aiding.is_strapdown ? kMaxStrapdownRefusal : kMaxRefusal;
    // The state drifts meanwhile.
    const double sd_m = std::max(fix.horizontal_sd_m, std::sqrt(state.HorizontalVarianceM2()));
    const auto fault =
        AddRefusal(residual_m, sd_m, AgreesWithLast(fix, state), state.time, max_refusal, kMaxAgreeingRefusal, state.aiding.fix_refusals);
    state.aiding.fix_refusals.last_place = fix.antenna;
    if (!fix.begins_anew && !fault) return;
    ++counts.num_renewed;
    ForgetPlace(state);
    if (fault.is_led_away && state.aiding.is_strapdown) RefuseImu(params.tilt_sd_rad, state);
    if (fault) RefuseOdometry(state.aiding.lidar_led_way, state);
  }
  if (!is_accepted) {
    // The fix alone decides the place, and its velocity the velocity.
    const bool knew_velocity = state.aiding.timed_velocity.IsWithin(state.time, kTimedVelocityAge) && !state.aiding.fix_refusals.since;
    BeginLevel(fix.antenna, -(LeverLevel(params, state) + state.nominal.fix_error_m).head<2>(), state);
    ResetError<2>(kPosition, Eigen::Vector2d::Constant(kAnywhereM), state);
    Update(HorizontalOf(fix, params, state), true, state, counts);
    state.aiding.has_position = true;
    if (fix.velocity && !knew_velocity) {
      const Eigen::Vector3d velocity_here_mps(fix.velocity->east_north_mps.x(), fix.velocity->east_north_mps.y(), 0.0);
      state.nominal.velocity_level_mps.head<2>() = (HereOf(state).R_here_level.transpose() * velocity_here_mps).head<2>();
      ResetError<2>(kVelocity, Eigen::Vector2d::Constant(kAnySpeedMps), state);
    } else if (state.aiding.fix_refusals.since && !state.aiding.velocity.IsWithin(state.time, kTimedVelocityAge)) {
      // Fixes contradicted, and no velocity was measured: the velocity was wrong, or the next fix would contradict again.
      ResetError<2>(kVelocity, Eigen::Vector2d::Constant(kAnySpeedMps), state);
    }
  }
  state.aiding.fix_refusals = {};
  state.aiding.fix.Use(state.time);
  state.aiding.position_sd_at_fix_m = std::sqrt(state.HorizontalVarianceM2());
}

void ApplyHeight(const FixMeasurement& fix, const FilterParams& params, State& state, GateCounts& counts) {
  if (!fix.has_height) return;
  const double up_m = AntennaOf(fix, state).z() - LeverLevel(params, state).z() - state.nominal.fix_error_m.z();
  const bool is_first = !state.aiding.has_height;
  if (is_first) {
    // The boat and the water under it are somewhere together.
    state.nominal.water_level_m += up_m - state.nominal.p_level_m.z();
    state.nominal.p_level_m.z() = up_m;
    for (const int row : {kPositionUp, kWaterLevel}) {
      for (const int column : {kPositionUp, kWaterLevel}) {
        state.covariance(row, column) += kAnywhereM * kAnywhereM;
      }
    }
    state.aiding.has_height = true;
  }
  Innovation<1> innovation;
  innovation.residual[0] = up_m - state.nominal.p_level_m.z();
  innovation.jacobian(0, kPositionUp) = 1.0;
  innovation.jacobian(0, kFixErrorUp) = 1.0;
  innovation.jacobian.middleCols<3>(kRotation) = -Cross(LeverLevel(params, state)).row(2);
  const double white_m = White(fix.vertical_sd_m, state.aiding.fix_error_model.up_factor * state.aiding.fix_error_model.sd);
  innovation.noise(0, 0) = white_m * white_m;
  Update(innovation, is_first, state, counts);
}

// The innovation of a heading is shared by the attitude and the compass's slow error.
bool UpdateHeading(double heading_rad, double noise_rad, bool is_forced, State& state, GateCounts& counts) {
  const Here here = HereOf(state);
  const Eigen::Matrix3d R_here_vessel = here.R_here_level * state.nominal.R_level_vessel();
  Innovation<1> innovation;
  innovation.residual[0] = WrapToPi(heading_rad - state.nominal.heading_error_rad - AnglesOf(R_here_vessel)[2]);
  innovation.jacobian.middleCols<3>(kRotation) = AngleJacobian(R_here_vessel).row(2) * here.R_here_level;
  innovation.jacobian.middleCols<3>(kPosition) = here.heading_per_east_radpm * here.R_here_level.row(0);
  innovation.jacobian(0, kHeadingError) = 1.0;
  innovation.noise(0, 0) = noise_rad * noise_rad;
  return Update(innovation, is_forced, state, counts);
}

double HeadingOf(const State& state) { return AnglesOf(HereOf(state).R_here_level * state.nominal.R_level_vessel())[2]; }

// The heading becomes known.
void BeginHeading(double heading_rad, double noise_rad, HeadingSource source, const FilterParams& params, State& state, GateCounts& counts) {
  // While the heading is replaced the position is the antenna's, as before there was a heading.
  if (state.aiding.has_position && state.aiding.has_heading) ShiftPosition(LeverLevel(params, state), state);
  const double turned_rad = WrapToPi(heading_rad - state.nominal.heading_error_rad - HeadingOf(state));
  const bool was_measured = state.aiding.has_heading && state.aiding.heading_source != HeadingSource::kCourse;
  if (was_measured && source != HeadingSource::kCourse) state.aiding.heading_apart_rad -= turned_rad;
  TurnClockwise(turned_rad, state);
  ResetError<1>(kRotationUp, Eigen::Matrix<double, 1, 1>(kAnyHeadingRad), state);
  UpdateHeading(heading_rad, noise_rad, true, state, counts);
  state.aiding.has_heading = true;
  state.aiding.heading_source = source;
  if (state.aiding.has_position) ShiftPosition(-LeverLevel(params, state), state);
}

void ApplyHeading(double heading_rad, double sd_rad, const ErrorModel& model, double noise_rad, HeadingSource source, UseTimes& input,
                  const FilterParams& params, State& state, GateCounts& counts) {
  UseHeadingErrorModel(model, state);
  const bool is_other_kind = (state.aiding.heading_source == HeadingSource::kCourse) != (source == HeadingSource::kCourse);
  if (!state.aiding.has_heading || is_other_kind) {
    BeginHeading(heading_rad, noise_rad, source, params, state, counts);
  } else if (!UpdateHeading(heading_rad, noise_rad, false, state, counts)) {
    const double residual_rad = WrapToPi(heading_rad - HeadingOf(state));
    const auto max_agreeing = state.aiding.has_gyro && source != HeadingSource::kPashr ? kMaxCompassRefusal : kMaxAgreeingRefusal;
    if (!IsAttitudeGivenUp({0.0, 0.0, heading_rad}, {residual_rad, 0.0, 0.0}, sd_rad, max_agreeing, params, state.aiding.heading_refusals, state,
                           counts)) {
      return;
    }
    RefuseOdometry(state.aiding.lidar_led_turn, state);
    BeginHeading(heading_rad, noise_rad, source, params, state, counts);
  }
  state.aiding.heading_source = source;
  state.aiding.heading_refusals = {};
  input.Use(state.time);
}

// Noise of one of many samples whose errors have much in common.
double Thinned(double sd, double correlation_s, const UseTimes& input, Utime time) {
  if (!input.last) return sd;
  const double since_s = std::max(SecondsBetween(*input.last, time), correlation_s / 10.0);
  return sd * std::sqrt(std::max(correlation_s / since_s, 1.0));
}

void ApplyCourse(const VelocityMeasurement& velocity, const FilterParams& params, State& state, GateCounts& counts) {
  if (!params.use_course_as_heading || std::isnan(velocity.course_rad) || velocity.speed_mps < params.min_course_speed_mps) return;
  // Not beside a heading that was measured.
  if (state.aiding.has_heading && state.aiding.heading_source != HeadingSource::kCourse) return;
  const double slow_rad = kCompassSlowShare * params.course_heading_sd_rad;
  const ErrorModel model{ErrorKind::kCourse, slow_rad, 1.0, kHeadingErrorTimeS};
  ApplyHeading(velocity.course_rad, params.course_heading_sd_rad, model, White(params.course_heading_sd_rad, slow_rad), HeadingSource::kCourse,
               state.aiding.course, params, state, counts);
}

void ApplyCompass(const AttitudeValues& attitude, const FilterParams& params, State& state, GateCounts& counts) {
  if (std::isnan(attitude.heading_rad)) return;
  // Sensors of attitude say when they measured; a compass alone is late by an unknown time.
  if (!attitude.has_tilt() && state.aiding.attitude_heading.IsWithin(state.time, params.max_attitude_age)) return;
  const bool is_precise = attitude.heading_sd_rad <= Bound(kTwoAntennasMaxSdRad, state.aiding.heading_error_model.kind == ErrorKind::kTwoAntennas);
  const double slow_rad = (is_precise ? kTwoAntennasSlowShare : kCompassSlowShare) * attitude.heading_sd_rad;
  const ErrorModel model{is_precise ? ErrorKind::kTwoAntennas : ErrorKind::kCompass, slow_rad, 1.0, kHeadingErrorTimeS};
  const double noise_rad = Thinned(White(attitude.heading_sd_rad, slow_rad), kHeadingCorrelationS, state.aiding.sensor_heading, state.time);
  if (attitude.has_tilt()) state.aiding.attitude_heading.Use(state.time);
  ApplyHeading(attitude.heading_rad, attitude.heading_sd_rad, model, noise_rad, attitude.has_tilt() ? HeadingSource::kPashr : HeadingSource::kHdt,
               state.aiding.sensor_heading, params, state, counts);
}

Innovation<2> TiltOf(const AttitudeValues& attitude, const State& state) {
  const double roll_sd_rad = Thinned(attitude.roll_sd_rad, kTiltCorrelationS, state.aiding.tilt, state.time);
  const double pitch_sd_rad = Thinned(attitude.pitch_sd_rad, kTiltCorrelationS, state.aiding.tilt, state.time);
  const Here here = HereOf(state);
  const Eigen::Matrix3d R_here_vessel = here.R_here_level * state.nominal.R_level_vessel();
  const Eigen::Vector3d angles_rad = AnglesOf(R_here_vessel);
  Innovation<2> innovation;
  innovation.residual = {WrapToPi(attitude.roll_rad - angles_rad[0]), WrapToPi(attitude.pitch_rad - angles_rad[1])};
  innovation.jacobian.middleCols<3>(kRotation) = AngleJacobian(R_here_vessel).topRows<2>() * here.R_here_level;
  innovation.noise.diagonal() = Eigen::Vector2d(roll_sd_rad * roll_sd_rad, pitch_sd_rad * pitch_sd_rad);
  return innovation;
}

void ApplyTilt(const AttitudeValues& attitude, const FilterParams& params, State& state, GateCounts& counts) {
  if (!attitude.has_tilt()) return;
  const bool is_accepted = state.aiding.has_tilt && Update(TiltOf(attitude, state), false, state, counts);
  if (!is_accepted && state.aiding.has_tilt) {
    Eigen::Vector3d residual_rad = Eigen::Vector3d::Zero();
    residual_rad.head<2>() = TiltOf(attitude, state).residual;
    if (!IsAttitudeGivenUp({attitude.roll_rad, attitude.pitch_rad, 0.0}, residual_rad, attitude.roll_sd_rad + attitude.pitch_sd_rad,
                           kMaxAgreeingRefusal, params, state.aiding.tilt_refusals, state, counts)) {
      return;
    }
  }
  if (!is_accepted) {
    const Eigen::Vector3d lever_level_m = LeverLevel(params, state);
    const Eigen::Quaterniond q_level_vessel =
        RotationBy(Eigen::Vector3d(0.0, -attitude.pitch_rad, 0.0)) * RotationBy(Eigen::Vector3d(attitude.roll_rad, 0.0, 0.0));
    BeginTilt(q_level_vessel, kAnyTiltRad, state);
    Update(TiltOf(attitude, state), true, state, counts);
    if (state.aiding.has_position) state.nominal.p_level_m += lever_level_m - LeverLevel(params, state);
  }
  state.aiding.tilt_refusals = {};
  state.aiding.tilt.Use(state.time);
}

// How much higher the origin lies than if the boat were level.
double SwingUp(const FilterParams& params, const State& state) {
  return (state.nominal.q_level_vessel * params.p_vessel_imu_m).z() - params.p_vessel_imu_m.z();
}

void ApplyHeave(const AttitudeValues& attitude, const FilterParams& params, State& state, GateCounts& counts) {
  if (std::isnan(attitude.heave_m)) return;
  Innovation<1> innovation;
  innovation.residual[0] = attitude.heave_m + SwingUp(params, state) - (state.nominal.p_level_m.z() - state.nominal.water_level_m);
  innovation.jacobian(0, kPositionUp) = 1.0;
  innovation.jacobian(0, kWaterLevel) = -1.0;
  const double noise_m = Thinned(kHeaveSdM, kTiltCorrelationS, state.aiding.heave, state.time);
  innovation.noise(0, 0) = noise_m * noise_m;
  const bool is_first = !state.aiding.heave.IsWithin(state.time, params.max_attitude_age);
  if (Update(innovation, is_first, state, counts)) state.aiding.heave.Use(state.time);
}

}  // namespace

void Apply(const FixMeasurement& fix, const FilterParams& params, State& state, GateCounts& counts) {
  const bool is_rtk = fix.horizontal_sd_m <= Bound(kRtkMaxSdM, state.aiding.fix_error_model.kind == ErrorKind::kRtk);
  const double slow_m = (is_rtk ? kRtkSlowShare : kGnssSlowShare) * fix.horizontal_sd_m;
  UseFixErrorModel({is_rtk ? ErrorKind::kRtk : ErrorKind::kGnss, slow_m, fix.vertical_sd_m / fix.horizontal_sd_m, kFixErrorTimeS}, state);
  ApplyHorizontal(fix, params, state, counts);
  if (!state.aiding.has_position) return;
  ApplyHeight(fix, params, state, counts);
  if (fix.velocity) Apply(*fix.velocity, params, state, counts);
}

void Apply(const VelocityMeasurement& velocity, const FilterParams& params, State& state, GateCounts& counts) {
  if (!velocity.has_own_time && state.aiding.timed_velocity.IsWithin(state.time, kTimedVelocityAge)) return;
  const Eigen::Matrix3d R_level_vessel = state.nominal.R_level_vessel();
  const Eigen::Vector3d lever_m = AntennaLever(params);
  Innovation<2> innovation;
  const Here here = HereOf(state);
  const Eigen::Vector3d velocity_here_mps = here.R_here_level * state.nominal.velocity_level_mps;
  innovation.residual = velocity.east_north_mps - velocity_here_mps.head<2>();
  innovation.jacobian.middleCols<3>(kVelocity) = here.R_here_level.topRows<2>();
  innovation.jacobian.middleCols<3>(kPosition) =
      here.heading_per_east_radpm * Eigen::Vector2d(velocity_here_mps.y(), -velocity_here_mps.x()) * here.R_here_level.row(0);
  const bool is_rtk = state.aiding.fix_error_model.kind == ErrorKind::kRtk;
  double noise_mps = is_rtk ? velocity.sd_mps : Thinned(velocity.sd_mps, kVelocityCorrelationS, state.aiding.velocity, state.time);
  if (!velocity.has_own_time) noise_mps = Hypot(noise_mps, kLateVelocitySdMps);
  if (state.aiding.has_heading) {
    const Eigen::Vector3d swing_level_mps = R_level_vessel * state.nominal.angular_velocity_radps.cross(lever_m);
    innovation.residual -= (here.R_here_level * swing_level_mps).head<2>();
    innovation.jacobian.middleCols<3>(kRotation) = -(here.R_here_level * Cross(swing_level_mps)).topRows<2>();
    innovation.jacobian.middleCols<3>(kRate) =
        (state.aiding.has_gyro ? 1.0 : -1.0) * (here.R_here_level * R_level_vessel * Cross(lever_m)).topRows<2>();
  } else {
    noise_mps = Hypot(noise_mps, kUnknownTurnRadps * lever_m.norm());
  }
  innovation.noise.diagonal().setConstant(noise_mps * noise_mps);
  if (Update(innovation, false, state, counts)) {
    state.aiding.velocity.Use(state.time);
    if (velocity.has_own_time) state.aiding.timed_velocity.Use(state.time);
  }
  ApplyCourse(velocity, params, state, counts);
}

void Apply(const AttitudeValues& attitude, const FilterParams& params, State& state, GateCounts& counts) {
  ApplyTilt(attitude, params, state, counts);
  ApplyCompass(attitude, params, state, counts);
  ApplyHeave(attitude, params, state, counts);
}

void Apply(const ImuSample& sample, const FilterParams& /*params*/, State& state, GateCounts& /*counts*/) {
  const Earth earth = EarthOf(state);
  const double since_s = state.aiding.imu.last ? SecondsBetween(*state.aiding.imu.last, state.time) : 0.0;
  const bool is_first = !state.aiding.imu.last || since_s > kCalmMeanTimeS;
  state.aiding.imu.Use(state.time);
  if (IsImuRefused(state)) return;
  const Eigen::Vector3d& force_mps2 = sample.specific_force_mps2;
  if (is_first) {
    state.aiding.mean_force_mps2 = force_mps2;
    state.aiding.force_variance_mps2_2 = 1.0;
  }
  const double share = 1.0 - Exp(-since_s / kCalmMeanTimeS);
  const Eigen::Vector3d deviation_mps2 = force_mps2 - state.aiding.mean_force_mps2;
  state.aiding.mean_force_mps2 += share * deviation_mps2;
  state.aiding.force_variance_mps2_2 += share * (deviation_mps2.squaredNorm() / 3.0 - state.aiding.force_variance_mps2_2);
  // The first sample gives the direction of gravity, unless the boat moves with more than half a g.
  if (!state.aiding.has_tilt && std::abs(force_mps2.norm() - earth.gravity_mps2) < earth.gravity_mps2 / 2.0) {
    BeginTilt(Eigen::Quaterniond::FromTwoVectors(force_mps2, Eigen::Vector3d::UnitZ()), kForceSdMps2 / earth.gravity_mps2, state);
  }
  if (state.aiding.is_strapdown || !state.aiding.has_tilt) return BeginMeanForce(state);
  state.aiding.force_sum_mps2 += force_mps2;
  ++state.aiding.num_forces;
  if (since_s * state.aiding.num_forces < kLevelPeriodS) return;
  const Eigen::Vector3d up_vessel_mps2 = state.nominal.q_level_vessel.conjugate() * Eigen::Vector3d(0.0, 0.0, earth.gravity_mps2);
  Innovation<3> innovation;
  innovation.residual = state.aiding.force_sum_mps2 / state.aiding.num_forces - up_vessel_mps2;
  innovation.jacobian.middleCols<3>(kRotation) = state.nominal.R_level_vessel().transpose() * Cross(Eigen::Vector3d(0.0, 0.0, earth.gravity_mps2));
  const bool is_calm = state.aiding.force_variance_mps2_2 < kCalmMaxVariance && state.nominal.angular_velocity_radps.norm() < kCalmMaxRateRadps;
  const double sd_mps2 = is_calm ? kCalmForceSdMps2 : kForceSdMps2;
  innovation.noise.diagonal().setConstant(2.0 * sd_mps2 * sd_mps2 * kForceTimeS / kLevelPeriodS);
  Correct(innovation, false, state);
  BeginMeanForce(state);
}

void Apply(const Tick& /*tick*/, const FilterParams& /*params*/, State& state, GateCounts& /*counts*/) {
  if (state.aiding.last_water_aid && state.time - *state.aiding.last_water_aid < kWaterPeriod) return;
  state.aiding.last_water_aid = state.time;
  Innovation<2> innovation;
  innovation.residual = {state.nominal.water_level_m - state.nominal.p_level_m.z(), -state.nominal.velocity_level_mps.z()};
  innovation.jacobian(0, kPositionUp) = 1.0;
  innovation.jacobian(0, kWaterLevel) = -1.0;
  innovation.jacobian(1, kVelocityUp) = 1.0;
  innovation.noise.diagonal() = Eigen::Vector2d(kFloatingSdM * kFloatingSdM, kFloatingSdMps * kFloatingSdMps);
  Correct(innovation, false, state);
}

}  // namespace lookout::navigator::filter
