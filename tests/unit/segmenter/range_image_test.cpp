#include "services/segmenter/core/paper/range_image.hpp"

#include <gtest/gtest.h>
#include <numeric>

#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

std::vector<std::int32_t> All(const std::vector<Return>& returns) {
  std::vector<std::int32_t> indices(returns.size());
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

int NumNeighbours(const RangeImage& image) {
  return static_cast<int>(std::ranges::count_if(image.to_next_column, [](const BeamStep& step) { return step.is_neighbour; }));
}

TEST(RangeImage, OfOwnColumnsHasAPixelForEveryReturn) {
  auto scan = test::EmptyScan({.num_columns = 10, .num_rings = 4, .num_returns = 2});
  for (int column = 0; column < 10; ++column) {
    test::SetReturn(scan, column, 1, 10.0, 0);
    test::SetReturn(scan, column, 1, 11.0, 1);
  }
  const auto returns = ClassifyReturns(scan, {}).returns;
  const auto image = ProjectToOwnColumns(scan, returns);
  EXPECT_EQ(image.num_layers, 2);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    EXPECT_TRUE(image.IsInImage(static_cast<std::int32_t>(i)));
    EXPECT_EQ(image.return_at[image.Pixel(returns[i].column, 1) + i % 2], static_cast<std::int32_t>(i));
  }
}

TEST(RangeImage, OfAWholeScanHasNoSeam) {
  const auto image = ProjectToOwnColumns(test::EmptyScan({}), {});
  EXPECT_EQ(NumNeighbours(image), 1808);
  EXPECT_NEAR(image.to_next_column.back().sin_angle, std::sin(kTwoPi / 1808), 1e-6);
}

TEST(RangeImage, OfAPartialScanDoesNotWrap) {
  const auto image = ProjectToOwnColumns(test::EmptyScan({.num_columns = 900, .width_rad = kPi}), {});
  EXPECT_EQ(NumNeighbours(image), 899);
  EXPECT_FALSE(image.to_next_column.back().is_neighbour);
}

TEST(RangeImage, KnowsColumnsAcrossAzimuthZeroAsNeighbours) {
  const auto image = ProjectToOwnColumns(test::EmptyScan({.num_columns = 90, .first_azimuth_rad = DegToRad(-9.0), .width_rad = DegToRad(18.0)}), {});
  EXPECT_EQ(NumNeighbours(image), 89);
}

TEST(RangeImage, DoesNotJoinColumnsAcrossAHole) {
  auto scan = test::EmptyScan({.num_columns = 360, .num_rings = 1});
  // One missing column is as wide as a hole can be without being one.
  scan.columns.azimuth_rad.erase(scan.columns.azimuth_rad.begin() + 100);
  scan.columns.range.pop_back();
  const auto image = ProjectToOwnColumns(scan, {});
  EXPECT_EQ(NumNeighbours(image), 358);
  EXPECT_FALSE(image.to_next_column[99].is_neighbour);
}

TEST(RangeImage, BearsColumnsThatStepBackALittle) {
  auto scan = test::EmptyScan({.num_columns = 360, .num_rings = 1});
  std::swap(scan.columns.azimuth_rad[50], scan.columns.azimuth_rad[51]);
  const auto image = ProjectToOwnColumns(scan, {});
  EXPECT_TRUE(image.to_next_column[50].is_neighbour);
  EXPECT_GT(image.to_next_column[50].sin_angle, 0.0);
}

TEST(RangeImage, OfOneColumnHasNoNeighbours) {
  EXPECT_EQ(NumNeighbours(ProjectToOwnColumns(test::EmptyScan({.num_columns = 1}), {})), 0);
  EXPECT_EQ(NumNeighbours(ProjectToOwnColumns(test::EmptyScan({.num_columns = 0}), {})), 0);
}

