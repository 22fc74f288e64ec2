// The filter: heading, tilt, lever arms, IMU.
#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit/navigator/filter_measurements.hpp"

namespace lookout::navigator {
namespace {

TEST(PoseFilterAttitude, TurnsAcrossNorth) {
  PoseFilter filter(TestFilterParams());
  filter.Add(Fix(0));
  for (int i = 0; i <= 40; ++i) filter.Add(HeadingSample(0.1 * i, 340.0 + i));
  EXPECT_NEAR(RadToDeg(filter.At(NoonPlus(1.9)).heading_rad), 359.0, 0.5);
  const auto pose = filter.At(NoonPlus(4.2));
  EXPECT_NEAR(RadToDeg(pose.heading_rad), 22.0, 0.7);
  EXPECT_EQ(pose.heading_source, HeadingSource::kHdt);
}

TEST(PoseFilterAttitude, PrefersAnAttitudeSensorWhileItIsAlive) {
  PoseFilter filter(TestFilterParams());
  filter.Add(AttitudeSample(0.0, 10.0, 0.0, 0.0));
  filter.Add(HeadingSample(0.5, 20.0));
  EXPECT_EQ(filter.At(NoonPlus(0.9)).heading_source, HeadingSource::kPashr);
  EXPECT_NEAR(filter.At(NoonPlus(0.9)).heading_rad, DegToRad(10.0), 1e-6);
  filter.Add(HeadingSample(1.05, 20.0));
  const auto pose = filter.At(NoonPlus(1.1));
  EXPECT_EQ(pose.heading_source, HeadingSource::kHdt);
  EXPECT_EQ(pose.status, PoseStatus::kNoPosition);
  EXPECT_EQ(filter.At(NoonPlus(2.1)).heading_source, HeadingSource::kNone);
}

TEST(PoseFilterAttitude, UsesTheCourseForHeadingOnlyAboveTheSpeedAndWhereAllowed) {
  auto params = TestFilterParams();
  PoseFilter fast(params);
  fast.Add(MovingFix(0, 1.0, 60.0));
  const auto pose = fast.At(NoonPlus(0));
  EXPECT_EQ(pose.heading_source, HeadingSource::kCourse);
  EXPECT_NEAR(pose.heading_rad, DegToRad(60.0), 1e-9);
  EXPECT_NEAR(pose.covariance(8, 8), DegToRad(10.0) * DegToRad(10.0), 1e-4);
  PoseFilter slow(params);
  slow.Add(MovingFix(0, 0.99, 60.0));
  EXPECT_EQ(slow.At(NoonPlus(0)).heading_source, HeadingSource::kNone);
  params.use_course_as_heading = false;
  PoseFilter forbidden(params);
  forbidden.Add(MovingFix(0, 5.0, 60.0));
  EXPECT_EQ(forbidden.At(NoonPlus(0)).status, PoseStatus::kNoHeading);
}

TEST(PoseFilterAttitude, PutsTheReferencePointALeverArmFromTheAntenna) {
  for (const bool heading_first : {true, false}) {
    for (const Eigen::Vector3d& p_vessel_imu_m : {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(1.0, 2.0, -1.0)}) {
      auto params = TestFilterParams();
      params.datum = GeodeticPlace{kLatitudeDeg, kLongitudeDeg, 0.0};
      params.p_vessel_antenna_m = {-2.0, 0.5, 3.0};
      params.p_vessel_imu_m = p_vessel_imu_m;
      PoseFilter filter(params);
      auto fix = Fix(heading_first ? 0.01 : 0.0, "GGA");
      fix.msl_height_m = 100.0;
      fix.geoid_separation_m = -20.0;
      fix.horizontal_sd_m = 0.02;
      filter.Add(fix);
      filter.Add(HeadingSample(heading_first ? 0.0 : 0.01, 90.0));  // bow east, port north
      const auto pose = filter.At(NoonPlus(0.02));
      EXPECT_NEAR(pose.p_map_m.x(), 2.0, 1e-5);
      EXPECT_NEAR(pose.p_map_m.y(), -0.5, 1e-5);
      EXPECT_NEAR(pose.ellipsoid_height_m, 77.0, 1e-5);
      const double expected_m2 = 0.02 * 0.02 + std::pow(2.0 * DegToRad(1.0), 2) + std::pow(3.0 * DegToRad(5.0), 2);
      EXPECT_NEAR(pose.covariance(1, 1), expected_m2, 0.12 * expected_m2) << "a degree of heading and five of tilt swing the arm";
    }
  }
}

TEST(PoseFilterAttitude, TiltsTheLeverArm) {
  auto params = TestFilterParams();
  params.p_vessel_antenna_m = {0.0, 0.0, 10.0};
  PoseFilter rolled(params);
  rolled.Add(Fix(0));
  auto attitude = AttitudeSample(0.0, 0.0, 10.0, 0.0);  // starboard down: the antenna leans east
  attitude.roll_sd_rad = DegToRad(0.05);
  rolled.Add(attitude);
  const auto pose = rolled.At(NoonPlus(0));
  EXPECT_TRUE(pose.has_attitude);
  EXPECT_NEAR(pose.roll_rad, DegToRad(10.0), 1e-9);
  EXPECT_NEAR(pose.p_map_m.x(), -10.0 * std::sin(DegToRad(10.0)), 1e-6);
  EXPECT_NEAR(std::sqrt(pose.covariance(6, 6)), DegToRad(0.05), 1e-5);
  EXPECT_NEAR(std::sqrt(pose.covariance(7, 7)), DegToRad(0.5), 1e-5) << "what the sentence does not say comes from config";

  PoseFilter pitched(params);
  pitched.Add(Fix(0));
  pitched.Add(AttitudeSample(0.0, 0.0, 0.0, 10.0));  // bow up: the antenna leans aft, south
  EXPECT_NEAR(pitched.At(NoonPlus(0)).p_map_m.y(), 10.0 * std::sin(DegToRad(10.0)), 1e-6);
  EXPECT_NEAR(pitched.At(NoonPlus(0)).pitch_rad, DegToRad(10.0), 1e-9);
}

TEST(PoseFilterAttitude, StaysAtTheAntennaWithoutHeading) {
  auto params = TestFilterParams();
  params.p_vessel_antenna_m = {-3.0, 4.0, 2.0};
  PoseFilter filter(params);
  filter.Add(Fix(0));
  const auto pose = filter.At(NoonPlus(0));
  EXPECT_NEAR(DistanceM(pose), 0.0, 1e-6);
  EXPECT_NEAR(SdM(pose), std::hypot(2.0, 5.0), 1e-3);
}

TEST(PoseFilterAttitude, FreesTheVelocityFromTheSwingOfTheAntenna) {
  auto params = TestFilterParams();
  params.p_vessel_antenna_m = {2.0, 0.0, 0.0};
  PoseFilter filter(params);
  // At rest, turning clockwise with 0.2 rad/s: the antenna at the bow goes at 0.4 m/s across it.
  for (int i = 0; i <= 50; ++i) {
    const double heading_rad = 0.2 * 0.1 * i;
    auto attitude = AttitudeSample(0.1 * i, RadToDeg(heading_rad), 0.0, 0.0);
    attitude.heading_sd_rad = DegToRad(0.2);
    filter.Add(attitude);
    auto fix = MovingFix(0.1 * i, 0.4, RadToDeg(heading_rad) + 90.0);
    fix.position->latitude_deg += 2.0 * std::cos(heading_rad) / 111'111.0;
    fix.position->longitude_deg += 2.0 * std::sin(heading_rad) / (111'320.0 * std::cos(DegToRad(kLatitudeDeg)));
    filter.Add(fix);
  }
  EXPECT_LT(filter.At(NoonPlus(5.0)).velocity_map_mps.norm(), 0.05);
}

TEST(PoseFilterAttitude, HasHeave) {
  PoseFilter filter(TestFilterParams());
  auto attitude = HeadingSample(0, 0.0);
  attitude.heave_m = -0.2;
  filter.Add(attitude);
  EXPECT_NEAR(filter.At(NoonPlus(0)).heave_m, -0.2, 1e-3);
  EXPECT_TRUE(std::isnan(filter.At(NoonPlus(1.1)).heave_m));
}

TEST(PoseFilterAttitude, LevelsAnImuThatNothingElseHelps) {
  PoseFilter filter(TestFilterParams());
  const double pitch_rad = DegToRad(4.0);
  const double roll_rad = DegToRad(-7.0);
  const Eigen::Vector3d up_vessel(std::sin(pitch_rad), std::cos(pitch_rad) * std::sin(roll_rad), std::cos(pitch_rad) * std::cos(roll_rad));
  for (int i = 0; i <= 500; ++i) filter.Add(ImuSample{NoonPlus(0.01 * i), Eigen::Vector3d(0.001, -0.001, 0.02), 9.81 * up_vessel});
  const auto pose = filter.At(NoonPlus(5.0));
  EXPECT_EQ(pose.status, PoseStatus::kUnknown);
  EXPECT_TRUE(pose.has_attitude);
  EXPECT_NEAR(pose.pitch_rad, pitch_rad, DegToRad(0.5));
  EXPECT_NEAR(pose.roll_rad, roll_rad, DegToRad(0.5));
}

// What a sensor says of itself hovers about the bound between two kinds. Each change of kind was a new error, and the mean of many much too good.
TEST(PoseFilterAttitude, IsNotTheSurerForADeviationThatHovers) {
  const auto sds = [](double first_share, double second_share) {
    PoseFilter filter(TestFilterParams());
    for (int i = 0; i < 3000; ++i) {
      const double share = i % 10 < 5 ? first_share : second_share;
      filter.Add(RestSample(0.02 * i));
      if (i % 5 == 0) {
        auto sample = AttitudeSample(0.02 * i, 90.0, 0.0, 0.0);
        sample.heading_sd_rad = DegToRad(0.5 * share);
        filter.Add(sample);
        auto fix = Fix(0.02 * i);
        fix.horizontal_sd_m = 0.1 * share;
        filter.Add(fix);
      }
      filter.At(NoonPlus(0.02 * i));
    }
    const auto pose = filter.At(NoonPlus(59.98));
    return std::pair(std::sqrt(pose.covariance(8, 8)), SdM(pose));
  };
  const auto even = sds(0.98, 0.98);
  const auto hovering = sds(0.98, 1.02);
  EXPECT_GT(hovering.first, 0.95 * even.first);
  EXPECT_GT(hovering.second, 0.95 * even.second);
}

TEST(PoseFilterAttitude, RefusesSamplesThatLackANumber) {
  PoseFilter filter(TestFilterParams());
  auto sample = RestSample(0);
  sample.specific_force_mps2.y() = kNan;
  filter.Add(sample);
  EXPECT_EQ(filter.counts()["unusable_imu"], 1);
  EXPECT_FALSE(filter.At(NoonPlus(0)).has_attitude);
}

}  // namespace
}  // namespace lookout::navigator
