// Clouds as LAS and PCD, field by field.
#include "tools/export/cloud.hpp"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "common/config/boat.hpp"
#include "lookout/run_info_t.hpp"
#include "tests/unit/export/export_logs.hpp"

namespace lookout::exporter {
namespace {

template <typename Number>
Number At(const std::string& bytes, std::size_t offset) {
  Number number{};
  EXPECT_LE(offset + sizeof number, bytes.size());
  if (offset + sizeof number <= bytes.size()) std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

// Offsets of the header of LAS 1.4, table 3 of the specification.
constexpr std::size_t kVlr = 375;

struct LasPoint {
  Eigen::Vector3d p;
  int intensity, return_number, num_returns, classification, ring, label;
  double gps_s;
};

std::vector<LasPoint> PointsOf(const std::string& las) {
  const auto begin = At<std::uint32_t>(las, 96);
  const auto count = At<std::uint64_t>(las, 247);
  EXPECT_EQ(las.size(), begin + 30 * count);
  std::vector<LasPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = begin + 30 * i;
    LasPoint point{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      point.p[static_cast<Eigen::Index>(axis)] =
          At<std::int32_t>(las, at + 4 * axis) * At<double>(las, 131 + 8 * axis) + At<double>(las, 155 + 8 * axis);
    point.intensity = At<std::uint16_t>(las, at + 12);
    point.return_number = At<std::uint8_t>(las, at + 14) & 15;
    point.num_returns = At<std::uint8_t>(las, at + 14) >> 4;
    point.classification = At<std::uint8_t>(las, at + 16);
    point.ring = At<std::uint8_t>(las, at + 17);
    point.label = At<std::uint16_t>(las, at + 20);
    point.gps_s = At<double>(las, at + 22);
    points.push_back(point);
  }
  return points;
}

TEST(Las, HoldsWhatTheSpecificationAsksFor) {
  const auto writer = MakeLasWriter(CloudFrame::kVessel, "lookout-export 1.0");
  std::string points;
  // 2017-01-01 00:00:00 UTC was 1167264018 s of GPS time (18 leap seconds), a second before it had 17.
  writer->BeginScan(7, 1'483'228'799'500'000, {});
  EXPECT_TRUE(writer->Add({.p = {1.0, -2.0, 3.00004}, .reflectivity = 255, .label = 300, .ring = 5, .utime_us = 1'483'228'800'000'000}, points));
  EXPECT_TRUE(
      writer->Add({.p = {-4.0, 5.0, 6.0}, .reflectivity = 1, .return_number = 2, .num_returns = 2, .utime_us = 1'483'228'799'500'000}, points));
  EXPECT_FALSE(writer->Add({.p = {300'000.0, 0.0, 0.0}}, points)) << "beyond 32 bits";
  const auto head = writer->Head();
  EXPECT_EQ(head.size(), At<std::uint32_t>(head, 96));
  const auto las = head + points;

  EXPECT_EQ(las.substr(0, 4), "LASF");
  EXPECT_EQ(At<std::uint16_t>(las, 6), 17) << "adjusted standard GPS time, WKT";
  EXPECT_EQ(las[24], 1);
  EXPECT_EQ(las[25], 4);
  EXPECT_EQ(las.substr(58, 19), std::string("lookout-export 1.0\0", 19));
  EXPECT_EQ(At<std::uint16_t>(las, 90), 366) << "day";
  EXPECT_EQ(At<std::uint16_t>(las, 92), 2016);
  EXPECT_EQ(At<std::uint16_t>(las, 94), 375);
  EXPECT_EQ(At<std::uint32_t>(las, 100), 1U);
  EXPECT_EQ(las[104], 6);
  EXPECT_EQ(At<std::uint16_t>(las, 105), 30);
  EXPECT_EQ(las.substr(107, 24), std::string(24, '\0')) << "counts of older versions";
  const double bounds[]{1.0, -4.0, 5.0, -2.0, 6.0, 3.0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(At<double>(las, 179 + 8 * i), bounds[i], 1e-4) << i;
  EXPECT_EQ(At<std::uint64_t>(las, 247), 2U);
  EXPECT_EQ(At<std::uint64_t>(las, 255), 1U);
  EXPECT_EQ(At<std::uint64_t>(las, 263), 1U);
  EXPECT_EQ(las.substr(kVlr + 2, 15), "LASF_Projection");
  EXPECT_EQ(At<std::uint16_t>(las, kVlr + 18), 2112);
  const auto wkt = las.substr(kVlr + 54, At<std::uint16_t>(las, kVlr + 20));
  EXPECT_TRUE(wkt.starts_with("LOCAL_CS[\"vessel")) << wkt;
  EXPECT_EQ(wkt.find('\0'), wkt.size() - 1);
  EXPECT_EQ(std::ranges::count(wkt, '['), std::ranges::count(wkt, ']'));

  const auto read = PointsOf(las);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_LT((read[0].p - Eigen::Vector3d(1.0, -2.0, 3.0)).norm(), 1e-4);
  EXPECT_EQ(read[0].intensity, 65535);
  EXPECT_EQ(read[0].classification, 1);
  EXPECT_EQ(read[0].label, 300);
  EXPECT_EQ(read[0].ring, 5);
  EXPECT_EQ(read[0].gps_s, 1'167'264'018.0 - 1e9);
  EXPECT_EQ(read[1].gps_s, 1'167'264'016.5 - 1e9);
  EXPECT_EQ(read[1].return_number, 2);
  EXPECT_EQ(read[1].num_returns, 2);
  EXPECT_EQ(read[1].classification, 0) << "its label is not known";
}

TEST(Las, WithoutAPointHasAHeadOfTheSameLength) {
  const auto writer = MakeLasWriter(CloudFrame::kEarth, "x");
  const auto empty = writer->Head();
  std::string points;
  EXPECT_TRUE(writer->Add({.p = {-72.25, 43.5, 100.0}}, points));
  EXPECT_EQ(writer->Head().size(), empty.size());
  EXPECT_TRUE(PointsOf(empty).empty());
  EXPECT_NEAR(PointsOf(writer->Head() + points).at(0).p.x(), -72.25, 1e-12);
}

class Clouds : public ExportTest {
 protected:
  void AddBoat() {
    run_info_t info{};
    info.num_files = 1;
    info.file_name = {"boat.txtpb"};
    info.file_text = {support::ReadFile(support::kDemoConfig / "boat.txtpb")};
    Add(bus::kRunInfo, info);
  }
  // At anchor at the datum, bow to the east; scans of 0.1 s, POSE each 20 ms behind them.
  void AddScans(int num_scans, bool has_poses = true) {
    for (int i = 0; i < num_scans; ++i) {
      Add(bus::kLidarScan, MakeScan(i));
      Add(bus::kSegments, MakeSegments(MakeScan(i), static_cast<std::int16_t>(i + 1)));
      for (int k = 0; has_poses && k < 5; ++k) AddPose(kStartUs + 100'000 * i + 20'000 * k);
    }
    for (int k = 0; has_poses && k < 25; ++k) AddPose(kStartUs + 100'000 * num_scans + 20'000 * k);
  }
  void AddPose(std::int64_t utime_us, bool is_relative = false) {
    pose_t pose{};
    pose.utime_us = utime_us;
    pose.datum_latitude_deg = 43.5;
    pose.datum_longitude_deg = -72.25;
    pose.datum_ellipsoid_height_m = 100.0;
    pose.heading_source = pose_t::HEADING_HDT;
    pose.heading_rad = std::numbers::pi / 2;
    for (int i = 0; i < 9; ++i) pose.covariance[i][i] = 1.0;
    if (is_relative) {
      pose.status = pose_t::STATUS_RELATIVE;
      pose.datum_latitude_deg = pose.datum_longitude_deg = std::numeric_limits<double>::quiet_NaN();
      pose.datum_ellipsoid_height_m = 1.8e12;
    }
    Add(bus::kPose, pose);
  }
  Request Of(const std::string& format, CloudFrame frame = CloudFrame::kLidar) {
    return {.inputs = {log_}, .table = "returns", .format = format, .output = folder_ / "out", .force = true, .frame = frame};
  }
  std::string Body() const {
    const std::string end = "DATA binary\n";
    return text_.substr(text_.find(end) + end.size());
  }
  const config::BoatFacts boat_ = config::LoadBoat(support::kDemoConfig);
};

TEST_F(Clouds, OfLasAreOfTheLastWholeScanOrOfAPartOrOfAll) {
  AddScans(3, false);
  ASSERT_EQ(Export(Of("las")), kExitFine) << errors_;
  auto points = PointsOf(text_);
  ASSERT_EQ(points.size(), 4U);
  EXPECT_EQ(points[0].label, 3);
  EXPECT_LT((points[1].p - Eigen::Vector3d(10.0, 0.0, 0.0)).norm(), 1e-4);
  auto request = Of("las");
  request.scan = 1;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(PointsOf(text_).at(0).label, 2);
  request = Of("las");
  request.all_scans = true;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  points = PointsOf(text_);
  ASSERT_EQ(points.size(), 12U);
  EXPECT_EQ(points[0].label, 1);
  EXPECT_EQ(points[11].label, 3);
  request = Of("las");
  request.span = {kStartUs + 100'000, kStartUs + 200'000};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  ASSERT_EQ(PointsOf(text_).size(), 4U);
  EXPECT_EQ(PointsOf(text_)[0].label, 2);
}

TEST_F(Clouds, OfSeveralScansAreOnePcd) {
  AddScans(3, false);
  auto request = Of("pcd");
  request.all_scans = true;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_NE(text_.find("\nSIZE 4 4 4 4 4 2 8\n"), std::string::npos);
  EXPECT_NE(text_.find("\nWIDTH 12\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 12\nDATA binary\n"), std::string::npos) << text_.substr(0, 512);
  EXPECT_NE(text_.find("; 3 scans from this one on"), std::string::npos);
  constexpr std::size_t kPointBytes = 3 * 4 + 4 + 4 + 2 + 8;
  ASSERT_EQ(Body().size(), 12 * kPointBytes);
  EXPECT_EQ(At<float>(Body(), 9 * kPointBytes), 10.0F);
  EXPECT_DOUBLE_EQ(At<double>(Body(), 8 * kPointBytes + 22), 0.2);
  request.output = std::nullopt;
  EXPECT_EQ(Export(request), kExitUsage);
  EXPECT_NE(errors_.find("--format pcd of several scans needs --out"), std::string::npos) << errors_;
  request = Of("pcd");
  request.scan = 1;
  request.span = {kStartUs, std::nullopt};
  EXPECT_EQ(Export(request), kExitUsage);
}

TEST_F(Clouds, StandInTheFrameOfTheVessel) {
  AddBoat();
  AddScans(1, false);
  ASSERT_EQ(Export(Of("las", CloudFrame::kVessel)), kExitFine) << errors_;
  const auto points = PointsOf(text_);
  ASSERT_EQ(points.size(), 4U);
  EXPECT_LT((points[1].p - boat_.T_vessel_lidar * Eigen::Vector3d(10.0, 0.0, 0.0)).norm(), 1e-4);
}

TEST_F(Clouds, OfTheSecondLidarAreOfItsScansByItsMounting) {
  run_info_t info{};
  info.num_files = 1;
  info.file_name = {"boat.txtpb"};
  info.file_text = {support::ReadFile(support::kDemoConfig / "boat.txtpb") +
                    "\nlidar_2 { x_m: -1 y_m: 0.5 z_m: 2 roll_deg: 0 pitch_deg: 0 yaw_deg: 90 }\n"};
  Add(bus::kRunInfo, info);
  Add(bus::kLidarScan, MakeScan(0));
  Add(bus::kLidarScan2, MakeScan(7, 3));
  Add(bus::kSegments2, MakeSegments(MakeScan(7, 3), 5));
  auto request = Of("las", CloudFrame::kVessel);
  request.lidar = 2;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  const auto points = PointsOf(text_);
  ASSERT_EQ(points.size(), 6U);
  EXPECT_EQ(points[1].label, 5);
  EXPECT_LT((points[1].p - Eigen::Vector3d(-1.0, 10.5, 2.0)).norm(), 1e-4) << points[1].p.transpose();
  request.table = "tracks";
  request.format = "csv";
  request.frame = CloudFrame::kLidar;
  EXPECT_EQ(Export(request), kExitUsage);
  EXPECT_NE(errors_.find("--lidar 2 is for"), std::string::npos) << errors_;
}

TEST_F(Clouds, OfASecondLidarThatTheBoatLacksHaveNoMounting) {
  AddBoat();
  Add(bus::kLidarScan2, MakeScan(0));
  auto request = Of("las", CloudFrame::kVessel);
  request.lidar = 2;
  EXPECT_EQ(Export(request), kExitFailed);
  EXPECT_NE(errors_.find("the log says nothing of the mounting of the lidar"), std::string::npos) << errors_;
}

TEST_F(Clouds, NeedTheMountingForTheFrameOfTheVessel) {
  AddScans(1);
  EXPECT_EQ(Export(Of("las", CloudFrame::kVessel)), kExitFailed);
  EXPECT_NE(errors_.find("the log says nothing of the mounting of the lidar"), std::string::npos) << errors_;
}

TEST_F(Clouds, StandOnTheEarthWhereTheBoatWasWhenEachLaserFired) {
  AddBoat();
  AddScans(2);
  const Eigen::Vector3d p_vessel_m = boat_.T_vessel_lidar * Eigen::Vector3d(10.0, 0.0, 0.0);
  const Eigen::Vector3d& east_m = p_vessel_m;  // bow to the east, port to the north
  auto request = Of("pcd", CloudFrame::kEarth);
  request.all_scans = true;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_NE(text_.find("east, north and up of the datum, metres; datum 43.500000000 -72.250000000 deg, 100.000 m"), std::string::npos);
  constexpr std::size_t kPointBytes = 3 * 4 + 4 + 4 + 2 + 8;
  ASSERT_EQ(Body().size(), 8 * kPointBytes);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(At<float>(Body(), kPointBytes + 4 * axis), east_m[static_cast<Eigen::Index>(axis)], 1e-5) << axis;

  ASSERT_EQ(Export(Of("las", CloudFrame::kEarth)), kExitFine) << errors_;
  const auto points = PointsOf(text_);
  ASSERT_EQ(points.size(), 4U);
  const auto place = LocalFrame({43.5, -72.25, 100.0}).Reverse(east_m);
  EXPECT_NEAR(points[1].p.x(), place.longitude_deg, 1e-9);
  EXPECT_NEAR(points[1].p.y(), place.latitude_deg, 1e-9);
  EXPECT_NEAR(points[1].p.z(), place.ellipsoid_height_m, 1e-3);
  const auto wkt = text_.substr(kVlr + 54, At<std::uint16_t>(text_, kVlr + 20));
  EXPECT_TRUE(wkt.starts_with("GEOGCS[\"WGS 84\"")) << wkt;
}

TEST_F(Clouds, LeaveOutWhatHasNoPlaceOnTheEarth) {
  AddBoat();
  Add(bus::kLidarScan, MakeScan(0));
  Add(bus::kSegments, MakeSegments(MakeScan(0)));
  for (int k = 0; k < 25; ++k) AddPose(kStartUs + 300'000 + 20'000 * k);
  Add(bus::kLidarScan, MakeScan(4));
  Add(bus::kSegments, MakeSegments(MakeScan(4)));
  for (int k = 25; k < 60; ++k) AddPose(kStartUs + 300'000 + 20'000 * k);
  auto request = Of("las", CloudFrame::kEarth);
  request.all_scans = true;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(PointsOf(text_).size(), 4U);
  EXPECT_NE(errors_.find("4 returns have no place on the earth, and are left out"), std::string::npos) << errors_;
}

TEST_F(Clouds, OnTheEarthNeedPoses) {
  AddBoat();
  AddScans(1, false);
  EXPECT_EQ(Export(Of("las", CloudFrame::kEarth)), kExitFailed);
  EXPECT_NE(errors_.find("no return has a place on the earth"), std::string::npos) << errors_;
}

// Not even where it would be on the map: degrees of a frame that began anywhere are none.
TEST_F(Clouds, OnTheEarthNeedAFrameOnTheEarth) {
  AddBoat();
  AddScans(1, false);
  for (int k = 0; k < 60; ++k) AddPose(kStartUs + 20'000 * k, true);
  for (const auto* format : {"las", "pcd"}) {
    EXPECT_EQ(Export(Of(format, CloudFrame::kEarth)), kExitFailed) << format;
    EXPECT_NE(errors_.find("no return has a place on the earth"), std::string::npos) << errors_;
  }
}

// More than is written at once: the head is mended in the file.
TEST_F(Clouds, OfManyScansHaveTheirCountsInTheHead) {
  for (int i = 0; i < 3000; ++i) {
    Add(bus::kLidarScan, MakeScan(i));
    Add(bus::kSegments, MakeSegments(MakeScan(i)));
  }
  auto request = Of("las");
  request.all_scans = true;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(PointsOf(text_).size(), 12'000U);
  const auto first = text_;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(text_, first);
}

}  // namespace
}  // namespace lookout::exporter
