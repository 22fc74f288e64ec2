#include "services/navigator/core/pose_estimator.hpp"

#include <GeographicLib/Geodesic.hpp>
#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

constexpr double kLatitudeDeg = 43.63;
constexpr double kLongitudeDeg = -72.15;

PoseParams TestParams() {
  PoseParams params;
  params.antenna.max_age = 2s;
  params.antenna.velocity_sd_mps = 0.1;
  params.antenna.position_drift_mps = 0.3;
  params.attitude.max_age = 1s;
  params.attitude.heading_sd_rad = DegToRad(1.0);
  params.attitude.tilt_sd_rad = DegToRad(0.5);
  params.use_course_as_heading = true;
  params.min_course_speed_mps = 1.0;
  params.course_heading_sd_rad = DegToRad(10.0);
  params.unmeasured_tilt_sd_rad = DegToRad(5.0);
  return params;
}

GnssFix Fix(double time_s, const char* type = "RMC") {
  GnssFix fix;
  fix.when = {NoonPlus(time_s), NoonPlus(time_s), true};
  fix.sentence_type = type;
  fix.quality = FixQuality::kGnss;
  fix.position = GeodeticPosition{kLatitudeDeg, kLongitudeDeg};
  fix.horizontal_sd_m = 2.0;
  return fix;
}

GnssFix MovingFix(double time_s, double speed_mps, double course_deg) {
  GnssFix fix = Fix(time_s);
  fix.speed_mps = speed_mps;
  fix.course_rad = DegToRad(course_deg);
  return fix;
}

Attitude HeadingSample(double time_s, double heading_deg, const char* type = "HDT") {
  Attitude attitude;
  attitude.when = {NoonPlus(time_s), NoonPlus(time_s), false};
  attitude.sentence_type = type;
  attitude.heading_rad = DegToRad(heading_deg);
  return attitude;
}

// Metres on the ellipsoid from the test's place.
double DistanceM(const Pose& pose) {
  double distance_m = 0.0;
  GeographicLib::Geodesic::WGS84().Inverse(kLatitudeDeg, kLongitudeDeg, pose.latitude_deg, pose.longitude_deg, distance_m);
  return distance_m;
}

TEST(PoseEstimator, KnowsNothingAtFirst) {
  const auto pose = PoseEstimator(TestParams()).At(NoonPlus(0));
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
  EXPECT_EQ(pose.covariance(6, 7), 0.0);
  EXPECT_TRUE(std::isnan(pose.covariance(6, 8)) && std::isnan(pose.covariance(8, 6)));
}

TEST(PoseEstimator, PutsTheDatumAtTheFirstFix) {
  PoseEstimator estimator(TestParams());
  estimator.antenna().Add(Fix(0));
  auto moved = Fix(1);
  moved.position->latitude_deg += 0.001;
  estimator.antenna().Add(moved);
  const auto pose = estimator.At(NoonPlus(1));
  EXPECT_EQ(pose.status, PoseStatus::kNoHeading);
  EXPECT_EQ(pose.datum.latitude_deg, kLatitudeDeg);
  EXPECT_EQ(pose.datum.longitude_deg, kLongitudeDeg);
  EXPECT_EQ(pose.datum.ellipsoid_height_m, 0.0);
  EXPECT_NEAR(pose.p_map_m.x(), 0.0, 1e-3);
  EXPECT_NEAR(pose.p_map_m.y(), 111.1, 0.1);
  EXPECT_EQ(pose.p_map_m.z(), 0.0) << "while the height is not known";
  EXPECT_NEAR(pose.latitude_deg, moved.position->latitude_deg, 1e-10);
  EXPECT_NEAR(pose.longitude_deg, kLongitudeDeg, 1e-10);
  EXPECT_TRUE(std::isnan(pose.ellipsoid_height_m) && std::isnan(pose.covariance(2, 2)));
}

