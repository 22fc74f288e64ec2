// Pictures of lookout-export.
#include <Eigen/Core>
#include <array>
#include <gtest/gtest.h>

#include "lookout/alerts_t.hpp"
#include "lookout/run_info_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/export/export_logs.hpp"
#include "tools/export/export.hpp"

namespace lookout::exporter {
namespace {

class SvgTest : public ExportTest {
 protected:
  void AddScan() {
    const auto scan = MakeScan(0, 4);
    auto segments = MakeSegments(scan);
    segments.segments = {MakeSegment(1, 4.0F)};
    segments.num_segments = 1;
    segments.num_parts = 2;
    Add(bus::kLidarScan, scan);
    Add(bus::kSegments, segments);
    auto further = MakeSegments(MakeScan(0, 0));
    further.part_index = 1;
    further.num_parts = 2;
    further.first_column = 4;
    further.segments = {MakeSegment(2, 8.0F)};
    further.num_segments = 1;
    Add(bus::kSegments, further);
  }
  void AddHeading(double heading_rad, std::int64_t utime_us = kStartUs, std::int32_t source = pose_t::HEADING_HDT) {
    pose_t pose{};
    pose.utime_us = utime_us;
    pose.heading_source = source;
    pose.heading_rad = heading_rad;
    Add(bus::kPose, pose);
  }
  void AddBoat() {
    run_info_t info{};
    info.num_files = 1;
    info.file_name = {"boat.txtpb"};
    info.file_text = {support::ReadFile(support::kDemoConfig / "boat.txtpb")};
    Add(bus::kRunInfo, info);
  }
};

TEST_F(SvgTest, ShowsTheSegmentsOfAllPartsOfTheScan) {
  AddScan();
  ASSERT_EQ(Export("returns", "svg"), kExitFine) << errors_;
  EXPECT_TRUE(text_.starts_with("<svg "));
  EXPECT_NE(text_.find("Scan 0: 8 returns, 2 segments"), std::string::npos);
  EXPECT_NE(text_.find("2023-11-14 22:13:20.000 UTC"), std::string::npos);
  EXPECT_NE(text_.find(">lidar x<"), std::string::npos);
}

TEST_F(SvgTest, TurnsTheBowUpWithTheConfigOfTheBoatAndNorthUpWithAHeading) {
  AddBoat();
  AddScan();
  ASSERT_EQ(Export("returns", "svg"), kExitFine) << errors_;
  EXPECT_NE(text_.find(">bow<"), std::string::npos);
  std::filesystem::remove(log_);
  AddBoat();
  AddScan();
  AddHeading(1.0);
  ASSERT_EQ(Export("returns", "svg"), kExitFine) << errors_;
  EXPECT_NE(text_.find(">N<"), std::string::npos);
  EXPECT_NE(text_.find("heading 57.3 deg"), std::string::npos);
}

// A heading that is only the course over ground looked like that of a compass.
TEST_F(SvgTest, SaysThatNorthIsUpByTheCourse) {
  AddBoat();
  AddScan();
  AddHeading(1.0, kStartUs, pose_t::HEADING_COURSE);
  ASSERT_EQ(Export("returns", "svg"), kExitFine) << errors_;
  EXPECT_NE(text_.find("north up, no compass: course 57.3 deg"), std::string::npos);
}

TEST_F(SvgTest, KnowsTheHeadingAlsoWithoutSegmentsAtThreeHundredRpm) {
  AddBoat();
  constexpr int kNumScans = 150;
  for (int seq = 0; seq < kNumScans; ++seq) {
    auto scan = MakeScan(seq);
    scan.utime_us = kStartUs + seq * 200'000;
    Add(bus::kLidarScan, scan);
    for (int i = 0; i < 10; ++i) AddHeading(1.0, scan.utime_us + i * 20'000);
  }
  for (const auto seq : {std::optional<std::int64_t>(), std::optional<std::int64_t>(70)}) {
    ASSERT_EQ(Export("returns", "svg", seq), kExitFine) << errors_;
    EXPECT_NE(text_.find("heading 57.3 deg"), std::string::npos);
  }
}

TEST_F(SvgTest, IsTheSameTextForTheSameLog) {
  AddScan();
  ASSERT_EQ(Export("returns", "svg"), kExitFine);
  const auto first = text_;
  ASSERT_EQ(Export("returns", "svg"), kExitFine);
  EXPECT_EQ(text_, first);
}

TEST_F(SvgTest, DrawsObstaclesAndSurvivesNumbersThatAreNone) {
  obstacles_t message{};
  message.utime_us = kStartUs;
  message.num_parts = 1;
  message.num_obstacles = 2;
  message.obstacles.resize(2);
  for (auto& obstacle : message.obstacles) {
    obstacle.id = 3;
    obstacle.range_m = 5.0F;
    obstacle.num_footprint = 1;
    obstacle.footprint_vessel_x_m = {3.0F};
    obstacle.footprint_vessel_y_m = {4.0F};
  }
  message.obstacles[1].range_m = std::numeric_limits<float>::quiet_NaN();
  message.obstacles[1].footprint_vessel_x_m = {std::numeric_limits<float>::infinity()};
  Add(bus::kObstacles, message);
  ASSERT_EQ(Export("obstacles", "svg"), kExitFine) << errors_;
  EXPECT_NE(text_.find("Scan 0: 2 obstacles"), std::string::npos);
  EXPECT_NE(text_.find("status: 2 ok"), std::string::npos);
  EXPECT_EQ(text_.find("inf"), std::string::npos);
}

int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST_F(SvgTest, DrawsTentativeSegmentsLightlyAndLandAsItsWaterline) {
  const auto scan = MakeScan(0, 4);
  auto segments = MakeSegments(scan);
  segments.segments = {MakeSegment(1, 4.0F), MakeSegment(2, 6.0F), MakeSegment(3, 8.0F)};
  segments.num_segments = 3;
  segments.segments[0].confidence = segment_t::CONFIDENCE_TENTATIVE;
  segments.segments[2].kind = segment_t::KIND_LAND;
  segments.segments[2].num_waterline = 3;
  segments.segments[2].waterline_x_m = {8.0F, 8.5F, 8.0F};
  segments.segments[2].waterline_y_m = {4.0F, 0.0F, -4.0F};
  segments.segments[2].waterline_time_us = {0, 1, 2};
  Add(bus::kLidarScan, scan);
  Add(bus::kSegments, segments);
  ASSERT_EQ(Export("returns", "svg"), kExitFine) << errors_;
  EXPECT_NE(text_.find("Scan 0: 8 returns, 3 segments, 1 of them tentative"), std::string::npos);
  EXPECT_EQ(CountOf(text_, "stroke-dasharray=\"2 3\""), 1) << "one outline is dashed";
  EXPECT_EQ(CountOf(text_, "stroke-width=\"2.4\""), 1) << "one is a line";
  EXPECT_EQ(CountOf(text_, "fill-opacity=\"0.14\""), 1) << "one area is filled in full";
  // Five rings of 2 m make 43 pixels a metre; the lidar stands at 500, 535, and x is up.
  EXPECT_NE(text_.find("d=\"M328.0 191.0L500.0 169.5L672.0 191.0\" fill=\"none\""), std::string::npos) << "open, from left to right";
  EXPECT_NE(text_.find(">8.0 m, land, 12 returns<"), std::string::npos);
  EXPECT_NE(text_.find(">4.0 m, tentative 94 %, 12 returns<"), std::string::npos);
  const auto in_legend = [this](const std::string& facts) { return text_.find(">" + facts + "<"); };
  EXPECT_GT(in_legend("4.0 m, tentative 94 %, 12 returns"), in_legend("8.0 m, land, 12 returns")) << "behind what is sure, though nearer";
}

TEST_F(SvgTest, DrawsTentativeObstaclesLightlyAndLandAsItsWaterline) {
  obstacles_t message{};
  message.utime_us = kStartUs;
  message.num_parts = 1;
  message.num_obstacles = 2;
  message.obstacles.resize(2);
  for (auto& obstacle : message.obstacles) {
    obstacle.id = 1;
    obstacle.range_m = 5.0F;
    obstacle.num_footprint = 3;
    obstacle.footprint_vessel_x_m = {3.0F, 4.0F, 4.0F};
    obstacle.footprint_vessel_y_m = {4.0F, 4.0F, 5.0F};
  }
  message.obstacles[0].confidence = obstacle_t::CONFIDENCE_TENTATIVE;
  message.obstacles[1].confidence = obstacle_t::CONFIDENCE_SURE;
  message.obstacles[1].kind = obstacle_t::KIND_LAND;
  message.obstacles[1].num_waterline = 2;
  message.obstacles[1].waterline_vessel_x_m = {5.0F, 5.0F};
  message.obstacles[1].waterline_vessel_y_m = {2.0F, -2.0F};
  Add(bus::kObstacles, message);
  ASSERT_EQ(Export("obstacles", "svg"), kExitFine) << errors_;
  EXPECT_NE(text_.find("Scan 0: 2 obstacles, 1 of them tentative"), std::string::npos);
  EXPECT_EQ(CountOf(text_, "stroke-dasharray=\"2 3\""), 1);
  EXPECT_EQ(CountOf(text_, "stroke-width=\"2.4\""), 1);
  EXPECT_NE(text_.find(">5.0 m at 0 deg, land<"), std::string::npos);
}

// A buoy of one return was a dot of 1.2 pixels, a tentative one of 0.8, and nobody saw it; numbers that found no room to the right were left out,
// also where there was room on another side, and one at the edge stood outside of the picture.
TEST_F(SvgTest, ShowsAnObstacleOfOneReturnAndNumbersBesideEachOther) {
  obstacles_t message{};
  message.utime_us = kStartUs;
  message.num_parts = 1;
  message.num_obstacles = 3;
  message.obstacles.resize(3);
  const std::array<Eigen::Vector2f, 3> places_m{Eigen::Vector2f(10.0F, 0.0F), Eigen::Vector2f(10.0F, -0.2F), Eigen::Vector2f(0.0F, -20.0F)};
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    auto& obstacle = message.obstacles[i];
    obstacle.id = 71 + static_cast<int>(i);
    obstacle.confidence = obstacle_t::CONFIDENCE_SURE;
    obstacle.range_m = places_m[i].norm();
    obstacle.num_footprint = 1;
    obstacle.footprint_vessel_x_m = {places_m[i].x()};
    obstacle.footprint_vessel_y_m = {places_m[i].y()};
  }
  Add(bus::kObstacles, message);
  ASSERT_EQ(Export("obstacles", "svg"), kExitFine) << errors_;
  EXPECT_EQ(CountOf(text_, "stroke-width=\"9\""), 3) << "each stands out";
  const auto in_picture = [this](int id) { return CountOf(text_, "paint-order=\"stroke\">" + std::to_string(id) + "<"); };
  EXPECT_EQ(in_picture(71), 1);
  EXPECT_EQ(in_picture(72), 1) << "on another side than 71";
  EXPECT_EQ(in_picture(73), 1) << "at the edge, on its inner side";
  const auto at = text_.rfind("x=\"", text_.find("paint-order=\"stroke\">73<"));
  EXPECT_LT(std::stod(text_.substr(at + 3)), 930.0) << "the view ends there";
}

pose_t PoseAt(std::int64_t index, double latitude_deg, double longitude_deg, int status = pose_t::STATUS_OK) {
  pose_t pose{};
  pose.utime_us = kStartUs + 20'000 * index;
  pose.seq = index;
  pose.status = status;
  pose.latitude_deg = latitude_deg;
  pose.longitude_deg = longitude_deg;
  return pose;
}

// Over the date line; 0.0009 degrees of latitude are 100 m.
TEST_F(ExportTest, DrawsTheTrackWithALineForEachStretchOfOneStatus) {
  Add(bus::kPose, PoseAt(0, kNaN, kNaN, pose_t::STATUS_UNKNOWN));
  Add(bus::kPose, PoseAt(1, 0.0, 179.9999));
  Add(bus::kPose, PoseAt(2, 0.0, 179.9999));  // no step
  Add(bus::kPose, PoseAt(3, 0.0009, 179.9999));
  Add(bus::kPose, PoseAt(4, 0.0009, -179.9992, pose_t::STATUS_COASTING));
  Add(bus::kPose, PoseAt(5, kNaN, kNaN, pose_t::STATUS_NO_POSITION));
  Add(bus::kPose, PoseAt(6, 0.0, -179.9992));
  Add(bus::kPose, PoseAt(7, 91.0, 0.0));
  ASSERT_EQ(Export("pose", "svg"), kExitFine) << errors_;
  EXPECT_NE(errors_.find("1 messages of POSE contradict themselves"), std::string::npos) << errors_;
  const std::string& text = text_;
  // A square of 100 m fills the height: 880 pixels about the middle.
  EXPECT_NE(text.find("stroke=\"#0072B2\" points=\"220.0,940.0 220.0,60.0\""), std::string::npos) << text;
  EXPECT_NE(text.find("stroke=\"#D55E00\" points=\"220.0,60.0 1100.0,60.0\""), std::string::npos) << text;
  EXPECT_NE(text.find("stroke=\"#0072B2\" points=\"1100.0,940.0 1100.0,940.0\""), std::string::npos) << text;
  EXPECT_NE(text.find(">200 m; begins at 0.000000, 179.999900<"), std::string::npos) << text;
  EXPECT_EQ(text.find("no heading"), std::string::npos);
}

// One that goes, one that stands, one that was never confirmed; land; an alert that is told in two scans.
TEST_F(ExportTest, DrawsWhatTheTrackerMadeOfTheWholeLog) {
  for (int i = 0; i < 3; ++i) {
    Add(bus::kPose, PoseAt(5 * i, 0.0009 * i, 0.0));
    tracks_t tracks{};
    tracks.utime_us = kStartUs + 100'000 * i;
    tracks.end_utime_us = tracks.utime_us + 99'000;
    tracks.num_parts = 1;
    for (const std::int64_t id : {7, 8, 9}) {
      track_t track{};
      track.id = id;
      track.status = id == 9 ? static_cast<std::int32_t>(track_t::STATUS_TENTATIVE) : static_cast<std::int32_t>(track_t::STATUS_CONFIRMED);
      track.position_map_m[0] = id == 7 ? 20.0 * i : -40.0;
      track.position_map_m[1] = 10.0 * static_cast<double>(id);
      track.speed_mps = id == 7 ? 2.0F : 0.0F;
      track.num_outline = 3;
      track.outline_east_m = {0.0F, 1.0F, 0.0F};
      track.outline_north_m = {0.0F, 0.0F, 1.0F};
      tracks.tracks.push_back(track);
    }
    tracks.num_tracks = tracks.num_scan_tracks = 3;
    tracks.num_waterline = 1;
    tracks.waterline_east_m = {30.0F};
    tracks.waterline_north_m = {100.0F};
    Add(bus::kTracks, tracks);
    alerts_t alerts{};
    alerts.utime_us = tracks.utime_us;
    alerts.end_utime_us = tracks.end_utime_us;
    if (i > 0) {
      alert_t alert{};
      alert.id = 1;
      alert.raised_utime_us = 5;
      alert.level = alert_t::LEVEL_WARNING;
      alert.state = alert_t::STATE_ACTIVE;
      alert.text = "boat 7 <in> the guard zone";
      alerts.alerts = {alert};
      alerts.num_alerts = 1;
    }
    Add(bus::kAlerts, alerts);
  }
  ASSERT_EQ(Export("tracks", "svg"), kExitFine) << errors_;
  const auto count = [this](const std::string& piece) {
    int num = 0;
    for (auto at = text_.find(piece); at != std::string::npos; at = text_.find(piece, at + 1)) ++num;
    return num;
  };
  EXPECT_EQ(count("<title>track 7<"), 1);
  EXPECT_EQ(count("<title>track 8<"), 1);
  EXPECT_EQ(count("<title>track 9<"), 0) << "it may have been clutter";
  EXPECT_EQ(count("<polygon "), 2);
  EXPECT_EQ(count("<polyline stroke-width=\"1.5\""), 1) << "only what has moved has a way";
  EXPECT_EQ(count("h2v2h-2z"), 1) << "land that came three times is drawn once";
  EXPECT_EQ(count(">2 tracks of the tracker, 1 moved; 1 alert, each where"), 1) << text_;
  EXPECT_EQ(count("r=\"7\""), 1);
  EXPECT_EQ(count(">0.2 s, warning: boat 7 &lt;in> the guard zone</text>"), 1) << text_;
  EXPECT_EQ(count("stroke=\"#0072B2\" points="), 1) << "the own track";
  EXPECT_EQ(Export("tracks", "svg", 3), kExitUsage);
}

TEST_F(ExportTest, OfPosesWithoutPositionDrawsNoTrack) {
  Add(bus::kPose, PoseAt(0, kNaN, kNaN, pose_t::STATUS_UNKNOWN));
  EXPECT_EQ(Export("pose", "svg"), kExitFailed);
  EXPECT_NE(errors_.find("no pose knows its position"), std::string::npos) << errors_;
  EXPECT_EQ(Export("pose", "svg", 3), kExitUsage);
}

}  // namespace
}  // namespace lookout::exporter
