// Own motion by the lidar as an aid of the filter on the earth.
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "common/core/angles.hpp"
#include "services/navigator/core/filter/pose_filter.hpp"
#include "tests/unit/navigator/odometry_run.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

TEST(LidarAid, CarriesPlaceAndHeadingThroughAMinuteInATurn) {
  OdometryRun run;
  run.boat.turn_radps = DegToRad(6.0);
  const auto result = run.Sail();
  const auto& pose = result.At(69.9);
  EXPECT_EQ(pose.status, PoseStatus::kCoasting);
  EXPECT_TRUE(result.was_carried);
  EXPECT_LT(result.ErrorM(69.9).norm(), 0.3);
  EXPECT_LT(std::abs(RadToDeg(result.HeadingErrorRad(69.9))), 0.3);
  EXPECT_GT(SdM(pose), 0.1) << "nothing but the lidar says where the boat is";
  EXPECT_LT(SdM(pose), 2.0);
  EXPECT_LT(std::sqrt(pose.covariance(8, 8)), DegToRad(2.0));
  run.has_odometry = false;
  EXPECT_EQ(run.Sail().At(69.9).status, PoseStatus::kUnknown);
}

TEST(LidarAid, CarriesOnAlongAStraightWayFartherThanTheLevelFrame) {
  OdometryRun run;
  run.boat.speed_mps = 5.0;
  run.params.heading_sd_rad = DegToRad(0.2);  // over 300 m a degree would be 5 m
  run.params.p_vessel_imu_m = {-1.0, 0.3, 0.2};
  run.params.p_vessel_antenna_m = Eigen::Vector3d::Zero();
  const auto result = run.Sail();
  EXPECT_EQ(result.At(69.9).status, PoseStatus::kCoasting);
  EXPECT_LT(result.ErrorM(69.9).norm(), 0.5);
  EXPECT_LT(std::abs(RadToDeg(result.HeadingErrorRad(69.9))), 0.3);
}

// A receiver alone, whose course swings by 12 deg with the waves.
TEST(LidarAid, KeepsAHeadingThatTheCourseStandsInFor) {
  OdometryRun run;
  run.has_compass = false;
  run.fix_sd_m = 1.5;
  run.boat.turn_radps = DegToRad(6.0);
  run.course_error_rad = [](double t) { return DegToRad(12.0) * std::sin(kTwoPi * t / 4.0); };
  run.gap_begin_s = run.gap_end_s = run.end_s = 60.0;
  const auto rms_deg = [](const OdometryRun::Result& result) {
    double squares = 0.0;
    int num = 0;
    for (double t = 20.0; t < 60.0; t += kScanS, ++num) squares += std::pow(RadToDeg(result.HeadingErrorRad(t)), 2);
    return std::sqrt(squares / num);
  };
  const auto with_deg = rms_deg(run.Sail());
  run.has_odometry = false;
  const auto without_deg = rms_deg(run.Sail());
  EXPECT_LT(with_deg, 3.0);
  EXPECT_GT(without_deg, 2.0 * with_deg);
}

TEST(LidarAid, AFixThatComesBackIsAcceptedWithoutAJump) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const double fix_sd_m : {0.02, 1.5}) {
    OdometryRun run;
    run.boat.turn_radps = DegToRad(-3.0);
    run.fix_sd_m = fix_sd_m;
    run.spoil = [&](double /*t*/, OdometryMotion& motion) {
      motion.displacement_m += kWaySdM * Eigen::Vector2d(normal(random), normal(random));
      motion.turn_rad += kTurnSdRad * normal(random);
    };
    const auto result = run.Sail();
    auto counts = result.counts;
    EXPECT_EQ(counts["gated_fix"], 0);
    EXPECT_EQ(counts["gated_attitude"], 0);
    EXPECT_EQ(counts["renewed_position"], 0);
    EXPECT_EQ(result.At(71.0).status, PoseStatus::kOk);
    const double back_m = (result.ErrorM(70.0) - result.ErrorM(69.9)).norm();
    EXPECT_LT(back_m, 3.0 * std::hypot(SdM(result.At(69.9)), std::sqrt(result.At(69.9).covariance(1, 1))));
    EXPECT_LT(result.ErrorM(75.0).norm(), 0.5);
  }
}

