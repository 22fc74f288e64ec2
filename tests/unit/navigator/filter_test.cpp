// The filter: positions, time, and what stops.
#include <GeographicLib/Geodesic.hpp>
#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "services/navigator/core/filter/pose_filter.hpp"
#include "tests/unit/navigator/filter_measurements.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

TEST(PoseFilter, KnowsNothingAtFirst) {
  PoseFilter filter(TestFilterParams());
  const auto pose = filter.At(NoonPlus(0));
  EXPECT_EQ(pose.status, PoseStatus::kUnknown);
  EXPECT_EQ(pose.heading_source, HeadingSource::kNone);
  EXPECT_TRUE(std::isnan(pose.latitude_deg) && std::isnan(pose.p_map_m.x()) && std::isnan(pose.heading_rad) && std::isnan(pose.velocity_map_mps.z()));
  EXPECT_TRUE(std::isnan(pose.datum.latitude_deg) && std::isnan(pose.heave_m));
  EXPECT_FALSE(pose.has_attitude);
  EXPECT_EQ(pose.roll_rad, 0.0);
  for (int state = 0; state < 9; ++state) {
    const bool is_tilt = state == 6 || state == 7;
    EXPECT_EQ(std::isnan(pose.covariance(state, state)), !is_tilt) << state;
  }
  EXPECT_NEAR(pose.covariance(6, 6), DegToRad(5.0) * DegToRad(5.0), 1e-12);
  EXPECT_NEAR(pose.covariance(6, 7), 0.0, 1e-15);
  EXPECT_TRUE(std::isnan(pose.covariance(6, 8)) && std::isnan(pose.covariance(8, 6)));
}

TEST(PoseFilter, PutsTheDatumAtTheFirstFix) {
  PoseFilter filter(TestFilterParams());
  filter.Add(Fix(0));
  const auto pose = filter.At(NoonPlus(0));
  EXPECT_EQ(pose.status, PoseStatus::kNoHeading);
  EXPECT_EQ(pose.datum.latitude_deg, kLatitudeDeg);
  EXPECT_EQ(pose.datum.longitude_deg, kLongitudeDeg);
  EXPECT_EQ(pose.datum.ellipsoid_height_m, 0.0);
  EXPECT_NEAR(DistanceM(pose), 0.0, 1e-6);
  EXPECT_NEAR(SdM(pose), 2.0, 1e-3);
  EXPECT_EQ(pose.p_map_m.z(), 0.0) << "while the height is not known";
  EXPECT_TRUE(std::isnan(pose.ellipsoid_height_m) && std::isnan(pose.covariance(2, 2)));
}

TEST(PoseFilter, UsesTheDatumFromConfig) {
  auto params = TestFilterParams();
  params.datum = GeodeticPlace{kLatitudeDeg, kLongitudeDeg, 200.0};
  PoseFilter filter(params);
  EXPECT_EQ(filter.At(NoonPlus(0)).datum.ellipsoid_height_m, 200.0) << "known before any fix";
  auto fix = Fix(0.02, "GGA");
  fix.msl_height_m = 240.0;
  fix.geoid_separation_m = -28.0;
  filter.Add(fix);
  const auto pose = filter.At(NoonPlus(0.02));
  EXPECT_NEAR(pose.p_map_m.z(), 12.0, 1e-6);
  EXPECT_NEAR(pose.ellipsoid_height_m, 212.0, 1e-6);
  EXPECT_NEAR(std::sqrt(pose.covariance(2, 2)), 4.0, 1e-3) << "twice that of the axes";
}

TEST(PoseFilter, GoesStraightOnBetweenFixes) {
  PoseFilter filter(TestFilterParams());
  filter.Add(MovingFix(0, 3.0, 60.0));
  const auto pose = filter.At(NoonPlus(1.5));
  EXPECT_NEAR(DistanceM(pose), 4.5, 1e-3);
  EXPECT_NEAR(pose.p_map_m.x(), 4.5 * std::sin(DegToRad(60.0)), 1e-5);
  EXPECT_NEAR(pose.velocity_map_mps.y(), 3.0 * std::cos(DegToRad(60.0)), 1e-6);
  EXPECT_EQ(pose.velocity_map_mps.z(), 0.0);
}