TEST(PoseEstimator, TakesTheDatumFromConfig) {
  auto params = TestParams();
  params.antenna.datum = Datum{kLatitudeDeg, kLongitudeDeg, 200.0};
  PoseEstimator estimator(params);
  EXPECT_EQ(estimator.At(NoonPlus(0)).datum.ellipsoid_height_m, 200.0) << "known before any fix";
  auto fix = Fix(0, "GGA");
  fix.msl_height_m = 240.0;
  fix.geoid_separation_m = -28.0;
  estimator.antenna().Add(fix);
  const auto pose = estimator.At(NoonPlus(0));
  EXPECT_NEAR(pose.p_map_m.z(), 12.0, 1e-6);
  EXPECT_NEAR(pose.ellipsoid_height_m, 212.0, 1e-6);
}

TEST(PoseEstimator, GoesStraightOnBetweenFixes) {
  PoseEstimator estimator(TestParams());
  estimator.antenna().Add(MovingFix(0, 3.0, 60.0));
  const auto pose = estimator.At(NoonPlus(1.5));
  EXPECT_NEAR(pose.p_map_m.x(), 4.5 * std::sin(DegToRad(60.0)), 1e-6);
  EXPECT_NEAR(pose.p_map_m.y(), 4.5 * std::cos(DegToRad(60.0)), 1e-6);
  EXPECT_NEAR(DistanceM(pose), 4.5, 1e-3);
  EXPECT_NEAR(pose.velocity_map_mps.x(), 3.0 * std::sin(DegToRad(60.0)), 1e-12);
  EXPECT_EQ(pose.velocity_map_mps.z(), 0.0);
  const auto before = estimator.At(NoonPlus(-0.4));
  EXPECT_NEAR(DistanceM(before), 1.2, 1e-3) << "the receiver's clock may be ahead of the host's";
}

TEST(PoseEstimator, LosesThePositionInAnOutageAndFindsItAgain) {
  PoseEstimator estimator(TestParams());
  estimator.antenna().Add(MovingFix(0, 3.0, 60.0));
  double last_sd_m = 0.0;
  for (const double time_s : {0.0, 0.5, 1.0, 2.0}) {
    const auto pose = estimator.At(NoonPlus(time_s));
    const double sd_m = std::sqrt(pose.covariance(0, 0));
    EXPECT_GT(sd_m, last_sd_m);
    last_sd_m = sd_m;
  }
  const auto lost = estimator.At(NoonPlus(2.001));
  EXPECT_EQ(lost.status, PoseStatus::kUnknown);
  EXPECT_TRUE(std::isnan(lost.latitude_deg) && std::isnan(lost.covariance(0, 0)) && std::isnan(lost.velocity_map_mps.x()));
  EXPECT_FALSE(std::isnan(lost.datum.latitude_deg)) << "the datum stays";
  estimator.antenna().Add(Fix(10));
  EXPECT_EQ(estimator.At(NoonPlus(10)).status, PoseStatus::kNoHeading);
}

TEST(PoseEstimator, DoesNotCountAnEpochTwice) {
  PoseEstimator estimator(TestParams());
  estimator.antenna().Add(MovingFix(0, 3.0, 60.0));
  auto gga = Fix(0, "GGA");
  gga.horizontal_sd_m = 0.02;
  gga.position->latitude_deg += 1e-5;
  gga.msl_height_m = 100.0;
  gga.geoid_separation_m = 50.0;
  estimator.antenna().Add(gga);
  estimator.antenna().Add(MovingFix(0, 4.0, 60.0));  // RMC after GGA: its velocity counts, its position does not
  const auto pose = estimator.At(NoonPlus(0));
  EXPECT_NEAR(pose.latitude_deg, kLatitudeDeg + 1e-5, 1e-10);
  EXPECT_NEAR(std::sqrt(pose.covariance(0, 0)), 0.02, 1e-9);
  EXPECT_NEAR(pose.velocity_map_mps.norm(), 4.0, 1e-9);
  EXPECT_NEAR(pose.ellipsoid_height_m, 150.0, 1e-6);
}

