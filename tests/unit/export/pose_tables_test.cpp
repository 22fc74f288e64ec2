// Tables of poses, and of what processes say of themselves.
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "tests/unit/export/export_logs.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {
namespace {

using TablesTest = ExportTest;

pose_t MakePose() {
  pose_t pose{};
  pose.utime_us = kStartUs;
  pose.has_attitude = true;
  pose.latitude_deg = pose.datum_latitude_deg = 1.0;
  pose.longitude_deg = pose.datum_longitude_deg = 2.0;
  pose.ellipsoid_height_m = 3.0;
  pose.heading_rad = kPi / 2.0;
  pose.roll_rad = DegToRad(-1.5);
  pose.pitch_rad = DegToRad(2.25);
  pose.velocity_map_mps[0] = -3.0;
  pose.velocity_map_mps[1] = 4.0;
  return pose;
}

TEST_F(TablesTest, PoseGivesSpeedAndCourseOverGround) {
  Add(bus::kPose, MakePose());
  ASSERT_EQ(Export("pose"), kExitFine);
  EXPECT_EQ(
      Rows()[0],
      "1700000000000000,1.000000000,2.000000000,3.0000,90.0000,-1.5000,2.2500,5.0000,323.1301,ok,-3.0000,4.0000,0.0000,0,0,0,0,0,0,0,0,0,0,0,none");
}

TEST_F(TablesTest, PoseGivesTheDiagonalOfItsCovarianceAndWhatGoesTogether) {
  auto pose = MakePose();
  for (int i = 0; i < 9; ++i) pose.covariance[i][i] = i + 1.0;
  pose.covariance[0][1] = pose.covariance[1][0] = 0.5;
  pose.covariance[3][4] = pose.covariance[4][3] = -0.25;
  Add(bus::kPose, pose);
  ASSERT_EQ(Export("pose"), kExitFine);
  EXPECT_TRUE(Rows()[0].ends_with(",1,0.5,2,3,4,-0.25,5,6,7,8,9,none")) << Rows()[0];
}

// A heading that is only the course over ground looked like that of a compass.
TEST_F(TablesTest, PoseSaysWhatItsHeadingIsFrom) {
  auto pose = MakePose();
  pose.heading_source = pose_t::HEADING_COURSE;
  Add(bus::kPose, pose);
  ASSERT_EQ(Export("pose"), kExitFine);
  EXPECT_TRUE(Rows()[0].ends_with(",course")) << Rows()[0];
}

TEST_F(TablesTest, PoseWithoutAttitudeHasNoRollAndPitchThoughTheWireHoldsZeros) {
  auto pose = MakePose();
  pose.has_attitude = false;
  pose.roll_rad = pose.pitch_rad = 0.0;
  pose.status = pose_t::STATUS_UNKNOWN;
  pose.latitude_deg = pose.longitude_deg = pose.ellipsoid_height_m = pose.heading_rad = kNaN;
  pose.velocity_map_mps[0] = pose.velocity_map_mps[1] = pose.velocity_map_mps[2] = kNaN;
  for (auto& row : pose.covariance) std::ranges::fill(row, kNaN);
  Add(bus::kPose, pose);
  ASSERT_EQ(Export("pose"), kExitFine);
  EXPECT_EQ(Rows()[0], "1700000000000000,,,,,,,,,unknown,,,,,,,,,,,,,,,none");
}

TEST_F(TablesTest, ABoatAtRestHasASpeedButNoCourse) {
  auto pose = MakePose();
  pose.velocity_map_mps[0] = pose.velocity_map_mps[1] = 0.0;
  Add(bus::kPose, pose);
  ASSERT_EQ(Export("pose"), kExitFine);
  EXPECT_NE(Rows()[0].find(",0.0000,,ok,"), std::string::npos) << Rows()[0];
}

// Noise of a receiver's Doppler gave courses all round the compass.
TEST_F(TablesTest, ASpeedThatIsNotToldFromZeroHasNoCourse) {
  auto pose = MakePose();
  pose.covariance[3][3] = pose.covariance[4][4] = 0.05 * 0.05;
  for (const double speed_mps : {0.1, 0.2}) {
    pose.velocity_map_mps[0] = 0.0;
    pose.velocity_map_mps[1] = speed_mps;
    Add(bus::kPose, pose);
  }
  ASSERT_EQ(Export("pose"), kExitFine);
  EXPECT_NE(Rows()[0].find(",0.1000,,ok,"), std::string::npos) << Rows()[0];
  EXPECT_NE(Rows()[1].find(",0.2000,0.0000,ok,"), std::string::npos) << Rows()[1];
}

// 4.05 deg of meridians converge between 8 and 12.67 E at 60 N.
TEST_F(TablesTest, CourseIsFromNorthAtTheBoatNotAtTheDatum) {
  auto pose = MakePose();
  pose.latitude_deg = pose.datum_latitude_deg = 60.0;
  pose.datum_longitude_deg = 8.0;
  pose.longitude_deg = 12.67;
  // 5 m/s due east there.
  const double turn_rad = DegToRad(4.67);
  pose.velocity_map_mps[0] = 5.0 * std::cos(turn_rad);
  pose.velocity_map_mps[1] = 5.0 * std::sin(turn_rad) * std::sin(DegToRad(60.0));
  pose.velocity_map_mps[2] = -5.0 * std::sin(turn_rad) * std::cos(DegToRad(60.0));
  Add(bus::kPose, pose);
  ASSERT_EQ(Export("pose"), kExitFine);
  EXPECT_NE(Rows()[0].find(",5.0000,90.0000,ok,5.0000,0.0000,0.0000,"), std::string::npos) << Rows()[0];
}

TEST_F(TablesTest, HealthQuotesReasonsAndSplitsIntoTrafficAndCounters) {
  health_t health{};
  health.utime_us = kStartUs;
  health.process = "lidar";
  health.host = "boat";
  health.pid = 12;
  health.state = health_t::STATE_DEGRADED;
  health.reason = "no PPS, 3 packets lost";
  health.cpu_fraction = 0.125;
  health.resident_bytes = 10'000'000;
  health.uptime_s = 60.5;
  health.interval_s = 1.0;
  health.num_channels = 1;
  health.channels.resize(1);
  health.channels[0] = {"LIDAR_SCAN", 0, 600, 0, 0, 10.0, -1, 0, -1, -1, 101'200, -1};
  health.num_counters = 1;
  health.counters.resize(1);
  health.counters[0].name = "bad_flag";
  health.counters[0].count = 9;
  Add(bus::kHealth, health);
  ASSERT_EQ(Export("health"), kExitFine);
  EXPECT_EQ(Rows()[0], "1700000000000000,lidar,degraded,\"no PPS, 3 packets lost\",0.1250,10000000,60.500,1.000,boat,12");
  ASSERT_EQ(Export("traffic"), kExitFine);
  EXPECT_EQ(Rows()[0], "1700000000000000,lidar,LIDAR_SCAN,out,600,0,0,10.000,,0,,,101200,");
  ASSERT_EQ(Export("counters"), kExitFine);
  EXPECT_EQ(Rows()[0], "1700000000000000,lidar,bad_flag,9");
}

TEST_F(TablesTest, ClockFixesAndAttitudeLeaveUnknownNumbersEmpty) {
  lidar_clock_t clock{};
  clock.utime_us = kStartUs;
  clock.time_source = lidar_clock_t::TIME_HOST;
  clock.pps = -1;
  clock.rmc_age_us = -1;
  clock.offset_s = clock.drift_ppm = clock.rotation_rpm = kNaN;
  Add(bus::kLidarClock, clock);
  gnss_fix_t fix{};
  fix.utime_us = fix.arrival_utime_us = kStartUs;
  fix.source = "udp";
  fix.sentence_type = "RMC";
  fix.quality = gnss_fix_t::QUALITY_GNSS;
  fix.num_satellites = -1;
  fix.hdop = fix.horizontal_sd_m = fix.msl_height_m = fix.geoid_separation_m = kNaN;
  fix.course_rad = kPi;
  Add(bus::kGnssFix, fix);
  attitude_t attitude{};
  attitude.utime_us = attitude.arrival_utime_us = kStartUs;
  attitude.sentence_type = "HDT";
  attitude.heading_rad = -kPi / 2.0;
  attitude.pitch_rad = attitude.roll_rad = attitude.heave_m = attitude.heading_sd_rad = attitude.pitch_sd_rad = attitude.roll_sd_rad = kNaN;
  Add(bus::kAttitude, attitude);
  ASSERT_EQ(Export("clock"), kExitFine);
  EXPECT_EQ(Rows()[0], "1700000000000000,0,host,unknown,,,,,,0,0,0,0");
  ASSERT_EQ(Export("fixes"), kExitFine);
  EXPECT_EQ(Rows()[0], "1700000000000000,1700000000000000,0,udp,RMC,gnss,,,,0.000000000,0.000000000,,,0.0000,180.0000");
  ASSERT_EQ(Export("attitude"), kExitFine);
  EXPECT_EQ(Rows()[0], "1700000000000000,1700000000000000,0,,HDT,270.0000,,,,,,");
}

TEST_F(TablesTest, ACodeOfALaterVersionIsCalledUndefined) {
  auto pose = MakePose();
  pose.status = 99;
  Add(bus::kPose, pose);
  ASSERT_EQ(Export("pose"), kExitFine);
  EXPECT_NE(Rows()[0].find(",undefined,"), std::string::npos);
}

}  // namespace
}  // namespace lookout::exporter