TEST(PoseFilter, CoastsWithGrowingDeviationThenLosesThePositionAndFindsItAgain) {
  PoseFilter filter(TestFilterParams());
  filter.Add(MovingFix(0, 3.0, 60.0));
  filter.Add(HeadingSample(0, 60.0));
  double last_sd_m = 0.0;
  for (const double time_s : {0.0, 0.5, 1.0, 1.5}) {
    const auto pose = filter.At(NoonPlus(time_s));
    EXPECT_GT(SdM(pose), last_sd_m);
    EXPECT_EQ(pose.status, time_s > 1.0 ? PoseStatus::kCoasting : PoseStatus::kOk) << time_s;
    last_sd_m = SdM(pose);
    filter.Add(HeadingSample(time_s + 0.1, 60.0));
  }
  EXPECT_EQ(filter.stopped(), "no position fix for 1 s");
  const auto lost = filter.At(NoonPlus(9.0));
  EXPECT_EQ(lost.status, PoseStatus::kUnknown);
  EXPECT_TRUE(std::isnan(lost.latitude_deg) && std::isnan(lost.covariance(0, 0)) && std::isnan(lost.velocity_map_mps.x()));
  EXPECT_FALSE(std::isnan(lost.datum.latitude_deg)) << "the datum stays";
  auto far = Fix(10);
  far.position->latitude_deg += 0.01;
  filter.Add(far);
  const auto found = filter.At(NoonPlus(10));
  EXPECT_EQ(found.status, PoseStatus::kNoHeading);
  EXPECT_NEAR(found.latitude_deg, far.position->latitude_deg, 1e-9);
}

TEST(PoseFilter, DoesNotCountAnEpochTwice) {
  PoseFilter filter(TestFilterParams());
  filter.Add(MovingFix(0, 3.0, 60.0));
  auto gga = Fix(0, "GGA");
  gga.horizontal_sd_m = 0.02;
  gga.position->latitude_deg += 1e-5;
  gga.msl_height_m = 100.0;
  gga.geoid_separation_m = 50.0;
  filter.Add(gga);
  auto lidar = MovingFix(0, 4.0, 60.0);  // the same receiver by another way
  lidar.source = "lidar";
  lidar.position = gga.position;
  filter.Add(lidar);
  const auto pose = filter.At(NoonPlus(0));
  EXPECT_NEAR(pose.latitude_deg, kLatitudeDeg + 1e-5, 1e-10);
  EXPECT_NEAR(SdM(pose), 0.02, 1e-6);
  EXPECT_NEAR(pose.velocity_map_mps.norm(), 3.0, 1e-6);
  EXPECT_NEAR(pose.ellipsoid_height_m, 150.0, 1e-6);
}

// What a measurement says does not depend on when it comes, as long as it is kept for.
TEST(PoseFilter, UsesLateMeasurementsAtTheirTime) {
  PoseFilter in_order(TestFilterParams());
  PoseFilter late(TestFilterParams());
  const auto attitude = [](int i) { return AttitudeSample(0.05 * i, 10.0 + i, 0.1 * i, -0.1 * i); };
  for (int i = 0; i <= 20; ++i) in_order.Add(attitude(i));
  in_order.Add(MovingFix(0.5, 2.0, 20.0));
  for (int i = 0; i <= 20; ++i) {
    if (i != 7) late.Add(attitude(i));
  }
  const auto without = late.At(NoonPlus(1.0));
  EXPECT_EQ(without.status, PoseStatus::kNoPosition);
  late.Add(MovingFix(0.5, 2.0, 20.0));
  late.Add(attitude(7));
  const auto expected = in_order.At(NoonPlus(1.02));
  const auto pose = late.At(NoonPlus(1.02));
  EXPECT_EQ(pose.status, PoseStatus::kOk);
  EXPECT_EQ(pose.p_map_m, expected.p_map_m);
  EXPECT_EQ(pose.heading_rad, expected.heading_rad);
  EXPECT_EQ(pose.roll_rad, expected.roll_rad);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 9; ++column) {
      const bool is_unknown = row == 2 || column == 2;
      EXPECT_TRUE(is_unknown || pose.covariance(row, column) == expected.covariance(row, column)) << row << ", " << column;
    }
  }
  EXPECT_EQ(late.counts()["late_fix"], 0);
}