TEST(PoseEstimator, LeavesALateFixAlone) {
  PoseEstimator estimator(TestParams());
  estimator.antenna().Add(Fix(1));
  auto late = MovingFix(0.9, 3.0, 60.0);
  late.position->latitude_deg += 0.01;
  estimator.antenna().Add(late);
  EXPECT_NEAR(estimator.At(NoonPlus(1)).latitude_deg, kLatitudeDeg, 1e-10);
  EXPECT_EQ(estimator.antenna().num_late(), 1);
}

// A receiver two seconds late stands on the edge of what max_sentence_latency_s allows: its fixes used to be lost one by one.
TEST(PoseEstimator, TakesAFixWhoseTimeIsOfAnotherKindThanTheLasts) {
  PoseEstimator estimator(TestParams());
  auto by_arrival = Fix(1);
  by_arrival.when.is_from_sentence = false;
  estimator.antenna().Add(by_arrival);
  auto by_sentence = Fix(0.1);
  by_sentence.position->latitude_deg += 0.01;
  estimator.antenna().Add(by_sentence);
  EXPECT_NEAR(estimator.At(NoonPlus(1)).latitude_deg, kLatitudeDeg + 0.01, 1e-10);
  EXPECT_EQ(estimator.antenna().num_late(), 0);
}

TEST(PoseEstimator, UsesOnlyMeasuredFixes) {
  for (const auto quality : {FixQuality::kNone, FixQuality::kManual, FixQuality::kSimulator}) {
    PoseEstimator estimator(TestParams());
    auto fix = Fix(0);
    fix.quality = quality;
    estimator.antenna().Add(fix);
    EXPECT_EQ(estimator.At(NoonPlus(0)).status, PoseStatus::kUnknown);
    EXPECT_EQ(estimator.antenna().num_unusable(), 1);
  }
}

TEST(PoseEstimator, TakesVtgForVelocity) {
  PoseEstimator estimator(TestParams());
  estimator.antenna().Add(Fix(0, "GGA"));
  EXPECT_TRUE(std::isnan(estimator.At(NoonPlus(0)).velocity_map_mps.x()));
  estimator.antenna().Add(GroundVelocity{NoonPlus(0.1), 2.0, DegToRad(90.0)});
  const auto pose = estimator.At(NoonPlus(1));
  EXPECT_NEAR(pose.p_map_m.x(), 2.0, 1e-6);
  EXPECT_EQ(pose.heading_source, HeadingSource::kCourse);
}

TEST(PoseEstimator, TakesASpeedWithoutCourseForUncertainty) {
  PoseEstimator estimator(TestParams());
  auto fix = Fix(0);
  fix.speed_mps = 0.5;
  estimator.antenna().Add(fix);
  const auto pose = estimator.At(NoonPlus(0));
  EXPECT_EQ(pose.velocity_map_mps.x(), 0.0);
  EXPECT_NEAR(pose.covariance(3, 3), 0.1 * 0.1 + 0.5 * 0.5, 1e-9);
  EXPECT_EQ(pose.heading_source, HeadingSource::kNone);
}

TEST(PoseEstimator, TurnsAcrossNorth) {
  PoseEstimator estimator(TestParams());
  estimator.antenna().Add(Fix(0));
  estimator.attitude().Add(HeadingSample(0.0, 358.0));
  estimator.attitude().Add(HeadingSample(0.1, 359.0));
  const auto heading_deg = [&](double time_s) { return RadToDeg(estimator.At(NoonPlus(time_s)).heading_rad); };
  EXPECT_NEAR(heading_deg(0.05), 358.5, 1e-9);
  EXPECT_NEAR(heading_deg(0.3), 1.0, 1e-9);
  estimator.attitude().Add(HeadingSample(0.2, 0.0));
  EXPECT_NEAR(heading_deg(0.15), 359.5, 1e-9);
  EXPECT_NEAR(heading_deg(0.3), 1.0, 1e-9);
  EXPECT_EQ(estimator.At(NoonPlus(0.3)).status, PoseStatus::kOk);
  EXPECT_EQ(estimator.At(NoonPlus(0.3)).heading_source, HeadingSource::kHdt);
}

