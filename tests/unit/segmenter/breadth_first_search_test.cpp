#include "services/segmenter/core/paper/breadth_first_search.hpp"

#include <gtest/gtest.h>
#include <random>

#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

Groups Search(const Scan& scan, const SearchParams& params = {}) {
  const auto returns = ClassifyReturns(scan, {}).returns;
  return SearchComponents(ProjectToOwnColumns(scan, returns), returns, params);
}

Return At(double range_m, double angle_rad) {
  return {.point = {static_cast<float>(range_m * std::cos(angle_rad)), static_cast<float>(range_m * std::sin(angle_rad)), 0.0F},
          .range_m = static_cast<float>(range_m)};
}

TEST(JoinRule, IsThePapersAngleOrDistance) {
  constexpr std::uint64_t kSeed = 3;
  std::mt19937_64 random(kSeed);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  int num_joined = 0;
  for (int i = 0; i < 100'000; ++i) {
    const SearchParams params{.angle_rad = DegToRad(uniform(0.0, 90.0)), .distance_m = uniform(0.0, 3.0)};
    const double step_rad = uniform(0.001, 0.2);
    const Return one = At(uniform(0.5, 30.0), 0.0);
    const Return other = At(uniform(0.5, 30.0), step_rad);
    const double far_m = std::max(one.range_m, other.range_m);
    const double near_m = std::min(one.range_m, other.range_m);
    const double beta_rad = std::atan2(near_m * std::sin(step_rad), far_m - near_m * std::cos(step_rad));
    const bool expected = beta_rad > params.angle_rad || std::sqrt(SquaredDistance(one.point, other.point)) < params.distance_m;
    const JoinRule rule(params);
    const BeamStep step{std::sin(step_rad), std::cos(step_rad), true};
    ASSERT_EQ(rule.Joins(one, other, step), expected) << "seed " << kSeed << ", case " << i;
    ASSERT_EQ(rule.Joins(other, one, step), expected) << "seed " << kSeed << ", case " << i;
    num_joined += expected ? 1 : 0;
  }
  EXPECT_GT(num_joined, 10'000);
  EXPECT_LT(num_joined, 90'000);
}

TEST(SearchComponents, FindsNothingInAnEmptyScan) { EXPECT_EQ(Search(test::EmptyScan({})).count, 0); }

TEST(SearchComponents, MakesOneReturnAComponent) {
  auto scan = test::EmptyScan({});
  test::SetReturn(scan, 7, 7, 10.0);
  const auto components = Search(scan);
  EXPECT_EQ(components.count, 1);
  EXPECT_EQ(components.of_return, std::vector<std::int32_t>{0});
}

TEST(SearchComponents, JoinsAWholeScanAtOneRange) {
  auto scan = test::EmptyScan({});
  for (int column = 0; column < 1808; ++column) {
    for (int ring = 0; ring < 16; ++ring) test::SetReturn(scan, column, ring, 10.0);
  }
  EXPECT_EQ(Search(scan).count, 1);
}

TEST(SearchComponents, DoesNotJoinDiagonally) {
  // x .
  // . x
  auto scan = test::EmptyScan({.num_rings = 2});
  test::SetReturn(scan, 0, 0, 10.0);
  test::SetReturn(scan, 1, 1, 10.0);
  EXPECT_EQ(Search(scan).count, 2);
}

TEST(SearchComponents, SkipsOverNothing) {
  // x . x
  auto scan = test::EmptyScan({.num_rings = 1});
  test::SetReturn(scan, 0, 0, 10.0);
  test::SetReturn(scan, 2, 0, 10.0);
  EXPECT_EQ(Search(scan).count, 2);
}

TEST(SearchComponents, SplitsAtAStepInRangeThatIsSteepAndLong) {
  auto scan = test::EmptyScan({.num_rings = 1});
  test::SetReturn(scan, 0, 0, 10.0);
  test::SetReturn(scan, 1, 0, 10.9);  // closer than 1 m
  test::SetReturn(scan, 2, 0, 12.9);  // 2 m behind
  EXPECT_EQ(Search(scan).of_return, (std::vector<std::int32_t>{0, 0, 1}));
  EXPECT_EQ(Search(scan, {.angle_rad = DegToRad(10.0), .distance_m = 0.0}).count, 3);
}

TEST(SearchComponents, JoinsUpAndDownRings) {
  auto scan = test::EmptyScan({.num_columns = 4});
  for (int ring = 0; ring < 16; ++ring) test::SetReturn(scan, 2, ring, 30.0);
  EXPECT_EQ(Search(scan).count, 1);
}

TEST(SearchComponents, JoinsAcrossTheSeamOfAWholeScanOnly) {
  auto whole = test::EmptyScan({.num_columns = 360, .num_rings = 1});
  test::SetReturn(whole, 0, 0, 10.0);
  test::SetReturn(whole, 359, 0, 10.0);
  EXPECT_EQ(Search(whole).count, 1);
  // 359 of 360 degrees: the ends are close enough for the angle rule, but the column between them is missing.
  auto partial = test::EmptyScan({.num_columns = 359, .num_rings = 1, .width_rad = DegToRad(359.0)});
  test::SetReturn(partial, 0, 0, 10.0);
  test::SetReturn(partial, 358, 0, 10.0);
  EXPECT_EQ(Search(partial).count, 2);
}

TEST(SearchComponents, FollowsBothReturnsOfAShot) {
  // A fence at 10 m before a wall at 15 m: the strongest return comes now from the one, now from the other.
  auto scan = test::EmptyScan({.num_columns = 360, .num_rings = 1, .num_returns = 2});
  for (int column = 10; column < 20; ++column) {
    test::SetReturn(scan, column, 0, column % 2 == 0 ? 10.0 : 15.0, 0);
    test::SetReturn(scan, column, 0, column % 2 == 0 ? 15.0 : 10.0, 1);
  }
  const auto components = Search(scan);
  EXPECT_EQ(components.count, 2);
  for (std::size_t i = 0; i < components.of_return.size(); ++i) EXPECT_EQ(components.of_return[i], i % 4 == 0 || i % 4 == 3 ? 0 : 1);
}

TEST(SearchComponents, JoinsReturnsOfOneShotThatAreClose) {
  auto scan = test::EmptyScan({.num_columns = 360, .num_rings = 1, .num_returns = 2});
  test::SetReturn(scan, 10, 0, 10.0, 0);
  test::SetReturn(scan, 10, 0, 10.9, 1);
  test::SetReturn(scan, 30, 0, 10.0, 0);
  test::SetReturn(scan, 30, 0, 11.1, 1);
  EXPECT_EQ(Search(scan).of_return, (std::vector<std::int32_t>{0, 0, 1, 2}));
}

}  // namespace
}  // namespace lookout::segmenter