TEST(PoseFilter, RefusesWhatIsOlderThanItKeeps) {
  PoseFilter filter(TestFilterParams());
  for (int i = 0; i <= 50; ++i) {
    filter.AdvanceTo(NoonPlus(0.1 * i));
    filter.At(NoonPlus(0.1 * i));
  }
  filter.Add(Fix(3.0));
  EXPECT_EQ(filter.counts()["late_fix"], 1) << "half a second of latency and one more are kept";
  filter.Add(Fix(4.0));
  EXPECT_EQ(filter.counts()["late_fix"], 1);
  filter.Add(AttitudeSample(3.0, 0.0, 0.0, 0.0));
  EXPECT_EQ(filter.counts()["late_attitude"], 1);
  filter.Add(RestSample(3.0));
  EXPECT_EQ(filter.counts()["late_imu"], 1);
}

TEST(PoseFilter, UsesOnlyMeasuredFixes) {
  for (const auto quality : {FixQuality::kNone, FixQuality::kManual, FixQuality::kSimulator}) {
    PoseFilter filter(TestFilterParams());
    auto fix = Fix(0);
    fix.quality = quality;
    filter.Add(fix);
    EXPECT_EQ(filter.At(NoonPlus(0)).status, PoseStatus::kUnknown);
    EXPECT_EQ(filter.counts()["unusable_fix"], 1);
  }
}

TEST(PoseFilter, RefusesAFixThatContradictsUntilItIsThereForSeconds) {
  PoseFilter filter(TestFilterParams());
  const auto fix = [](double time_s, double north_m) {
    auto made = MovingFix(time_s, 0.0, 0.0);
    made.position->latitude_deg += north_m / 111'111.0;
    made.horizontal_sd_m = 0.1;
    return made;
  };
  for (int i = 0; i < 10; ++i) filter.Add(fix(0.2 * i, 0.0));
  EXPECT_NEAR(DistanceM(filter.At(NoonPlus(1.8))), 0.0, 0.05);
  for (int i = 0; i < 10; ++i) filter.Add(fix(2.0 + 0.2 * i, 50.0));
  EXPECT_LT(DistanceM(filter.At(NoonPlus(3.8))), 2.0);
  EXPECT_EQ(filter.counts()["gated_fix"], 10);
  for (int i = 0; i < 20; ++i) filter.Add(fix(4.0 + 0.2 * i, 50.0));
  EXPECT_NEAR(DistanceM(filter.At(NoonPlus(7.8))), 50.0, 0.5);
}