TEST(PoseEstimator, PrefersPashrWhileItIsAlive) {
  PoseEstimator estimator(TestParams());
  estimator.attitude().Add(HeadingSample(0.0, 10.0, "PASHR"));
  estimator.attitude().Add(HeadingSample(0.5, 20.0, "HDT"));
  EXPECT_EQ(estimator.At(NoonPlus(0.9)).heading_source, HeadingSource::kPashr);
  EXPECT_NEAR(estimator.At(NoonPlus(0.9)).heading_rad, DegToRad(10.0), 1e-12);
  EXPECT_EQ(estimator.At(NoonPlus(1.1)).heading_source, HeadingSource::kHdt);
  EXPECT_EQ(estimator.At(NoonPlus(1.1)).status, PoseStatus::kNoPosition);
  EXPECT_EQ(estimator.At(NoonPlus(1.6)).heading_source, HeadingSource::kNone);
}

TEST(PoseEstimator, TakesTheCourseForHeadingOnlyAboveTheSpeedAndWhereAllowed) {
  auto params = TestParams();
  PoseEstimator fast(params);
  fast.antenna().Add(MovingFix(0, 1.0, 60.0));
  EXPECT_EQ(fast.At(NoonPlus(0)).heading_source, HeadingSource::kCourse);
  EXPECT_NEAR(fast.At(NoonPlus(0)).heading_rad, DegToRad(60.0), 1e-12);
  EXPECT_NEAR(fast.At(NoonPlus(0)).covariance(8, 8), DegToRad(10.0) * DegToRad(10.0), 1e-12);
  PoseEstimator slow(params);
  slow.antenna().Add(MovingFix(0, 0.99, 60.0));
  EXPECT_EQ(slow.At(NoonPlus(0)).heading_source, HeadingSource::kNone);
  params.use_course_as_heading = false;
  PoseEstimator forbidden(params);
  forbidden.antenna().Add(MovingFix(0, 5.0, 60.0));
  EXPECT_EQ(forbidden.At(NoonPlus(0)).status, PoseStatus::kNoHeading);
}

TEST(PoseEstimator, PutsTheReferencePointALeverArmFromTheAntenna) {
  auto params = TestParams();
  params.antenna.datum = Datum{kLatitudeDeg, kLongitudeDeg, 0.0};
  params.p_vessel_antenna_m = {-2.0, 0.5, 3.0};
  PoseEstimator estimator(params);
  auto fix = Fix(0, "GGA");
  fix.msl_height_m = 100.0;
  fix.geoid_separation_m = -20.0;
  estimator.antenna().Add(fix);
  estimator.attitude().Add(HeadingSample(0, 90.0));  // bow east, port north
  const auto pose = estimator.At(NoonPlus(0));
  EXPECT_NEAR(pose.p_map_m.x(), 2.0, 1e-9);
  EXPECT_NEAR(pose.p_map_m.y(), -0.5, 1e-9);
  EXPECT_NEAR(pose.ellipsoid_height_m, 77.0, 1e-6);
  EXPECT_NEAR(DistanceM(pose), std::hypot(2.0, 0.5), 1e-3);
}

