#include "tools/import/autoferry.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/bus/channels.hpp"
#include "common/core/angles.hpp"
#include "common/messages/checks.hpp"
#include "common/messages/pose_message.hpp"
#include "tests/support/files.hpp"

namespace lookout::importer {
namespace {

using Eigen::Vector2d;

// The ferry goes east at 2 m/s; detections: none, one, two.
constexpr const char* kScans = R"([
 {"sensorID":1,"measurements":[],"ownshipPosition":[10.0,0.0],"time":1000.0,"measurement":[]},
 {"sensorID":1,"measurements":[],"ownshipPosition":[10.0,1.0],"time":1000.5,"measurement":[3.0,4.0]},
 {"sensorID":1,"measurements":[],"ownshipPosition":[10.0,2.0],"time":1001.0,"measurement":[[3.0,-20.0],[4.0,0.5]]},
 {"sensorID":1,"measurements":[],"ownshipPosition":[10.0,3.0],"time":1001.5,"measurement":[]}])";

class Autoferry : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text) const {
    support::WriteFile(folder_ / "scans.json", text);
    return folder_ / "scans.json";
  }
  std::string FaultOf(const std::string& text) const {
    try {
      ReadFerryScans(Write(text));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  }

  support::TempDir folder_;
};

TEST_F(Autoferry, DetectionsStandOnTheMap) {
  const auto scans = ReadFerryScans(Write(kScans));
  ASSERT_EQ(scans.size(), 4U);
  EXPECT_TRUE(IsFerryScans(Write(kScans)));
  EXPECT_EQ(scans[1].utime_us, 1'000'500'000);
  EXPECT_EQ(scans[1].own_m, Vector2d(1.0, 10.0));  // east, north
  EXPECT_TRUE(scans[0].detections_m.empty());
  EXPECT_EQ(scans[1].detections_m, (std::vector<Vector2d>{{5.0, 13.0}}));
  EXPECT_EQ(scans[2].detections_m, (std::vector<Vector2d>{{6.0, 13.0}, {2.5, -10.0}}));
}

TEST_F(Autoferry, WhatIsWrongIsSaidWithTheFile) {
  for (const auto* text :
       {"", "[", "{}", "[]", "[1,2]", R"([{"time":1}])", R"([{"time":1,"ownshipPosition":[0],"measurement":[]}])",
        R"([{"time":1,"ownshipPosition":["a",0],"measurement":[]}])", R"([{"time":1e99,"ownshipPosition":[0,0],"measurement":[]}])",
        R"([{"time":1,"ownshipPosition":[0,1e9],"measurement":[]}])", R"([{"time":1,"ownshipPosition":[0,0],"measurement":[1]}])",
        R"([{"time":1,"ownshipPosition":[0,0],"measurement":[[1,2],[3]]}])", R"([{"time":1,"ownshipPosition":[0,0],"measurement":[[1],3]}])",
        R"([{"time":1,"ownshipPosition":[0,0],"measurement":[1,2,3]}])",
        R"([{"time":2,"ownshipPosition":[0,0],"measurement":[]},{"time":2,"ownshipPosition":[0,0],"measurement":[]}])"}) {
    const auto fault = FaultOf(text);
    EXPECT_NE(fault.find("scans.json"), std::string::npos) << text << ": " << fault;
  }
}

// Two scans cost poses at every 20 ms between them.
TEST_F(Autoferry, ScansFarApartAreRefusedBeforeTheyCostMemory) {
  const auto scan = [](double time_s) { return R"({"time":)" + std::to_string(time_s) + R"(,"ownshipPosition":[0,0],"measurement":[]})"; };
  EXPECT_EQ(FaultOf("[" + scan(5.0) + "," + scan(65.0) + "]"), "none");
  const auto step = FaultOf("[" + scan(5.0) + "," + scan(65.5) + "]");
  EXPECT_NE(step.find("scan at 65.500000 s: more than 60 s behind the scan before"), std::string::npos) << step;
  std::string many = "[" + scan(0.0);
  for (int minute = 1; minute <= 24 * 60; ++minute) many += "," + scan(60.0 * minute);
  EXPECT_EQ(FaultOf(many + "]"), "none");
  const auto span = FaultOf(many + "," + scan(60.0 * 24 * 60 + 1.0) + "]");
  EXPECT_NE(span.find("scan at 86401.000000 s: more than a day behind the first scan"), std::string::npos) << span;
}

TEST_F(Autoferry, AMeasurementOfAnyDepthIsToldByTheTimeOfItsScan) {
  constexpr std::size_t kDepth = 1'000'000;
  const auto deep = std::string(kDepth, '[') + std::string(kDepth, ']');
  for (const auto& measurement : {"[" + deep + ",0]", "[" + deep + "," + deep + "]", deep}) {
    const auto fault = FaultOf(R"([{"time":7.5,"ownshipPosition":[0,0],"measurement":)" + measurement + "}]");
    EXPECT_NE(fault.find("scan at 7.500000 s: "), std::string::npos);
    EXPECT_LT(fault.size(), 400U);
  }
}

TEST_F(Autoferry, ObstaclesAreAsTheServicesWantThem) {
  const auto messages = ToObstacles(ReadFerryScans(Write(kScans)));
  ASSERT_EQ(messages.size(), 4U);
  for (const auto& message : messages) EXPECT_TRUE(messages::IsWellFormed(message));
  ASSERT_EQ(messages[2].num_obstacles, 2);
  const auto& obstacle = messages[2].obstacles[0];
  EXPECT_EQ(obstacle.id, 1);
  EXPECT_EQ(obstacle.position_map_m[0], 6.0);
  EXPECT_EQ(obstacle.position_map_m[1], 13.0);
  EXPECT_DOUBLE_EQ(obstacle.covariance_relative_m2[0], 4.0);
  EXPECT_DOUBLE_EQ(obstacle.covariance_m2[2], 4.25);
  // The ferry heads east: what is north by 3 m and east by 4 m is ahead by 4 m and to port by 3 m.
  EXPECT_NEAR(obstacle.center_vessel_m[0], 4.0, 1e-5);
  EXPECT_NEAR(obstacle.center_vessel_m[1], 3.0, 1e-5);
  EXPECT_NEAR(obstacle.range_m, 5.0, 1e-5);
  EXPECT_NEAR(obstacle.bearing_rad, WrapTo2Pi(-std::atan2(3.0, 4.0)), 1e-5);
  EXPECT_NEAR(obstacle.latitude_deg, kAutoferryDatum.latitude_deg + 13.0 / 111'400.0, 1e-6);
}

TEST_F(Autoferry, PosesCoverTheScansAndAreAccepted) {
  const auto scans = ReadFerryScans(Write(kScans));
  const auto poses = ToPoses(scans);
  EXPECT_LE(poses.front().utime_us, scans.front().utime_us - 900'000);
  EXPECT_GE(poses.back().utime_us, scans.back().utime_us);
  for (const auto& pose : poses) ASSERT_TRUE(std::holds_alternative<Pose>(messages::ToPose(pose)));
  const auto& pose = poses[poses.size() / 2];
  EXPECT_NEAR(pose.position_map_m[0], 2e-6 * static_cast<double>(pose.utime_us - 1'000'000'000), 1e-9);
  EXPECT_NEAR(pose.position_map_m[1], 10.0, 1e-9);
  EXPECT_NEAR(pose.velocity_map_mps[0], 2.0, 1e-9);
  EXPECT_NEAR(pose.heading_rad, kPi / 2.0, 1e-9);
}

TEST_F(Autoferry, AFerryThatStandsHasAHeading) {
  const auto poses = ToPoses(ReadFerryScans(Write(R"([{"time":1,"ownshipPosition":[0,0],"measurement":[]},
                                                      {"time":2,"ownshipPosition":[0,0],"measurement":[]}])")));
  for (const auto& pose : poses) EXPECT_EQ(pose.heading_rad, 0.0);
}

TEST_F(Autoferry, TruthIsByTargetAndTime) {
  const auto truth = ReadFerryTruth(Write(R"([[{"targetID":1,"position":[5,6,0],"time":10.5},{"targetID":2,"position":[7,8,0],"time":10.25}],
                                              [{"targetID":1,"position":[9,6,0],"time":11.5}]])"));
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_EQ(truth.at(1).at(11'500'000), Vector2d(6.0, 9.0));
  EXPECT_EQ(truth.at(2).at(10'250'000), Vector2d(8.0, 7.0));
}

// Counted apart from this reader: scans and detections of the five scenarios.
TEST_F(Autoferry, TheRealFilesHoldWhatWasCounted) {
  const auto folder = support::kRecordings / "autoferry";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const std::vector<std::array<std::size_t, 3>> kCounted{{2, 234, 412}, {3, 259, 407}, {4, 197, 392}, {13, 232, 281}, {16, 235, 272}};
  for (const auto& [scenario, num_scans, num_detections] : kCounted) {
    const auto scans = ReadFerryScans(folder / ("scenario" + std::to_string(scenario) + "_lidar_detections.json"));
    std::size_t counted = 0;
    for (const auto& scan : scans) counted += scan.detections_m.size();
    EXPECT_EQ(scans.size(), num_scans) << scenario;
    EXPECT_EQ(counted, num_detections) << scenario;
    const auto truth = ReadFerryTruth(folder / ("scenario" + std::to_string(scenario) + "_ground_truth.json"));
    EXPECT_EQ(truth.size(), 2U);
  }
}

}  // namespace
}  // namespace lookout::importer