// Increments are independent: the deviation grows with the root of their number, as the error does.
TEST(LidarAid, StatesWhatTheErrorsOfTheMotionsAddUpTo) {
  double nees = 0.0;
  double heading_nees = 0.0;
  constexpr int kRuns = 40;
  for (int seed = 1; seed <= kRuns; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    OdometryRun run;
    run.end_s = 40.0;
    run.boat.turn_radps = DegToRad(2.0);
    run.spoil = [&](double /*t*/, OdometryMotion& motion) {
      // As the filter takes them at the least.
      motion.displacement_m += std::hypot(0.03, 0.02 * motion.displacement_m.norm()) * Eigen::Vector2d(normal(random), normal(random));
      motion.turn_rad += std::hypot(kTurnSdRad, 0.01 * motion.turn_rad) * normal(random);
    };
    const auto result = run.Sail();
    const auto& pose = result.At(39.9);
    const Eigen::Matrix2d covariance_m2 = pose.covariance.topLeftCorner<2, 2>();
    nees += result.ErrorM(39.9).dot(covariance_m2.inverse() * result.ErrorM(39.9)) / 2.0 / kRuns;
    heading_nees += std::pow(result.HeadingErrorRad(39.9), 2) / pose.covariance(8, 8) / kRuns;
  }
  EXPECT_GT(nees, 0.3);
  EXPECT_LT(nees, 1.4);
  EXPECT_GT(heading_nees, 0.3);
  EXPECT_LT(heading_nees, 1.6);
}

TEST(LidarAid, AWrongMotionIsGatedAndTold) {
  OdometryRun run;
  run.gap_begin_s = run.gap_end_s = 100.0;  // no gap
  run.end_s = 30.0;
  // As if a ship that goes with the boat were the shore.
  run.spoil = [](double t, OdometryMotion& motion) {
    if (t > 10.0) motion.displacement_m.setZero();
  };
  const auto result = run.Sail();
  auto counts = result.counts;
  EXPECT_GT(counts["gated_odometry"], 100);
  EXPECT_TRUE(result.contradicted);
  for (double t = 5.0; t <= 30.0; t += kScanS) {
    EXPECT_LT(result.ErrorM(t).norm(), 0.3) << t;
    EXPECT_LT(std::abs(RadToDeg(result.HeadingErrorRad(t))), 1.0) << t;
  }
  EXPECT_EQ(counts["renewed_position"], 0);
}

// Errors that the gate lets pass: fixes and their velocities hold the boat.
TEST(LidarAid, ALittleWrongMotionDoesNotLeadAwayFromFixes) {
  for (const double share : {0.9, 0.7, 0.5}) {
    OdometryRun run;
    run.gap_begin_s = run.gap_end_s = 100.0;
    run.end_s = 60.0;
    run.spoil = [share](double t, OdometryMotion& motion) {
      if (t > 10.0) motion.displacement_m *= share;
    };
    const auto result = run.Sail();
    double greatest_m = 0.0;
    for (double t = 5.0; t <= 60.0; t += kScanS) greatest_m = std::max(greatest_m, result.ErrorM(t).norm());
    auto counts = result.counts;
    EXPECT_LT(greatest_m, 0.3) << share;
    EXPECT_EQ(counts["renewed_position"], 0) << share;
  }
}

// A ship of 60 m that gathers way beside a boat that lies still looks like a shore. It drew POSE 50 m away from an ordinary receiver, as its slow
// error is not known.
TEST(LidarAid, AShipThatLeavesDoesNotDrawThePlaceAwayFromAnOrdinaryReceiver) {
  const auto greatest_m = [](bool has_odometry) {
    OdometryRun run;
    run.boat.speed_mps = 0.0;
    run.fix_sd_m = 1.5;
    run.gap_begin_s = run.gap_end_s = 1000.0;
    run.end_s = 300.0;
    run.has_odometry = has_odometry;
    run.spoil = [](double t, OdometryMotion& motion) {
      if (t > 60.0 && t < 240.0) motion.displacement_m.x() -= kScanS * std::min(1.0, (t - 60.0) / 10.0);
    };
    const auto result = run.Sail();
    double most_m = 0.0;
    for (double t = 5.0; t <= run.end_s; t += kScanS) most_m = std::max(most_m, result.ErrorM(t).norm());
    return most_m;
  };
  EXPECT_LT(greatest_m(true), greatest_m(false) + 0.1);
}

// The same where fixes have ended: the stated deviation does not hold such an error, so the lidar carries the place for two minutes at most.
TEST(LidarAid, CarriesThePlaceForTwoMinutesAtMost) {
  OdometryRun run;
  run.gap_end_s = 400.0;
  run.end_s = 150.0;
  run.boat.speed_mps = 0.0;
  const auto result = run.Sail();
  EXPECT_EQ(result.At(120.0).status, PoseStatus::kCoasting);
  EXPECT_NE(result.At(140.0).status, PoseStatus::kCoasting);
}

