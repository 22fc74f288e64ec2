#include "lab/data/organise.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "common/messages/checks.hpp"
#include "lab/data/scan_message.hpp"
#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/wire.hpp"

namespace lookout::data {
namespace {

CloudPoint Point(double azimuth_deg, double elevation_deg, double range_m, std::int32_t object = kNoTrueObject) {
  const double azimuth_rad = DegToRad(azimuth_deg);
  const double elevation_rad = DegToRad(elevation_deg);
  return {static_cast<float>(range_m * std::cos(elevation_rad) * std::cos(azimuth_rad)),
          static_cast<float>(-range_m * std::cos(elevation_rad) * std::sin(azimuth_rad)), static_cast<float>(range_m * std::sin(elevation_rad)), 50,
          object};
}

// All that a sensor sees: rings `step_deg` apart from the bottom up, `num_columns` firings, ranges that tell them apart.
PointCloud Cloud(int num_rings, double step_deg, int num_columns) {
  PointCloud cloud;
  for (int ring = 0; ring < num_rings; ++ring) {
    for (int column = 0; column < num_columns; ++column) {
      const double azimuth_deg = 360.0 * (column + 0.3) / num_columns;
      cloud.points.push_back(Point(azimuth_deg, step_deg * (ring - num_rings / 2), 5.0 + 0.1 * ring + 20.0 * column / num_columns, 1 + ring % 3));
    }
  }
  return cloud;
}

TEST(Organise, AnEmptyCloudIsAnEmptyTurn) {
  const auto organised = Organise({});
  EXPECT_EQ(organised.labelled.scan.head.num_rings(), 1);
  EXPECT_EQ(organised.labelled.object.size(), organised.labelled.scan.num_cells());
}

TEST(Organise, ASinglePointHasItsPlace) {
  PointCloud cloud;
  cloud.points = {Point(123.45, 4.0, 30.0, 7)};
  const auto organised = Organise(cloud);
  EXPECT_TRUE(organised.are_rings_found);
  ASSERT_NE(organised.cell_of_point[0], OrganisedCloud::kNoCell);
  const auto cell = static_cast<std::size_t>(organised.cell_of_point[0]);
  EXPECT_EQ(organised.labelled.scan.columns.range[cell], 15000);
  EXPECT_EQ(organised.labelled.object[cell], 7);
  EXPECT_NEAR(organised.labelled.scan.head.rings[0].elevation_rad, DegToRad(4.0), 1e-6);
  EXPECT_NEAR(organised.labelled.scan.columns.azimuth_rad[cell], DegToRad(123.45), DegToRad(0.1) + 1e-6);
}

TEST(Organise, FindsTheRingsAndColumnsOfSensorsFrom16To128Rings) {
  const struct {
    int num_rings;
    double step_deg;
    int num_columns;
  } kSensors[] = {{16, 2.0, 1800}, {32, 1.33, 2170}, {64, 0.4, 2048}, {128, 0.11, 1024}};
  for (const auto& sensor : kSensors) {
    const auto cloud = Cloud(sensor.num_rings, sensor.step_deg, sensor.num_columns);
    const auto organised = Organise(cloud);
    EXPECT_TRUE(organised.are_rings_found);
    EXPECT_EQ(organised.labelled.scan.head.num_rings(), sensor.num_rings);
    EXPECT_EQ(organised.labelled.scan.columns.size(), sensor.num_columns);
    EXPECT_EQ(organised.num_hidden, 0) << sensor.num_rings;
    EXPECT_EQ(organised.num_moved, 0) << sensor.num_rings;
    // Where the segmenter sees each return, and whose it is.
    const auto classified = segmenter::ClassifyReturns(organised.labelled.scan, {});
    ASSERT_EQ(classified.returns.size(), cloud.points.size());
    std::vector<const segmenter::Return*> at(organised.labelled.scan.num_cells());
    for (const auto& one : classified.returns) at[static_cast<std::size_t>(one.cell)] = &one;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const auto cell = static_cast<std::size_t>(organised.cell_of_point[i]);
      ASSERT_NE(at[cell], nullptr);
      const auto& point = cloud.points[i];
      // 0.2 columns off, at up to 38 m.
      const double limit_m = 0.001 + 0.21 * kTwoPi / sensor.num_columns * at[cell]->range_m;
      ASSERT_LT(std::sqrt(segmenter::SquaredDistance(at[cell]->point, {point.x_m, point.y_m, point.z_m})), limit_m);
      ASSERT_EQ(organised.labelled.object[cell], point.object);
    }
  }
}

TEST(Organise, BlurredRingsBecomeBands) {
  PointCloud cloud;
  for (int i = 0; i < 5000; ++i) cloud.points.push_back(Point(0.07 * i, -20.0 + 0.005 * i, 10.0));
  const auto organised = Organise(cloud);
  EXPECT_FALSE(organised.are_rings_found);
  EXPECT_EQ(organised.labelled.scan.head.num_rings(), 64);
  EXPECT_TRUE(std::ranges::is_sorted(organised.labelled.scan.head.rings, {}, &segmenter::Ring::elevation_rad));
}

// A column for each degree: these points, and after them a ring below, whose cells are the even ones.
PointCloud WithRingBelow(std::vector<CloudPoint> points) {
  PointCloud cloud;
  cloud.points = std::move(points);
  for (int degree = 0; degree < 360; ++degree) cloud.points.push_back(Point(degree + 0.5, -10.0, 30.0));
  return cloud;
}

TEST(Organise, TheNearerPointHasTheCellAndTheOtherMovesOrIsHidden) {
  std::vector<CloudPoint> points{Point(90.5, 0.0, 20.0, 1), Point(90.6, 0.0, 10.0, 2)};
  auto organised = Organise(WithRingBelow(points));
  EXPECT_EQ(organised.cell_of_point[1], 2 * 90 + 1);
  EXPECT_EQ(organised.labelled.object[2 * 90 + 1], 2);
  EXPECT_EQ(organised.cell_of_point[0], 2 * 91 + 1);
  EXPECT_EQ(organised.num_moved, 1);
  points.push_back(Point(91.5, 0.0, 10.0, 3));
  points.push_back(Point(89.5, 0.0, 10.0, 3));
  organised = Organise(WithRingBelow(points));
  EXPECT_EQ(organised.cell_of_point[0], OrganisedCloud::kNoCell);
  EXPECT_EQ(organised.num_moved, 0);
  EXPECT_EQ(organised.num_hidden, 1);
}

TEST(Organise, AMovedPointCrossesTheSeam) {
  const auto organised = Organise(WithRingBelow({Point(359.6, 0.0, 10.0), Point(359.7, 0.0, 20.0)}));
  EXPECT_EQ(organised.cell_of_point[0], 2 * 359 + 1);
  EXPECT_EQ(organised.cell_of_point[1], 1);
}

TEST(Organise, PointsOutOfRangeAreCountedAndFarOnesMakeTheUnitLarger) {
  PointCloud cloud;
  cloud.points = {Point(1.0, 0.0, 0.0), Point(2.0, 0.0, 600.0), Point(3.0, 0.0, 300.0), Point(4.0, 0.0, 0.003)};
  const auto organised = Organise(cloud);
  EXPECT_EQ(organised.num_out_of_range, 2);
  const auto& scan = organised.labelled.scan;
  EXPECT_NEAR(scan.head.range_unit_m, 0.006, 1e-12);
  EXPECT_EQ(scan.columns.range[static_cast<std::size_t>(organised.cell_of_point[2])], 50000);
  EXPECT_EQ(scan.columns.range[static_cast<std::size_t>(organised.cell_of_point[3])], 1);  // never 0, which says no return
}

TEST(ScanMessage, ComesBackThroughTheSegmentersOwnDoor) {
  constexpr int kMaxMessageBytes = 120'000;
  const auto organised = Organise(Cloud(64, 0.4, 2048));
  const auto messages = ToScanMessages(organised.labelled.scan, "cloud", kMaxMessageBytes);
  EXPECT_EQ(messages.size(), 4U);
  for (const auto& message : messages) {
    EXPECT_LE(message.getEncodedSize(), kMaxMessageBytes);
    ASSERT_FALSE(messages::FaultOf(message, kMaxMessageBytes));
  }
  const auto scan = segmenter::ToScan(messages);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->columns.range, organised.labelled.scan.columns.range);
  EXPECT_EQ(scan->columns.azimuth_rad, organised.labelled.scan.columns.azimuth_rad);
  EXPECT_EQ(scan->columns.time_ns, organised.labelled.scan.columns.time_ns);
  EXPECT_EQ(scan->head.rings, organised.labelled.scan.head.rings);
}

}  // namespace
}  // namespace lookout::data
