// The measurement models of gravity and of the water.
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/navigator/core/filter/aiding.hpp"
#include "services/navigator/core/filter/kalman.hpp"

namespace lookout::navigator::filter {

namespace {

using namespace std::chrono_literals;

// Accelerations of a boat that cannot be distinguished from gravity: 0.5 m/s2 for 2 s, a wave's (motion.cpp). What is left of them when the IMU is
// calm.
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

}  // namespace

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
