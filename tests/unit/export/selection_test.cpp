#include "tools/export/selection.hpp"

#include <gtest/gtest.h>

#include "lookout/tracks_t.hpp"
#include "tests/unit/export/export_logs.hpp"

namespace lookout::exporter {
namespace {

using SelectionTest = ExportTest;

TEST(Circle, IsLatitudeLongitudeAndRadius) {
  const auto circle = ParseCircle("43.7022,-72.2895,150.5");
  ASSERT_TRUE(circle);
  EXPECT_EQ(circle->place.latitude_deg, 43.7022);
  EXPECT_EQ(circle->place.longitude_deg, -72.2895);
  EXPECT_EQ(circle->radius_m, 150.5);
  EXPECT_EQ(TextOf(*circle), "within 150.5 m of 43.7022, -72.2895");
  for (const auto* wrong :
       {"", "1,2", "1,2,3,4", "1,2,", "1,2,3m", " 1,2,3", "91,2,3", "1,181,3", "1,2,0", "1,2,-3", "nan,2,3", "1,2,inf", "1;2;3"}) {
    EXPECT_FALSE(ParseCircle(wrong)) << wrong;
  }
}

pose_t PoseWithPlace(std::int64_t utime_us, double latitude_deg, double longitude_deg) {
  pose_t pose{};
  pose.utime_us = utime_us;
  pose.latitude_deg = latitude_deg;
  pose.longitude_deg = longitude_deg;
  return pose;
}

TEST_F(SelectionTest, SpanIsHalfOpenForTablesToo) {
  for (int i = 0; i < 5; ++i) Add(bus::kPose, PoseWithPlace(kStartUs + i * 20'000, 10.0, 20.0));
  Request request{.inputs = {log_}, .table = "pose", .output = folder_ / "out", .force = true};
  request.span = {kStartUs + 20'000, kStartUs + 60'000};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 2U);
  EXPECT_TRUE(Rows()[0].starts_with(std::to_string(kStartUs + 20'000) + ","));
  request.span = {kStartUs + 80'000, std::nullopt};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Rows().size(), 1U);
  request.span = {std::nullopt, kStartUs};
  std::filesystem::remove(folder_ / "out");
  EXPECT_EQ(Export(request), kExitFailed);
  EXPECT_NE(errors_.find("holds no POSE before 2023-11-14T22:13:20.000000Z"), std::string::npos) << errors_;
  EXPECT_EQ(text_, "");
}

// "--from 10" once was 10 microseconds after 1970: the whole table came, and no word.
TEST_F(SelectionTest, SpanIsGivenAsForEveryTool) {
  for (int i = 0; i < 5; ++i) {
    pose_t pose = PoseWithPlace(kStartUs + i * 1'000'000, 10.0, 20.0);
    AddBytesAt(pose.utime_us + 5'000, bus::kPose.name, bus::Encode(pose));
  }
  Request request{.inputs = {log_}, .table = "pose", .output = folder_ / "out", .force = true};
  for (const auto* from : {"2.5", "0:02.5", "2023-11-14T22:13:22.5Z", "22:13:22.5Z", "1700000002500000"}) {
    request.from = from;
    ASSERT_EQ(Export(request), kExitFine) << from << errors_;
    EXPECT_EQ(Rows().size(), 2U) << from;
  }
  request.to = "3.5";
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Rows().size(), 1U);
  for (const auto* wrong : {"10", "soon", "2023-11-14", "2023-11-13T22:13:22Z", "12345"}) {
    request.from = wrong;
    request.to = "";
    EXPECT_EQ(Export(request), kExitUsage) << wrong;
    EXPECT_NE(errors_.find("from 2023-11-14T22:13:20.005000Z to 2023-11-14T22:13:24.005000Z"), std::string::npos) << errors_;
  }
  request.from = "3";
  request.to = "2";
  EXPECT_EQ(Export(request), kExitUsage);
  EXPECT_NE(errors_.find("--from is not before --to"), std::string::npos) << errors_;
}

// Live processes that play an old log: its times are those of measurement, the recorder's are those of the day.
TEST_F(SelectionTest, SpanIsOfTheTimesOfMeasurementWhereTheyAreFarFromThoseOfTheLog) {
  constexpr std::int64_t kDayUs = 86'400'000'000;
  for (int i = 0; i < 5; ++i) {
    AddBytesAt(kStartUs + kDayUs + i * 1'000'000, bus::kPose.name, bus::Encode(PoseWithPlace(kStartUs + i * 1'000'000, 10.0, 20.0)));
  }
  Request request{.inputs = {log_}, .table = "pose", .output = folder_ / "out", .force = true, .from = "2.5"};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Rows().size(), 2U);
  request.from = "2023-11-14T22:13:22.5Z";
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Rows().size(), 2U);
}

// Tables and maps of a log without a position once were empty, and nothing said why.
TEST_F(SelectionTest, SaysWhyThereAreNoTracksAndNoPlaces) {
  obstacles_t obstacles{};
  obstacles.utime_us = kStartUs;
  obstacles.num_obstacles = 1;
  obstacles.obstacles.resize(1);
  obstacles.obstacles[0].status = obstacle_t::STATUS_VESSEL_FRAME_ONLY;
  Add(bus::kObstacles, obstacles);
  tracks_t tracks{};
  tracks.utime_us = tracks.end_utime_us = kStartUs;
  Add(bus::kTracks, tracks);
  ASSERT_EQ(Export("tracks"), kExitFine) << errors_;
  EXPECT_NE(errors_.find("lookout-export: there are no tracks, as there is no POSE: "), std::string::npos) << errors_;
  ASSERT_EQ(Export("obstacles"), kExitFine) << errors_;
  EXPECT_NE(errors_.find("lookout-export: no obstacle has a place on the earth, as there is no POSE: "), std::string::npos) << errors_;
  Export("obstacles", "geojson");
  EXPECT_NE(errors_.find("as there is no POSE"), std::string::npos) << errors_;
  writer_ = nullptr;
  std::filesystem::remove(log_);
  Add(bus::kTracks, tracks);
  auto pose = PoseWithPlace(kStartUs, 10.0, 20.0);
  pose.status = pose_t::STATUS_NO_HEADING;
  Add(bus::kPose, pose);
  ASSERT_EQ(Export("tracks"), kExitFine) << errors_;
  EXPECT_NE(errors_.find("as POSE knows no heading (1 of 1 messages)"), std::string::npos) << errors_;
  pose.status = pose_t::STATUS_OK;
  std::filesystem::remove(log_);
  Add(bus::kTracks, tracks);
  Add(bus::kPose, pose);
  ASSERT_EQ(Export("tracks"), kExitFine) << errors_;
  EXPECT_EQ(errors_, "") << "nothing was there";
}

TEST_F(SelectionTest, CircleLeavesOutRowsThatLieOutsideOrNowhere) {
  Add(bus::kPose, PoseWithPlace(kStartUs, 10.0, 180.0));
  Add(bus::kPose, PoseWithPlace(kStartUs + 20'000, 10.0, -179.9995));  // 55 m
  Add(bus::kPose, PoseWithPlace(kStartUs + 40'000, 10.0, -179.9985));
  Add(bus::kPose, PoseWithPlace(kStartUs + 60'000, kNaN, kNaN));
  Request request{.inputs = {log_}, .table = "pose", .output = folder_ / "out", .force = true};
  request.near = ParseCircle("10,180,100");
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Rows().size(), 2U);
  request.near = ParseCircle("11,180,100");
  std::filesystem::remove(folder_ / "out");
  EXPECT_EQ(Export(request), kExitFailed);
  EXPECT_NE(errors_.find("nothing lies within 100 m of 11, 180"), std::string::npos) << errors_;
  EXPECT_EQ(text_, "");
}

// A quay is near where its end is, though its middle is not.
TEST_F(SelectionTest, CircleHoldsAnObstacleOfWhichAPartLiesInside) {
  obstacles_t message{};
  message.utime_us = kStartUs;
  message.num_obstacles = 1;
  message.obstacles.resize(1);
  auto& quay = message.obstacles[0];
  quay.id = 3;
  quay.num_map = 4;
  quay.footprint_east_m = {0.0F, 200.0F, 200.0F, 0.0F};
  quay.footprint_north_m = {0.0F, 0.0F, 2.0F, 2.0F};
  quay.num_footprint = 4;
  quay.footprint_vessel_x_m = quay.footprint_vessel_y_m = {0.0F, 0.0F, 0.0F, 0.0F};
  quay.longitude_deg = 0.0009;  // 100 m
  Add(bus::kObstacles, message);
  Request request{.inputs = {log_}, .table = "obstacles", .output = folder_ / "out", .force = true};
  request.near = ParseCircle("0,0.0018,5");
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 1U);
  EXPECT_NE(Rows()[0].find(",\"POLYGON((0.000000000 0.000000000,0.001796631 0.000000000,"), std::string::npos) << Rows()[0];
}

TEST_F(SelectionTest, SaysWhatIsWrong) {
  Add(bus::kPose, PoseWithPlace(kStartUs, 10.0, 20.0));
  Request request{.inputs = {log_}, .table = "pose", .output = folder_ / "out"};
  request.span = {kStartUs, kStartUs};
  EXPECT_EQ(Export(request), kExitUsage);
  EXPECT_NE(errors_.find("--from is not before --to"), std::string::npos) << errors_;
  request.span = {kStartUs, std::nullopt};
  request.format = "svg";
  EXPECT_EQ(Export(request), kExitUsage);
  EXPECT_NE(
      errors_.find(
          "--from and --to are for csv of every table but map; pcd and las of returns; geojson, kml and gpx of obstacles, tracks and pose only"),
      std::string::npos)
      << errors_;
  request = {.inputs = {log_}, .table = "alerts", .output = folder_ / "out", .near = ParseCircle("1,2,3")};
  EXPECT_EQ(Export(request), kExitUsage);
  EXPECT_NE(errors_.find("--near is for csv, geojson, kml and gpx of obstacles, tracks and pose only"), std::string::npos) << errors_;
  for (const auto* format : {"geojson", "kml", "gpx"}) {
    EXPECT_EQ(Export("returns", format), kExitUsage);
    EXPECT_NE(errors_.find("--format " + std::string(format) + " is for --table "), std::string::npos) << errors_;
    EXPECT_NE(errors_.find("obstacles, tracks and pose only"), std::string::npos) << errors_;
    EXPECT_EQ(Export("pose", format, 3), kExitUsage);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

}  // namespace
}  // namespace lookout::exporter
