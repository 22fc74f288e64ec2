#include "services/segmenter/core/returns.hpp"

#include <gtest/gtest.h>

#include "common/core/frames.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

constexpr double kRoundingM = 1e-5;

TEST(ClassifyReturns, GivesNothingForAScanWithoutReturns) {
  const auto result = ClassifyReturns(test::EmptyScan({}), {});
  EXPECT_TRUE(result.returns.empty());
  EXPECT_EQ(result.label, std::vector<std::int16_t>(28928, 0));
}

TEST(ClassifyReturns, PlacesReturnsByAzimuthOfColumnAndRingElevationAndOriginHeight) {
  auto scan = test::EmptyScan({.num_columns = 720});
  scan.head.rings[3].azimuth_offset_rad = 0.01F;
  scan.head.rings[3].origin_height_m = -0.0037F;
  for (const int column : {0, 100, 359, 360, 719}) test::SetReturn(scan, column, 3, 20.0);
  const auto result = ClassifyReturns(scan, {});
  ASSERT_EQ(result.returns.size(), 5U);
  for (const auto& one : result.returns) {
    const double azimuth_rad = double{scan.columns.azimuth_rad[static_cast<std::size_t>(one.column)]} + 0.01;
    const Eigen::Vector3d expected_m = 20.0 * BeamDirection(azimuth_rad, double{scan.head.rings[3].elevation_rad}) + Eigen::Vector3d(0, 0, -0.0037);
    EXPECT_NEAR(one.point.x_m, expected_m.x(), kRoundingM);
    EXPECT_NEAR(one.point.y_m, expected_m.y(), kRoundingM);
    EXPECT_NEAR(one.point.z_m, expected_m.z(), kRoundingM);
    EXPECT_FLOAT_EQ(one.range_m, 20.0F);
    EXPECT_EQ(one.ring, 3);
    EXPECT_EQ(one.cell, one.column * 16 + 3);
  }
}

TEST(ClassifyReturns, TakesAzimuthClockwiseSoThatNinetyDegreesIsToTheRight) {
  auto scan = test::EmptyScan({.num_columns = 360, .num_rings = 1, .first_azimuth_rad = DegToRad(-0.5)});
  test::SetReturn(scan, 90, 0, 10.0);
  const auto result = ClassifyReturns(scan, {});
  ASSERT_EQ(result.returns.size(), 1U);
  EXPECT_NEAR(result.returns[0].point.x_m, 0.0, kRoundingM);
  EXPECT_NEAR(result.returns[0].point.y_m, -10.0, kRoundingM);
}

TEST(ClassifyReturns, LeavesOutWhatIsNearerOrFartherThanTheLimitsButNotOnThem) {
  auto scan = test::EmptyScan({.num_columns = 5, .num_rings = 1});
  const double range_m[]{0.998, 1.0, 30.0, 50.0, 50.002};
  for (int column = 0; column < 5; ++column) test::SetReturn(scan, column, 0, range_m[column]);
  const auto result = ClassifyReturns(scan, {.min_range_m = 1.0, .max_range_m = 50.0});
  EXPECT_EQ(result.label, (std::vector<std::int16_t>{-1, 0, 0, 0, -1}));
  EXPECT_EQ(result.returns.size(), 3U);
}

TEST(ClassifyReturns, LeavesOutWhatIsOutsideOfASectorAcrossAzimuthZero) {
  auto scan = test::EmptyScan({.num_columns = 8, .num_rings = 1});  // at 22.5, 67.5, ... 337.5 degrees
  for (int column = 0; column < 8; ++column) test::SetReturn(scan, column, 0, 10.0);
  const auto result = ClassifyReturns(scan, {.field_of_view = {DegToRad(315.0), DegToRad(90.0)}});
  EXPECT_EQ(result.label, (std::vector<std::int16_t>{0, -3, -3, -3, -3, -3, -3, 0}));
}

TEST(ClassifyReturns, CountsTheOffsetOfTheRingForTheFieldOfView) {
  auto scan = test::EmptyScan({.num_columns = 1, .num_rings = 2, .first_azimuth_rad = DegToRad(10.0), .width_rad = 0.0});
  scan.head.rings[1].azimuth_offset_rad = static_cast<float>(DegToRad(0.2));
  test::SetReturn(scan, 0, 0, 10.0);
  test::SetReturn(scan, 0, 1, 10.0);
  const auto result = ClassifyReturns(scan, {.field_of_view = {0.0, DegToRad(10.1)}});
  EXPECT_EQ(result.label, (std::vector<std::int16_t>{0, -3}));
}

