// One measurement at a time on a state that is given: how strongly it counts, and when refused measurements win.
#include "services/navigator/core/filter/aiding.hpp"

#include <gtest/gtest.h>

#include "tests/unit/navigator/filter_measurements.hpp"

namespace lookout::navigator::filter {
namespace {

const GeodeticPlace kPlace{kLatitudeDeg, kLongitudeDeg};

/// At rest at kPlace, level, heading north. Nothing is uncertain but what a test makes so.
State StateAtRest(bool is_strapdown = false) {
  State state = FreshState(NoonPlus(0.0), DegToRad(5.0));
  BeginLevel(kPlace, Eigen::Vector2d::Zero(), state);
  state.covariance.setZero();
  state.aiding.has_position = state.aiding.has_height = state.aiding.has_heading = state.aiding.has_tilt = true;
  state.aiding.has_gyro = state.aiding.is_strapdown = is_strapdown;
  return state;
}

FixMeasurement FixAt(double north_m, double sd_m) {
  FixMeasurement fix;
  fix.antenna = LocalFrame(kPlace).Reverse({0.0, north_m, 0.0});
  fix.horizontal_sd_m = fix.vertical_sd_m = sd_m;
  return fix;
}

/// Fixes ten times a second, each at the place that `north_m` gives for its number.
/// @return after how many seconds the state was given up for them; nullopt: within 20 s it was not
template <typename NorthM>
std::optional<double> GivenUpAfterS(State& state, double sd_m, const NorthM& north_m) {
  GateCounts counts;
  for (int i = 0; i < 200; ++i) {
    state.time = NoonPlus(0.1 * i);
    Apply(FixAt(north_m(i), sd_m), TestFilterParams(), state, counts);
    if (counts.num_renewed > 0) return 0.1 * i;
  }
  return std::nullopt;
}

// 5 standard deviations bound what counts as the same contradiction.
TEST(Aiding, AContradictionThatStaysTheSameWinsAfterThreeSeconds) {
  constexpr double kSdM = 20.0;
  for (const auto& [jump_in_sds, given_up_after_s] :
       {std::pair{0.0, std::optional(3.0)}, {4.5, std::optional(3.0)}, {7.3, std::optional<double>()}}) {
    auto state = StateAtRest();
    // 7.3 standard deviations in 0.1 s are more than a boat moves, too: such fixes do not agree with each other.
    const auto after_s = GivenUpAfterS(state, kSdM, [&](int i) { return 10'000.0 + (i % 2) * jump_in_sds * kSdM; });
    ASSERT_EQ(after_s.has_value(), given_up_after_s.has_value()) << jump_in_sds;
    EXPECT_NEAR(after_s.value_or(0.0), given_up_after_s.value_or(0.0), 0.11) << jump_in_sds;
  }
}

// A boat does 30 m/s at most. Fixes that walk away from the state no faster agree with each other, and the IMU led away.
TEST(Aiding, FixesWithoutVelocityThatAgreeWithEachOtherWinOverTheImu) {
  for (const auto& [speed_mps, is_led_away] : {std::pair{10.0, true}, {29.0, true}, {32.0, false}}) {
    auto state = StateAtRest(true);
    const auto after_s = GivenUpAfterS(state, 0.02, [&, speed = speed_mps](int i) { return 100.0 + 0.1 * speed * i; });
    EXPECT_EQ(after_s.has_value(), is_led_away) << speed_mps << " m/s";
    EXPECT_EQ(IsImuRefused(state), is_led_away) << speed_mps << " m/s";
  }
}

// The same to the last digit is a receiver that hangs.
TEST(Aiding, FrozenFixesDoNotWinOverTheImuForTenSeconds) {
  auto state = StateAtRest(true);
  const auto after_s = GivenUpAfterS(state, 0.02, [](int) { return 100.0; });
  ASSERT_TRUE(after_s);
  EXPECT_NEAR(*after_s, 10.0, 0.11);
  EXPECT_FALSE(IsImuRefused(state)) << "it is the receiver's fault, or nobody's";
}

// Half a metre and half a metre a second.
TEST(Aiding, TheWaterHoldsTheBoatUpOnceASecond) {
  auto state = StateAtRest();
  GateCounts counts;
  const auto set = [&state] {
    state.nominal.p_level_m.z() = 1.0;
    state.nominal.velocity_level_mps.z() = -2.0;
    ResetError<1>(kPositionUp, Eigen::Matrix<double, 1, 1>(1.0), state);
    ResetError<1>(kVelocityUp, Eigen::Matrix<double, 1, 1>(0.5), state);
  };
  set();
  Apply(Tick{}, TestFilterParams(), state, counts);
  EXPECT_NEAR(state.nominal.p_level_m.z(), 0.2, 1e-9) << "variances 1 and 0.25 m2";
  EXPECT_NEAR(state.covariance(kPositionUp, kPositionUp), 0.2, 1e-9);
  EXPECT_NEAR(state.nominal.velocity_level_mps.z(), -1.0, 1e-9) << "variances 0.25 and 0.25 m2/s2";
  EXPECT_NEAR(state.covariance(kVelocityUp, kVelocityUp), 0.125, 1e-9);
  EXPECT_NEAR(state.nominal.water_level_m, 0.0, 1e-12) << "it is known";
  set();
  state.time = NoonPlus(0.99);
  Apply(Tick{}, TestFilterParams(), state, counts);
  EXPECT_EQ(state.nominal.p_level_m.z(), 1.0) << "not within a second";
  state.time = NoonPlus(1.0);
  Apply(Tick{}, TestFilterParams(), state, counts);
  EXPECT_NEAR(state.nominal.p_level_m.z(), 0.2, 1e-9);
}

// Gravity levels the attitude: of a calm IMU (root mean square below 0.05 m/s2 of each axis) 25 times as strongly as of one that moves.
TEST(Aiding, GravityCountsMoreWhileTheImuIsCalm) {
  const auto tilt_variance_after = [](double shake_mps2, double rate_radps) {
    auto state = StateAtRest();
    state.nominal.angular_velocity_radps.z() = rate_radps;
    GateCounts counts;
    for (int i = 0; i <= 3000; ++i) {
      state.time = NoonPlus(0.01 * i);
      auto sample = RestSample(0.01 * i);
      sample.specific_force_mps2.x() += i % 2 == 0 ? shake_mps2 : -shake_mps2;
      if (i == 2995) ResetError<2>(kRotation, Eigen::Vector2d::Constant(DegToRad(5.0)), state);  // one levelling comes after it
      Apply(sample, TestFilterParams(), state, counts);
    }
    return state.covariance(kRotation, kRotation);
  };
  const auto variance_with = [](double sd_mps2) {
    const double before = DegToRad(5.0) * DegToRad(5.0);
    const double noise = 2.0 * sd_mps2 * sd_mps2 * 2.0 / 0.1 / (9.80474 * 9.80474);
    return before * noise / (before + noise);
  };
  const double calm = variance_with(0.1);
  const double moved = variance_with(0.5);
  EXPECT_NEAR(tilt_variance_after(0.0, 0.0), calm, 0.02 * calm);
  EXPECT_NEAR(tilt_variance_after(0.08, 0.0), calm, 0.02 * calm) << "0.046 m/s2";
  EXPECT_NEAR(tilt_variance_after(0.1, 0.0), moved, 0.02 * moved) << "0.058 m/s2";
  EXPECT_NEAR(tilt_variance_after(0.0, DegToRad(1.9)), calm, 0.02 * calm);
  EXPECT_NEAR(tilt_variance_after(0.0, DegToRad(2.1)), moved, 0.02 * moved);
}

// Accuracy of heave: 5 cm, and two samples within half a second count as one.
TEST(Aiding, HeaveHoldsTheHeightOverTheWater) {
  auto state = StateAtRest();
  GateCounts counts;
  AttitudeValues attitude;
  attitude.heave_m = 0.3;
  ResetError<1>(kPositionUp, Eigen::Matrix<double, 1, 1>(0.05), state);
  Apply(attitude, TestFilterParams(), state, counts);
  EXPECT_NEAR(state.nominal.p_level_m.z(), 0.15, 1e-9);
  ResetError<1>(kPositionUp, Eigen::Matrix<double, 1, 1>(0.05), state);
  state.time = NoonPlus(0.1);
  Apply(attitude, TestFilterParams(), state, counts);
  EXPECT_NEAR(state.nominal.p_level_m.z(), 0.15 + 0.15 / 6.0, 1e-9) << "a tenth of a second later with five times the variance";
}

// A receiver's stated deviation hovers: up to the ratio 0.6 it is the same slow error, beyond it begins anew.
TEST(Aiding, AFixErrorBeginsAnewWhereItsDeviationChangesMuch) {
  for (const auto& [second_sd_m, is_new] : {std::pair{1.25, false}, {1.15, true}, {3.2, false}, {3.5, true}}) {
    auto state = StateAtRest();
    GateCounts counts;
    Apply(FixAt(0.0, 2.0), TestFilterParams(), state, counts);
    state.nominal.fix_error_m = {0.3, 0.0, 0.0};
    ResetError<3>(kFixError, Eigen::Vector3d::Constant(1e-6), state);
    Apply(FixAt(0.0, second_sd_m), TestFilterParams(), state, counts);
    EXPECT_EQ(state.covariance(kFixErrorUp, kFixErrorUp) > 0.1, is_new) << second_sd_m;
  }
}

}  // namespace
}  // namespace lookout::navigator::filter
