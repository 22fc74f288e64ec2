// The whole method on made scans: a basin, a boat that goes round in it, and a boat.txtpb that is wrong.
#include "tests/unit/calibrate/made_basin.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tools/calibrate/coarse_search.hpp"
#include "tools/calibrate/picture.hpp"
#include "tools/calibrate/report.hpp"
#include "tools/calibrate/turn_rate.hpp"

namespace lookout::calibrate {
namespace {

TEST(MadeBasin, AMountingThatIsWrongByDegreesIsFound) {
  const auto params = ParamsWith(RotationOf({DegToRad(4.0), DegToRad(-6.0), DegToRad(8.0)}));
  const auto found = Calibrate(Basin(), params);
  ASSERT_EQ(found.refusal, "");
  EXPECT_NEAR(RadToDeg(found.roll.value), 0.0, 0.3);
  EXPECT_NEAR(RadToDeg(found.pitch.value), 0.0, 0.3);
  EXPECT_NEAR(RadToDeg(found.yaw.value), 0.0, 0.15);
  EXPECT_EQ(found.turned_in_words, "");
  EXPECT_LT(found.after_m, 0.3 * found.before_m);
  const auto report = ReportOf(found, params.boat);
  EXPECT_NE(report.find("for boat.txtpb:\nlidar { x_m: 0 y_m: 0 z_m: 1.5 roll_deg: "), std::string::npos) << report;
  const auto picture = PictureOf(Basin(), found, params);
  EXPECT_EQ(picture.rfind("<svg ", 0), 0U);
  EXPECT_EQ(picture.find("d=\"\""), std::string::npos) << "a map without what stands";
  EXPECT_NE(picture.find("</svg>"), std::string::npos);
}

TEST(MadeBasin, TheHeightAboveTheWaterIsThatOfTheFeetOfWalls) {
  auto params = ParamsWith(Eigen::Matrix3d::Identity());
  Assumed assumed;
  assumed.T_vessel_lidar = params.boat.T_vessel_lidar;
  const auto height = HeightAboveWater(Basin().scans, Basin().track, assumed);
  ASSERT_TRUE(height);
  EXPECT_NEAR(height->lidar_above_water_m, odometer::kLidarHeightM, 0.15) << "a boat that does not roll sees the foot between two rings";
  assumed.T_vessel_lidar.linear() = RotationAboutX(kPi / 2);
  EXPECT_FALSE(HeightAboveWater(Basin().scans, Basin().track, assumed)) << "rings that do not lie level";
}

TEST(MadeBasin, ALidarThatIsTurnedByARightAngleIsNamed) {
  struct Turn {
    Eigen::Matrix3d R;
    const char* words;
  };
  const std::vector<Turn> turns{{RotationAboutZ(kPi / 2), "to starboard"},
                                {RotationAboutZ(kPi), "astern"},
                                {RotationAboutX(kPi), "upside down"},
                                {RotationAboutX(kPi / 2), "rolled by 90 deg"}};
  for (const auto& [wrong, words] : turns) {
    Assumed assumed;
    assumed.T_vessel_lidar = ParamsWith(wrong * RotationAboutZ(DegToRad(7.0))).boat.T_vessel_lidar;
    const auto coarse = SearchCoarsely(Basin().scans, Basin().track, assumed);
    ASSERT_TRUE(coarse);
    EXPECT_TRUE(coarse->is_clear) << words;
    EXPECT_LT(RadToDeg(AngleOf(coarse->R_vessel_lidar)), 8.0) << words;
    const auto turned = NearestCubeRotation(coarse->R_vessel_lidar * assumed.T_vessel_lidar.linear().transpose());
    EXPECT_NE(TurnInWords(turned).find(words), std::string::npos) << TurnInWords(turned);
  }
}

TEST(MadeBasin, TheHeadingOfTheCourseAloneIsRefusedWithTheReason) {
  Recording recording;
  recording.scans = Basin().scans;
  recording.num_poses = recording.num_course_alone = 2000;
  const auto found = Calibrate(recording, ParamsWith(Eigen::Matrix3d::Identity()));
  EXPECT_NE(found.refusal.find("the heading is the course over ground alone"), std::string::npos) << found.refusal;
  recording.num_course_alone = 0;
  recording.num_no_attitude = 2000;
  EXPECT_NE(Calibrate(recording, ParamsWith(Eigen::Matrix3d::Identity())).refusal.find("roll and pitch are not measured"), std::string::npos);
}

TEST(MadeBasin, AnEmptyRecordingIsRefused) { EXPECT_TRUE(Calibrate({}, ParamsWith(Eigen::Matrix3d::Identity())).IsRefused()); }

TEST(MadeBasin, WaterAloneIsRefusedAndTheMotionIsNamed) {
  Recording recording;
  recording.track = Basin().track;
  recording.num_poses = Basin().num_poses;
  for (int i = 0; i < 200; ++i) recording.scans.push_back(odometer::MakeScan(i, {}, kRound));
  const auto found = Calibrate(recording, ParamsWith(Eigen::Matrix3d::Identity()));
  EXPECT_TRUE(found.IsRefused());
  ASSERT_FALSE(found.missing.empty());
  EXPECT_NE(found.missing.front().find("go near what stands"), std::string::npos);
}

TEST(TurnLatency, IsThatOfTheHeading) {
  // The bow swings; the motions are those of the lidar, POSE comes 80 ms later.
  std::vector<odometer::Motion> motions;
  PoseTrack track;
  const auto bearing = [](double time_s) { return 0.3 * std::sin(0.8 * time_s); };  // clockwise
  const auto time = [](double time_s) { return Utime(std::chrono::microseconds(std::llround(1e6 * time_s))); };
  for (int i = 0; i < 300; ++i) {
    odometer::Motion motion{time(100.0 + 0.1 * i), time(100.1 + 0.1 * i)};
    motion.turn_rad = bearing(0.1 * (i + 1)) - bearing(0.1 * i);
    motions.push_back(motion);
  }
  for (int i = -100; i < 1700; ++i) {
    TrackPose pose;
    pose.time = time(100.0 + 0.02 * i);
    pose.T_map_vessel.linear() = RotationMapVessel(bearing(0.02 * i - 0.08), 0.0, 0.0);
    track.Add(pose);
  }
  const auto latency = LatencyByTurning(motions, track);
  ASSERT_TRUE(latency);
  EXPECT_NEAR(latency->latency_s, 0.08, 0.003);
  motions.resize(40);
  EXPECT_FALSE(LatencyByTurning(motions, track)) << "too few motions";
}

}  // namespace
}  // namespace lookout::calibrate