TEST(ClassifyReturns, LeavesOutTheOwnVesselInTheVesselFrame) {
  // Lidar 1 m before the reference point, turned to starboard by 90 degrees: its azimuth 0 looks to starboard, 270 ahead.
  ReturnFilter filter;
  filter.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {1.0, 0.0, 0.5}, .yaw_rad = DegToRad(-90.0)});
  filter.own_vessel_box_m = {Eigen::Vector3d(-3, -1, -1), Eigen::Vector3d(3, 1, 2)};
  auto scan = test::EmptyScan({.num_columns = 4, .num_rings = 1, .first_azimuth_rad = DegToRad(-45.0)});  // 0, 90, 180, 270 degrees
  for (const double range_m : {1.5, 3.5, 4.5}) {
    for (int column = 0; column < 4; ++column) test::SetReturn(scan, column, 0, range_m);
    // To starboard and port the side is 1 m away, astern the box ends 4 m behind the lidar, ahead 2 m.
    const std::int16_t astern = range_m < 4.0 ? -2 : 0;
    const std::int16_t ahead = range_m < 2.0 ? -2 : 0;
    EXPECT_EQ(ClassifyReturns(scan, filter).label, (std::vector<std::int16_t>{0, astern, 0, ahead})) << range_m;
  }
}

TEST(ClassifyReturns, KeepsBothReturnsOfAShot) {
  auto scan = test::EmptyScan({.num_columns = 2, .num_rings = 2, .num_returns = 2});
  test::SetReturn(scan, 1, 0, 10.0, 0);
  test::SetReturn(scan, 1, 0, 12.0, 1);
  const auto result = ClassifyReturns(scan, {});
  ASSERT_EQ(result.returns.size(), 2U);
  EXPECT_EQ(result.returns[0].cell, 4);
  EXPECT_EQ(result.returns[1].cell, 5);
  EXPECT_EQ(result.returns[1].column, 1);
  EXPECT_EQ(result.returns[1].ring, 0);
}

// A shot with one echo is reported twice in dual return; it used to be two points.
TEST(ClassifyReturns, TakesTwoReturnsOfAShotForOneWhereTheyAreNoFartherApartThanAsked) {
  struct Case {
    double second_m;
    double max_gap_m;
    bool is_repeat;
  };
  for (const Case& one : {Case{10.0, 0.1, true}, Case{10.1, 0.1, true}, Case{9.9, 0.1, true}, Case{10.102, 0.1, false}, Case{9.898, 0.1, false},
                          Case{10.0, 0.0, true}, Case{10.002, 0.0, false}, Case{10.3, 0.3, true}, Case{10.302, 0.3, false}, Case{19.0, 10.0, true}}) {
    auto scan = test::EmptyScan({.num_columns = 2, .num_rings = 2, .num_returns = 2});
    test::SetReturn(scan, 1, 0, 10.0, 0);
    test::SetReturn(scan, 1, 0, one.second_m, 1);
    test::SetReturn(scan, 1, 1, 10.0, 0);  // of another shot
    ReturnFilter filter;
    filter.max_repeat_gap_m = one.max_gap_m;
    const auto result = ClassifyReturns(scan, filter);
    EXPECT_EQ(result.returns.size(), one.is_repeat ? 2U : 3U) << one.second_m << " " << one.max_gap_m;
    ASSERT_EQ(result.repeats.size(), one.is_repeat ? 1U : 0U) << one.second_m << " " << one.max_gap_m;
    if (!one.is_repeat) continue;
    EXPECT_EQ(result.repeats[0].cell, 5);
    EXPECT_EQ(result.returns[static_cast<std::size_t>(result.repeats[0].of_return)].cell, 4);
  }
}

TEST(ClassifyReturns, ComparesEachReturnWithAllOfItsShotThatAreLookedAt) {
  auto scan = test::EmptyScan({.num_columns = 1, .num_rings = 1, .num_returns = 4});
  const double range_m[]{10.0, 20.0, 10.04, 20.08};
  for (int i = 0; i < 4; ++i) test::SetReturn(scan, 0, 0, range_m[i], i);
  const auto result = ClassifyReturns(scan, {});
  EXPECT_EQ(result.returns.size(), 2U);
  ASSERT_EQ(result.repeats.size(), 2U);
  EXPECT_EQ(result.repeats[0].of_return, 0);
  EXPECT_EQ(result.repeats[1].of_return, 1);
}

// Nothing at a limit is lost with a twin that is beyond it.
TEST(ClassifyReturns, TakesNoReturnForARepeatOfOneThatIsNotLookedAt) {
  auto scan = test::EmptyScan({.num_columns = 2, .num_rings = 1, .num_returns = 2});
  test::SetReturn(scan, 0, 0, 50.02, 0);
  test::SetReturn(scan, 0, 0, 49.98, 1);
  test::SetReturn(scan, 1, 0, 49.98, 0);
  test::SetReturn(scan, 1, 0, 50.02, 1);
  const auto result = ClassifyReturns(scan, {.min_range_m = 1.0, .max_range_m = 50.0});
  ASSERT_EQ(result.returns.size(), 2U);
  EXPECT_EQ(result.returns[0].cell, 1);
  EXPECT_EQ(result.returns[1].cell, 2);
  EXPECT_EQ(result.label, (std::vector<std::int16_t>{ToLabel(Reason::kRange), 0, 0, ToLabel(Reason::kRange)}));
  EXPECT_TRUE(result.repeats.empty());
}

}  // namespace
}  // namespace lookout::segmenter
