#include "services/segmenter/core/measure.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

using std::chrono::microseconds;

std::vector<Segment> MeasureAll(const Scan& scan, const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ()) {
  const auto returns = ClassifyReturns(scan, {}).returns;
  return Measure(scan, returns, {std::vector<std::int32_t>(returns.size(), 0), 1}, up);
}

TEST(Measure, GivesNothingForNoSegment) { EXPECT_TRUE(Measure(test::EmptyScan({}), {}, {}, Eigen::Vector3d::UnitZ()).empty()); }

TEST(Measure, SaysOfOneReturnWhereAndWhenItWas) {
  auto scan = test::EmptyScan({});
  test::SetReturn(scan, 100, 3, 20.0, 0, 77);
  const auto segments = MeasureAll(scan);
  ASSERT_EQ(segments.size(), 1U);
  const auto& segment = segments[0];
  // Column 100 fires at 5529.6 us, ring 3 is 6.912 us later.
  EXPECT_EQ(segment.time, test::kScanTime + microseconds(5536));
  EXPECT_EQ(segment.nearest_time, segment.time);
  EXPECT_EQ(segment.id, 1);
  EXPECT_EQ(segment.num_points, 1);
  const auto point = ClassifyReturns(scan, {}).returns[0].point;
  EXPECT_EQ(segment.centroid.x_m, point.x_m);
  EXPECT_EQ(segment.nearest.y_m, point.y_m);
  EXPECT_EQ(segment.min_z_m, point.z_m);
  EXPECT_EQ(segment.max_z_m, point.z_m);
  EXPECT_EQ(segment.mean_reflectivity, 77.0F);
  EXPECT_EQ(segment.max_reflectivity, 77);
  EXPECT_EQ(segment.length_m, 0.0F);
  ASSERT_EQ(segment.hull.size(), 1U);
  EXPECT_EQ(segment.hull[0].x_m, point.x_m);
  EXPECT_EQ(segment.hull[0].time_us, 5536);
}

TEST(Measure, RoundsTimesDownAlsoBelowZero) {
  auto scan = test::EmptyScan({.num_columns = 2, .num_rings = 1});
  scan.columns.time_ns = {-1, -2000};
  test::SetReturn(scan, 0, 0, 10.0);
  EXPECT_EQ(MeasureAll(scan)[0].time, test::kScanTime - microseconds(1));
  test::SetReturn(scan, 1, 0, 9.0);
  const auto segment = MeasureAll(scan)[0];
  EXPECT_EQ(segment.time, test::kScanTime - microseconds(2));  // mean -1.0005 us
  EXPECT_EQ(segment.nearest_time, test::kScanTime - microseconds(2));
}

TEST(Measure, TakesTheFirstOfEquallyNearReturns) {
  auto scan = test::EmptyScan({.num_columns = 4, .num_rings = 1});
  for (int column = 0; column < 4; ++column) test::SetReturn(scan, column, 0, column == 0 ? 11.0 : 10.0);
  scan.head.rings[0].elevation_rad = 0.0F;
  scan.columns.azimuth_rad = {0.0F, 0.0F, 0.0F, 0.0F};
  EXPECT_EQ(MeasureAll(scan)[0].nearest_time, test::kScanTime + microseconds(55));
}