TEST(RangeImage, KnowsTheAngleBetweenRingsWithTheirOffsets) {
  auto scan = test::EmptyScan({.num_columns = 4, .num_rings = 2});  // at -1 and 1 degree
  const auto straight = ProjectToOwnColumns(scan, {});
  EXPECT_NEAR(straight.to_higher_ring[0].sin_angle, std::sin(DegToRad(2.0)), 1e-7);
  EXPECT_NEAR(straight.to_higher_ring[0].cos_angle, std::cos(DegToRad(2.0)), 1e-7);
  EXPECT_FALSE(straight.to_higher_ring[1].is_neighbour);
  scan.head.rings[1].azimuth_offset_rad = static_cast<float>(DegToRad(3.0));
  const double between_rad =
      std::acos(std::sin(DegToRad(1.0)) * std::sin(DegToRad(-1.0)) + std::pow(std::cos(DegToRad(1.0)), 2) * std::cos(DegToRad(3.0)));
  EXPECT_NEAR(ProjectToOwnColumns(scan, {}).to_higher_ring[0].sin_angle, std::sin(between_rad), 1e-7);
  // Projected by azimuth, the offset has gone into the column.
  EXPECT_NEAR(ProjectToAzimuths(scan, {}, {}, 512).to_higher_ring[0].sin_angle, std::sin(DegToRad(2.0)), 1e-7);
}

TEST(RangeImage, ByAzimuthKeepsTheNearestReturnOfAPixel) {
  auto scan = test::EmptyScan({.num_columns = 1440, .num_rings = 1});  // four columns to a pixel of 360
  const double range_m[]{12.0, 10.0, 11.0, 10.5};
  for (int column = 0; column < 4; ++column) test::SetReturn(scan, column, 0, range_m[column]);
  const auto returns = ClassifyReturns(scan, {}).returns;
  const auto image = ProjectToAzimuths(scan, returns, All(returns), 360);
  EXPECT_EQ(image.return_at[0], 1);
  EXPECT_FALSE(image.IsInImage(0));
  EXPECT_TRUE(image.IsInImage(1));
}

TEST(RangeImage, ByAzimuthBreaksTiesByAzimuthWhereverTheTurnBegins) {
  for (const bool is_reversed : {false, true}) {
    auto scan = test::EmptyScan({.num_columns = 720, .num_rings = 1});  // two columns to a pixel of 360
    if (is_reversed) std::swap(scan.columns.azimuth_rad[0], scan.columns.azimuth_rad[1]);
    test::SetReturn(scan, 0, 0, 10.0);
    test::SetReturn(scan, 1, 0, 10.0);
    const auto returns = ClassifyReturns(scan, {}).returns;
    EXPECT_EQ(ProjectToAzimuths(scan, returns, All(returns), 360).return_at[0], is_reversed ? 1 : 0);
  }
}

TEST(RangeImage, ByAzimuthPutsAnOffsetAcrossTheSeamIntoTheFirstPixel) {
  auto scan = test::EmptyScan({.num_columns = 360, .num_rings = 1});
  scan.head.rings[0].azimuth_offset_rad = static_cast<float>(DegToRad(0.7));
  test::SetReturn(scan, 359, 0, 10.0);  // 359.5 degrees
  const auto returns = ClassifyReturns(scan, {}).returns;
  EXPECT_EQ(ProjectToAzimuths(scan, returns, All(returns), 360).place_of[0].column, 0);
}

TEST(RangeImage, ByAzimuthLeavesOutWhatItIsNotAskedFor) {
  auto scan = test::EmptyScan({.num_columns = 360, .num_rings = 1});
  for (int column = 0; column < 3; ++column) test::SetReturn(scan, column, 0, 10.0);
  const auto returns = ClassifyReturns(scan, {}).returns;
  const std::vector<std::int32_t> indices{1};
  const auto image = ProjectToAzimuths(scan, returns, indices, 360);
  EXPECT_FALSE(image.IsInImage(0));
  EXPECT_TRUE(image.IsInImage(1));
  EXPECT_FALSE(image.IsInImage(2));
}

}  // namespace
}  // namespace lookout::segmenter
