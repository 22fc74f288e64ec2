// How far the lidar's own motions are believed.
#include "services/navigator/core/filter/motion_trial.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "common/core/angles.hpp"
#include "services/navigator/core/filter/state.hpp"
#include "tests/unit/navigator/odometry_run.hpp"

namespace lookout::navigator {
namespace {

// A barge that goes with the boat, or a bank in steep waves: motions that a receiver contradicts by less than the gate, and all the same way. When it
// stops, the place is stated as badly as it is known.
TEST(LidarAid, IsBelievedAsFarAsItWasRightBefore) {
  OdometryRun run;
  run.boat.speed_mps = 1.0;
  run.end_s = 40.0;
  run.gap_begin_s = 30.0;
  run.spoil = [](double t, OdometryMotion& motion) {
    if (t > 5.0) motion.displacement_m *= 0.6;
  };
  const auto astray = run.Sail();
  run.spoil = [](double /*t*/, OdometryMotion& /*motion*/) {};
  const auto right = run.Sail();
  EXPECT_GT(astray.ErrorM(39.9).norm(), 2.0);
  EXPECT_LT(right.ErrorM(39.9).norm(), 0.2);
  EXPECT_LT(SdM(right.At(39.9)), 0.7);
  EXPECT_GT(SdM(astray.At(39.9)), 2.0 * SdM(right.At(39.9)));
}

// A motion that the gate refuses says nothing of the others.
TEST(LidarAid, OneWildMotionDoesNotSpoilTheOthers) {
  OdometryRun run;
  run.end_s = 60.0;
  run.gap_begin_s = 30.0;
  const auto right = run.Sail();
  run.spoil = [](double t, OdometryMotion& motion) {
    if (t > 24.95 && t < 25.05) motion.displacement_m.x() += 10.0;
  };
  const auto wild = run.Sail();
  ASSERT_EQ(wild.At(59.9).status, PoseStatus::kCoasting);
  EXPECT_LT(SdM(wild.At(59.9)), 1.05 * SdM(right.At(59.9)));
}

// The same of the turn, beside two antennas: the heading stays theirs.
TEST(LidarAid, ATurnThatDriftsDoesNotLeadTheHeadingAway) {
  OdometryRun run;
  run.gap_begin_s = run.gap_end_s = 100.0;
  run.end_s = 60.0;
  run.params.heading_sd_rad = DegToRad(0.2);
  run.spoil = [](double /*t*/, OdometryMotion& motion) { motion.turn_rad += DegToRad(0.05); };
  const auto result = run.Sail();
  for (double t = 30.0; t <= 60.0; t += kScanS) EXPECT_LT(std::abs(RadToDeg(result.HeadingErrorRad(t))), 0.2) << t;
}

// A boat that keeps its heading beside a sensor of headings with a slow error, and motions whose turns drift.
double TurnFactor(const filter::ErrorModel& sensor, double drift_rad, unsigned seed) {
  constexpr int kScans = 600;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto params = TestFilterParams();
  filter::MotionTrial trial;
  const Eigen::Matrix3d noise = Eigen::Vector3d(kWaySdM, kWaySdM, kTurnSdRad).cwiseAbs2().asDiagonal();
  double error_rad = sensor.sd * normal(random);
  for (int i = 1; i <= kScans; ++i) {
    const double kept = std::exp(-kScanS / sensor.time_constant_s);
    error_rad = kept * error_rad + std::sqrt(1.0 - kept * kept) * sensor.sd * normal(random);
    auto state = filter::FreshState(NoonPlus(i * kScanS), DegToRad(1.0));
    state.nominal.q_level_vessel = filter::RotationBy({0.0, 0.0, DegToRad(90.0) - error_rad});
    state.covariance(filter::kRotationUp, filter::kRotationUp) = sensor.sd * sensor.sd;
    state.aiding.heading_error_model = sensor;
    OdometryMotion motion{NoonPlus((i - 1) * kScanS), NoonPlus(i * kScanS), true};
    motion.turn_rad = drift_rad + kTurnSdRad * normal(random);
    trial.Add(motion, noise, false, true, params, state);
  }
  EXPECT_EQ(trial.way_factor(), 1.0) << "nothing measures it";
  return trial.turn_factor();
}

// A poor compass says little of a good lidar: that is no reason to believe the lidar less.
TEST(MotionTrial, ARightTurnStaysBelievedBesideAPoorCompass) {
  constexpr int kRuns = 20;
  double mean = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    mean += TurnFactor({filter::ErrorKind::kCompass, DegToRad(2.0), 1.0, 30.0}, 0.0, seed) / kRuns;
  }
  EXPECT_LT(mean, 1.3);
}

// 0.2 deg a scan are 6 deg in a window, where the motions state 0.11 deg: 55 times as much.
TEST(MotionTrial, ATurnThatDriftsIsFoundBesideTwoAntennas) {
  const double factor = TurnFactor({filter::ErrorKind::kTwoAntennas, DegToRad(0.1), 1.0, 30.0}, DegToRad(0.2), 1);
  EXPECT_GT(factor, 5.0);
  EXPECT_LE(factor, 11.0) << "one window counts for a hundred times the variance at most";
}

}  // namespace
}  // namespace lookout::navigator