// All numbers that are not of the shape, against the obvious code.
TEST(Measure, GivesTheExtremesAndMeansOfItsReturns) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    auto scan = test::EmptyScan({.num_columns = 200, .num_rings = 8});
    for (int i = 0; i < 30; ++i) {
      test::SetReturn(scan, static_cast<int>(random() % 200), static_cast<int>(random() % 8), 5.0 + 0.01 * (random() % 3000), 0,
                      static_cast<int>(random() % 256));
    }
    const auto returns = ClassifyReturns(scan, {}).returns;
    const auto segment = MeasureAll(scan)[0];
    const auto reflectivity = [&scan](const Return& one) { return int{scan.columns.reflectivity[static_cast<std::size_t>(one.cell)]}; };
    const auto squared_m2 = [](const Return& one) { return Eigen::Vector3d(one.point.x_m, one.point.y_m, one.point.z_m).squaredNorm(); };
    const auto z_m = [](const Return& one) { return one.point.z_m; };
    const auto mean = [&returns](const auto& of) {
      double sum = 0.0;
      for (const auto& one : returns) sum += of(one);
      return sum / static_cast<double>(returns.size());
    };
    EXPECT_EQ(segment.num_points, static_cast<std::int32_t>(returns.size()));
    EXPECT_EQ(segment.min_reflectivity, reflectivity(std::ranges::min(returns, {}, reflectivity)));
    EXPECT_EQ(segment.max_reflectivity, reflectivity(std::ranges::max(returns, {}, reflectivity)));
    EXPECT_NEAR(segment.mean_reflectivity, mean(reflectivity), 1e-4);
    EXPECT_EQ(segment.min_z_m, z_m(std::ranges::min(returns, {}, z_m)));
    EXPECT_EQ(segment.max_z_m, z_m(std::ranges::max(returns, {}, z_m)));
    EXPECT_EQ(segment.top.z_m, segment.max_z_m);
    EXPECT_NEAR(segment.centroid.z_m, mean(z_m), 1e-5);
    EXPECT_NEAR(segment.centroid.x_m, mean([](const Return& one) { return one.point.x_m; }), 1e-4);
    EXPECT_NEAR(segment.centroid.y_m, mean([](const Return& one) { return one.point.y_m; }), 1e-4);
    const auto& nearest = std::ranges::min(returns, {}, squared_m2);
    EXPECT_EQ(segment.nearest.x_m, nearest.point.x_m);
    EXPECT_EQ(segment.nearest.y_m, nearest.point.y_m);
  }
}

TEST(Measure, GivesSizeHeightAndReflectivityOfABoat) {
  std::vector<test::Wall> walls;
  test::AddBoat(walls, 15.0, 0.0, DegToRad(90.0), 6.0, 2.0, -1.0, 1.5);
  auto scan = test::EmptyScan({});
  test::Look(scan, walls);
  const auto segment = MeasureAll(scan)[0];
  EXPECT_NEAR(segment.length_m, 6.0, 0.1);  // broadside: the side is seen, 14 m away
  EXPECT_NEAR(segment.width_m, 0.0, 0.01);
  EXPECT_NEAR(segment.length_azimuth_rad, kPi / 2.0, 0.01);
  EXPECT_NEAR(segment.centroid.x_m, 14.0, 0.01);
  EXPECT_NEAR(segment.centroid.y_m, 0.0, 0.05);
  EXPECT_NEAR(segment.nearest.x_m, 14.0, 0.01);
  EXPECT_NEAR(segment.max_z_m, 14.0 * std::tan(DegToRad(5.0)), 0.05);
  EXPECT_NEAR(segment.min_z_m, 14.0 * std::tan(DegToRad(-3.0)), 0.05);
  EXPECT_EQ(segment.mean_reflectivity, 40.0F);
  EXPECT_EQ(segment.max_reflectivity, 40);
}

TEST(Measure, FindsTheTopAlongTheUpAxisOfTheVessel) {
  auto scan = test::EmptyScan({});
  test::SetReturn(scan, 0, 8, 20.0, 0, 1);    // ahead, 1 deg up
  test::SetReturn(scan, 904, 9, 10.0, 0, 1);  // astern, 3 deg up: the higher one in the lidar's own frame
  const auto level = MeasureAll(scan)[0];
  EXPECT_NEAR(level.top.x_m, -10.0, 0.1);
  // A lidar whose x axis points 10 deg up: what is ahead stands higher.
  const auto tilted = MeasureAll(scan, {std::sin(DegToRad(10.0)), 0.0, std::cos(DegToRad(10.0))})[0];
  EXPECT_NEAR(tilted.top.x_m, 20.0, 0.1);
  EXPECT_EQ(tilted.max_z_m, level.max_z_m);
}

TEST(Measure, KeepsTheHullOfATankSmall) {
  auto scan = test::EmptyScan({.num_columns = 3600});
  for (int column = 0; column < 3600; ++column) test::SetReturn(scan, column, 8, 100.0);
  const auto segment = MeasureAll(scan)[0];
  EXPECT_LE(segment.hull.size(), 256U);
  EXPECT_GT(segment.hull.size(), 200U);
}

}  // namespace
}  // namespace lookout::segmenter