TEST(PoseFilter, UsesVtgForVelocityWhereFixesHaveNone) {
  PoseFilter filter(TestFilterParams());
  for (int i = 0; i < 20; ++i) {
    auto fix = Fix(0.2 * i, "GGA");
    fix.position->longitude_deg += 2.0 * 0.2 * i / (111'320.0 * std::cos(DegToRad(kLatitudeDeg)));
    filter.Add(fix);
    filter.Add(GroundVelocity{NoonPlus(0.2 * i + 0.05), 2.0, DegToRad(90.0)});
  }
  const auto pose = filter.At(NoonPlus(4.0));
  EXPECT_NEAR(pose.velocity_map_mps.x(), 2.0, 0.05);
  EXPECT_EQ(pose.heading_source, HeadingSource::kCourse);
  EXPECT_NEAR(pose.heading_rad, DegToRad(90.0), DegToRad(3.0));
}

TEST(PoseFilter, UsesASpeedWithoutCourseForUncertainty) {
  PoseFilter filter(TestFilterParams());
  auto fix = Fix(0);
  fix.speed_mps = 0.5;
  filter.Add(fix);
  const auto pose = filter.At(NoonPlus(0));
  EXPECT_EQ(pose.velocity_map_mps.x(), 0.0);
  EXPECT_NEAR(pose.covariance(3, 3), 0.1 * 0.1 + 0.5 * 0.5 / 2.0, 1e-3);
  EXPECT_EQ(pose.heading_source, HeadingSource::kNone);
}

// The prior of a position found anew is so many metres, that of its velocity so many metres per second: once it was the metres, 1000 m/s.
TEST(PoseFilter, KnowsOfAVelocityThatSaysNothingThatItIsABoats) {
  GnssFix fix = MovingFix(0.0, 5.0, 90.0);
  fix.velocity_sd_mps = 500.0;
  PoseFilter filter(TestFilterParams());
  filter.Add(fix);
  const Pose pose = filter.At(NoonPlus(0.0));
  EXPECT_LT(std::sqrt(pose.covariance(3, 3)), 150.0);
  // What is known of it counts alone.
  fix.velocity_sd_mps = 0.1;
  PoseFilter other(TestFilterParams());
  other.Add(fix);
  EXPECT_NEAR(std::sqrt(other.At(NoonPlus(0.0)).covariance(3, 3)), 0.1, 0.05);
}

TEST(PoseFilter, NamesInputsThatStop) {
  PoseFilter filter(TestFilterParams());
  for (int i = 0; i <= 200; ++i) filter.Add(RestSample(0.01 * i));
  for (int i = 0; i <= 10; ++i) {
    filter.Add(MovingFix(0.2 * i, 0.0, 0.0));
    filter.Add(AttitudeSample(0.2 * i + 0.01, 0.0, 0.0, 0.0));
  }
  filter.At(NoonPlus(2.9));
  EXPECT_EQ(filter.stopped(), "");
  filter.At(NoonPlus(3.1));
  EXPECT_EQ(filter.stopped(), "no position fix for 1 s, no heading for 1 s, no attitude for 1 s, no IMU for 1 s");
}

// The computer slept. HEALTH was ok then, though nothing came any more.
TEST(PoseFilter, NamesInputsThatStoppedBeforeALongSilence) {
  PoseFilter filter(TestFilterParams());
  for (int i = 0; i < 50; ++i) {
    filter.Add(Fix(0.1 * i));
    filter.Add(AttitudeSample(0.1 * i, 0, 0, 0));
    filter.At(NoonPlus(0.1 * i));
  }
  filter.AdvanceTo(NoonPlus(3600));
  EXPECT_EQ(filter.At(NoonPlus(3600)).status, PoseStatus::kUnknown);
  EXPECT_EQ(filter.stopped(), "no position fix for 3595 s, no heading for 3595 s, no attitude for 3595 s");
}

TEST(PoseFilter, WaitsASecondLongerForTheReceiverOfOneFix) {
  PoseFilter filter(TestFilterParams());
  for (int i = 0; i <= 3; ++i) {
    auto fix = MovingFix(i, 3.0, 0.0);
    fix.position->latitude_deg += 3.0 * i / 111'111.0;
    filter.Add(fix);
    filter.Add(HeadingSample(i, 0.0));
  }
  EXPECT_EQ(filter.At(NoonPlus(4.5)).status, PoseStatus::kNoHeading) << "headings are not carried on without an IMU";
  EXPECT_EQ(filter.stopped(), "");
  filter.At(NoonPlus(5.2));
  EXPECT_EQ(filter.stopped(), "no position fix for 2 s, no heading for 2 s");
}

TEST(PoseFilter, HoldsNearThePoleAndAcrossTheDateLine) {
  for (const auto& position : {GeodeticPlace{90.0, 0.0}, GeodeticPlace{-90.0, 10.0}, GeodeticPlace{0.0, 180.0}, GeodeticPlace{10.0, -180.0}}) {
    PoseFilter filter(TestFilterParams());
    auto fix = MovingFix(0, 3.0, 90.0);
    fix.position = position;
    filter.Add(fix);
    const auto pose = filter.At(NoonPlus(1));
    EXPECT_EQ(pose.status, PoseStatus::kOk);
    double distance_m = 0.0;
    GeographicLib::Geodesic::WGS84().Inverse(position.latitude_deg, position.longitude_deg, pose.latitude_deg, pose.longitude_deg, distance_m);
    EXPECT_NEAR(distance_m, 3.0, 1e-3);
  }
}

}  // namespace
}  // namespace lookout::navigator