// One wrong motion, then open water, in which none is known: nothing contradicts any more.
TEST(LidarAid, AContradictionEndsWithTheMotions) {
  OdometryRun run;
  run.gap_begin_s = run.gap_end_s = 100.0;
  run.end_s = 60.0;
  run.spoil = [](double t, OdometryMotion& motion) {
    motion.is_known = t < 20.05;
    if (t > 19.95) motion.displacement_m.setConstant(3.0);
  };
  const auto result = run.Sail();
  auto counts = result.counts;
  EXPECT_EQ(counts["gated_odometry"], 1);
  EXPECT_FALSE(result.contradicted);
}

TEST(LidarAid, ATurnThatTheCompassContradictsIsGated) {
  OdometryRun run;
  run.gap_begin_s = run.gap_end_s = 100.0;
  run.end_s = 30.0;
  run.spoil = [](double t, OdometryMotion& motion) {
    if (t > 10.0) motion.turn_rad += DegToRad(3.0);
  };
  const auto result = run.Sail();
  auto counts = result.counts;
  EXPECT_GT(counts["gated_odometry"], 100);
  EXPECT_EQ(counts["renewed_attitude"], 0);
  EXPECT_LT(std::abs(RadToDeg(result.HeadingErrorRad(30.0))), 1.0);
}

TEST(LidarAid, AnUnknownMotionChangesNothing) {
  OdometryRun run;
  run.gap_end_s = 40.0;
  run.end_s = 45.0;
  run.spoil = [](double t, OdometryMotion& motion) { motion.is_known = t < 10.0; };
  const auto unknown = run.Sail();
  run.has_odometry = false;
  const auto without = run.Sail();
  for (const double t : {12.0, 14.0, 30.0, 45.0}) EXPECT_EQ(unknown.At(t).status, without.At(t).status) << t;
}

// A motion counts from the end of the scan before alone: where that scan is missing, nothing is known of the place at its begin.
TEST(LidarAid, AMotionWithoutTheOneBeforeItIsNotUsed) {
  OdometryRun run;
  run.spoil = [](double /*t*/, OdometryMotion& motion) { motion.begin += 1ms; };
  const auto result = run.Sail();
  EXPECT_FALSE(result.was_carried);
  EXPECT_EQ(result.At(69.9).status, PoseStatus::kUnknown);
}

TEST(LidarAid, OrderOfArrivalDoesNotMatter) {
  const ArcBoat boat{2.0, DegToRad(5.0)};
  PoseFilter in_time(TestFilterParams());
  PoseFilter late(TestFilterParams());
  for (int i = 0; i <= 30; ++i) {
    const double t = i * kScanS;
    if (i <= 10) {
      for (auto* filter : {&in_time, &late}) {
        filter->Add(HeadingSample(t, RadToDeg(boat.HeadingRad(t))));
        filter->Add(boat.FixAt(t, 0.02));
      }
    }
    if (i > 0) in_time.Add(boat.Motion(t));
    if (i > 3) late.Add(boat.Motion((i - 3) * kScanS));
    in_time.At(NoonPlus(t));
    late.At(NoonPlus(t));
  }
  for (const int i : {28, 29, 30}) late.Add(boat.Motion(i * kScanS));
  const auto expected = in_time.At(NoonPlus(3.02));
  const auto pose = late.At(NoonPlus(3.02));
  EXPECT_EQ(pose.status, PoseStatus::kCoasting);
  EXPECT_EQ(pose.p_map_m, expected.p_map_m);
  EXPECT_EQ(pose.heading_rad, expected.heading_rad);
  EXPECT_EQ(pose.covariance(0, 0), expected.covariance(0, 0));
}

TEST(LidarAid, MotionsOfAnotherTimeAreRefused) {
  const ArcBoat boat;
  PoseFilter filter(TestFilterParams());
  filter.Add(boat.FixAt(0.0, 0.02));
  filter.Add(HeadingSample(0.0, 0.0));
  filter.At(NoonPlus(0.0));
  filter.Add(boat.Motion(-60.0));
  auto counts = filter.counts();
  EXPECT_EQ(counts["late_odometry"], 1);
}

// A receiver that steps each five minutes says nothing against the lidar, which did not lead the place.
TEST(LidarAid, IsNotGivenUpForFixesThatJump) {
  const ArcBoat boat;
  PoseFilter filter(TestFilterParams());
  int refused = 0;
  for (int i = 0; i <= 9000; ++i) {
    const double t = i * kScanS;
    filter.Add(HeadingSample(t, 0.1 * (i % 3 - 1)));
    if (i % 2 == 0) {
      auto fix = boat.FixAt(t, 2.0);
      if (std::fmod(t, 300.0) > 292.0) fix.position->longitude_deg += 45.0 / 80'600.0;
      filter.Add(fix);
    }
    if (i > 0) filter.Add(boat.Motion(t));
    filter.At(NoonPlus(t));
    // Beside the jump it contradicts the velocity, and is told.
    if (filter.contradicts_lidar() && std::fmod(t, 300.0) < 290.0 && std::fmod(t, 300.0) > 15.0) ++refused;
  }
  auto counts = filter.counts();
  EXPECT_GT(counts["renewed_position"], 2);
  EXPECT_EQ(refused, 0);
}