TEST(PoseEstimator, TiltsTheLeverArm) {
  auto params = TestParams();
  params.p_vessel_antenna_m = {0.0, 0.0, 10.0};
  PoseEstimator estimator(params);
  estimator.antenna().Add(Fix(0));
  auto attitude = HeadingSample(0, 0.0, "PASHR");
  attitude.roll_rad = DegToRad(10.0);  // starboard down: the antenna leans east
  attitude.pitch_rad = DegToRad(0.0);
  attitude.roll_sd_rad = DegToRad(0.05);
  estimator.attitude().Add(attitude);
  const auto pose = estimator.At(NoonPlus(0));
  EXPECT_TRUE(pose.has_attitude);
  EXPECT_NEAR(pose.p_map_m.x(), -10.0 * std::sin(DegToRad(10.0)), 1e-9);
  EXPECT_NEAR(std::sqrt(pose.covariance(6, 6)), DegToRad(0.05), 1e-12);
  EXPECT_NEAR(std::sqrt(pose.covariance(7, 7)), DegToRad(0.5), 1e-12) << "what the sentence does not say comes from config";

  auto pitched = HeadingSample(1, 0.0, "PASHR");
  pitched.roll_rad = 0.0;
  pitched.pitch_rad = DegToRad(10.0);  // bow up: the antenna leans aft, south
  estimator.attitude().Add(pitched);
  EXPECT_NEAR(estimator.At(NoonPlus(1)).p_map_m.y(), 10.0 * std::sin(DegToRad(10.0)), 1e-9);
}

TEST(PoseEstimator, StaysAtTheAntennaWithoutHeading) {
  auto params = TestParams();
  params.p_vessel_antenna_m = {-3.0, 4.0, 2.0};
  PoseEstimator estimator(params);
  estimator.antenna().Add(Fix(0));
  const auto pose = estimator.At(NoonPlus(0));
  EXPECT_NEAR(DistanceM(pose), 0.0, 1e-6);
  EXPECT_NEAR(std::sqrt(pose.covariance(0, 0)), 2.0 + 5.0, 1e-9);
}

TEST(PoseEstimator, FreesTheVelocityFromTheSwingOfTheAntenna) {
  auto params = TestParams();
  params.p_vessel_antenna_m = {2.0, 0.0, 0.0};
  PoseEstimator estimator(params);
  // At rest, bow north, turning clockwise with 0.5 rad/s: the antenna at the bow moves east.
  estimator.antenna().Add(MovingFix(0.1, 1.0, 90.0));
  estimator.attitude().Add(HeadingSample(0.0, 360.0 - RadToDeg(0.05)));
  estimator.attitude().Add(HeadingSample(0.1, 0.0));
  EXPECT_NEAR(estimator.At(NoonPlus(0.1)).velocity_map_mps.norm(), 0.0, 1e-9);
}

TEST(PoseEstimator, GivesHeave) {
  PoseEstimator estimator(TestParams());
  auto attitude = HeadingSample(0, 0.0, "PASHR");
  attitude.heave_m = -0.2;
  estimator.attitude().Add(attitude);
  EXPECT_EQ(estimator.At(NoonPlus(0)).heave_m, -0.2);
  EXPECT_TRUE(std::isnan(estimator.At(NoonPlus(1.1)).heave_m));
}

TEST(PoseEstimator, HoldsNearThePoleAndAcrossTheDateLine) {
  for (const auto& position :
       {GeodeticPosition{90.0, 0.0}, GeodeticPosition{-90.0, 10.0}, GeodeticPosition{0.0, 180.0}, GeodeticPosition{10.0, -180.0}}) {
    PoseEstimator estimator(TestParams());
    auto fix = MovingFix(0, 3.0, 90.0);
    fix.position = position;
    estimator.antenna().Add(fix);
    const auto pose = estimator.At(NoonPlus(1));
    EXPECT_EQ(pose.status, PoseStatus::kOk);
    double distance_m = 0.0;
    GeographicLib::Geodesic::WGS84().Inverse(position.latitude_deg, position.longitude_deg, pose.latitude_deg, pose.longitude_deg, distance_m);
    EXPECT_NEAR(distance_m, 3.0, 1e-3);
  }
}

}  // namespace
}  // namespace lookout::navigator