// A compass that drifts by 0.1 deg/s passes every gate, and turns the map.
TEST(LidarAid, ACompassThatDriftsIsToldAndStated) {
  const ArcBoat boat{3.0, 0.0};
  for (const double drift_degps : {0.0, 0.1}) {
    PoseFilter filter(TestFilterParams());
    double first_told_s = kNan;
    Pose pose;
    for (int i = 0; i <= 3000; ++i) {
      const double t = i * kScanS;
      const double drift_deg = drift_degps * std::max(0.0, t - 30.0);
      // Besides a deviation that wanders by a few degrees, as a compass's does.
      filter.Add(HeadingSample(t, drift_deg + 2.0 * std::sin(t / 30.0)));
      if (i % 2 == 0) filter.Add(boat.FixAt(t, 2.0));
      if (i > 0) filter.Add(boat.Motion(t));
      pose = filter.At(NoonPlus(t));
      if (filter.heading_apart_rad() != 0.0 && std::isnan(first_told_s)) first_told_s = t;
    }
    const double error_deg = RadToDeg(WrapToPi(pose.heading_rad));
    const double sd_deg = RadToDeg(std::sqrt(pose.covariance(8, 8)));
    if (drift_degps == 0.0) {
      EXPECT_TRUE(std::isnan(first_told_s));
      EXPECT_LT(sd_deg, 3.0);
    } else {
      EXPECT_LT(first_told_s, 110.0);
      EXPECT_GT(error_deg, 20.0);
      EXPECT_LT(error_deg, 3.0 * sd_deg);
      EXPECT_NEAR(RadToDeg(filter.heading_apart_rad()), -error_deg, 12.0) << "the compass has turned more, so the lidar less";
    }
  }
}

TEST(LidarAid, ACompassThatIsMendedIsNotDoubtedAnyMore) {
  const ArcBoat boat{3.0, 0.0};
  PoseFilter filter(TestFilterParams());
  const auto told = [&](int from, int to, bool has_motion, const std::function<double(double)>& error_deg) {
    for (int i = from; i < to; ++i) {
      const double t = i * kScanS;
      filter.Add(HeadingSample(t, error_deg(t)));
      if (i % 2 == 0) filter.Add(boat.FixAt(t, 2.0));
      if (has_motion && i > 0) filter.Add(boat.Motion(t));
      filter.At(NoonPlus(t));
    }
    return RadToDeg(filter.heading_apart_rad());
  };
  EXPECT_EQ(told(0, 300, true, [](double) { return 0.0; }), 0.0);
  EXPECT_LT(told(300, 1500, true, [](double t) { return 0.2 * (t - 30.0); }), -15.0);
  // It jumps back: that step counts, too.
  EXPECT_EQ(told(1500, 1800, true, [](double) { return 0.0; }), 0.0);
  // A step aside is told, and forgotten also where the lidar tells nothing any more.
  EXPECT_LT(told(1800, 2400, true, [](double) { return 20.0; }), -10.0);
  EXPECT_EQ(told(2400, 9000, false, [](double) { return 20.0; }), 0.0);
}

// A compass that fails while fixes go on: the turn is told by the lidar.
TEST(LidarAid, CarriesTheHeadingAloneWhereThereAreFixesAlone) {
  const ArcBoat boat{0.5, DegToRad(4.0)};  // too slow for the course
  PoseFilter filter(TestFilterParams());
  for (int i = 0; i <= 400; ++i) {
    const double t = i * kScanS;
    if (i <= 50) filter.Add(HeadingSample(t, RadToDeg(boat.HeadingRad(t))));
    if (i % 2 == 0) filter.Add(boat.FixAt(t, 0.5));
    if (i > 0) filter.Add(boat.Motion(t));
    filter.At(NoonPlus(t));
  }
  const auto pose = filter.At(NoonPlus(40.0));
  EXPECT_EQ(pose.status, PoseStatus::kCoasting);
  EXPECT_NEAR(RadToDeg(WrapToPi(pose.heading_rad - boat.HeadingRad(40.0))), 0.0, 0.5);
}

}  // namespace
}  // namespace lookout::navigator
