#include <gtest/gtest.h>
#include <random>

#include "lab/eval/tracks/track_geometry.hpp"
#include "tests/unit/eval_tracks/track_cases.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

TEST(HullGap, OfSquaresThatAreApartTouchOverlapAndCross) {
  EXPECT_DOUBLE_EQ(HullGap(SquareAt({0.0, 0.0}), SquareAt({5.0, 0.0})), 3.0);
  EXPECT_DOUBLE_EQ(HullGap(SquareAt({0.0, 0.0}), SquareAt({2.0, 0.0})), 0.0);
  EXPECT_DOUBLE_EQ(HullGap(SquareAt({0.0, 0.0}), SquareAt({0.0, 0.0}, 0.2)), 0.0);
  // A cross: no corner of one is in the other.
  EXPECT_DOUBLE_EQ(HullGap({{-5.0, -0.5}, {5.0, -0.5}, {5.0, 0.5}, {-5.0, 0.5}}, {{-0.5, -5.0}, {0.5, -5.0}, {0.5, 5.0}, {-0.5, 5.0}}), 0.0);
}

TEST(HullGap, OfPointsAndLines) {
  EXPECT_DOUBLE_EQ(HullGap({{0.0, 0.0}}, {{3.0, 4.0}}), 5.0);
  EXPECT_DOUBLE_EQ(HullGap({{0.0, 1.0}}, {{-5.0, 0.0}, {5.0, 0.0}}), 1.0);
  EXPECT_DOUBLE_EQ(HullGap({{0.0, -1.0}, {0.0, 1.0}}, {{-5.0, 0.0}, {5.0, 0.0}}), 0.0);
  EXPECT_DOUBLE_EQ(HullGap({{0.5, 0.5}}, SquareAt({0.0, 0.0})), 0.0);
}

TEST(HullGap, TheBayOfAShoreIsOutside) {
  const Polygon shore_m{{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}, {6.0, 10.0}, {6.0, 4.0}, {4.0, 4.0}, {4.0, 10.0}, {0.0, 10.0}};
  EXPECT_DOUBLE_EQ(HullGap({{5.0, 8.0}}, shore_m), 1.0);
}

TEST(HullGap, MoreThanEnoughIsAllThatIsSaidOfWhatIsFar) { EXPECT_GT(HullGap(SquareAt({0.0, 0.0}), SquareAt({50.0, 50.0}), 2.0), 2.0); }

TEST(ApproachOf, HullsThatPassEachOther) {
  const auto approach = ApproachOf(SquareAt({0.0, 0.0}), {0.0, 0.0}, SquareAt({30.0, 10.0}), {-3.0, 0.0});
  EXPECT_NEAR(approach.cpa_m, 8.0, 1e-3);  // from when corner stands over corner
  EXPECT_GE(approach.tcpa_s, 28.0 / 3.0 - 1e-3);
  EXPECT_LE(approach.tcpa_s, 32.0 / 3.0 + 1e-3);
}

TEST(ApproachOf, HullsThatMeetTouchFirstAtTheirEdges) {
  const auto approach = ApproachOf(SquareAt({0.0, 0.0}), {1.0, 0.0}, SquareAt({30.0, 0.0}), {-3.0, 0.0});
  EXPECT_DOUBLE_EQ(approach.cpa_m, 0.0);
  EXPECT_NEAR(approach.tcpa_s, 28.0 / 4.0, 1e-3);
}

TEST(ApproachOf, WhatPartsOrStandsIsNearestNow) {
  EXPECT_DOUBLE_EQ(ApproachOf(SquareAt({0.0, 0.0}), {0.0, 0.0}, SquareAt({10.0, 0.0}), {3.0, 0.0}).tcpa_s, 0.0);
  EXPECT_DOUBLE_EQ(ApproachOf(SquareAt({0.0, 0.0}), {0.0, 0.0}, SquareAt({10.0, 0.0}), {3.0, 0.0}).cpa_m, 8.0);
  EXPECT_DOUBLE_EQ(ApproachOf(SquareAt({0.0, 0.0}), {1.0, 0.0}, SquareAt({10.0, 0.0}), {1.0, 0.0}).cpa_m, 8.0);
}

TEST(ApproachOf, AgreesWithLookingAtEachMoment) {
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> place_m(-60.0, 60.0);
  std::uniform_real_distribution<double> speed_mps(-5.0, 5.0);
  for (int i = 0; i < 50; ++i) {
    const auto own_m = SquareAt({0.0, 0.0}, 3.0);
    const Vector2d center_m(place_m(random), place_m(random));
    const Vector2d velocity_mps(speed_mps(random), speed_mps(random));
    const auto approach = ApproachOf(own_m, {0.5, 0.0}, SquareAt(center_m), velocity_mps);
    double least_m = 1e9;
    for (double time_s = 0.0; time_s < 120.0; time_s += 0.01) {
      least_m = std::min(least_m, HullGap(own_m, SquareAt(center_m + (velocity_mps - Vector2d(0.5, 0.0)) * time_s)));
    }
    EXPECT_NEAR(approach.cpa_m, least_m, 0.05);
  }
}

TEST(CenterOf, IsThatOfTheRectangleAndNotOfTheArea) {
  // A hull with a bow, turned by 45 deg.
  Polygon boat_m{{-3.0, -1.0}, {1.0, -1.0}, {3.0, 0.0}, {1.0, 1.0}, {-3.0, 1.0}};
  for (auto& corner_m : boat_m) corner_m = Vector2d(corner_m.x() - corner_m.y(), corner_m.x() + corner_m.y()) / std::sqrt(2.0) + Vector2d(5.0, 5.0);
  EXPECT_NEAR((CenterOf(boat_m) - Vector2d(5.0, 5.0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(CenterOf({{1.0, 2.0}}), Vector2d(1.0, 2.0));
}

}  // namespace
}  // namespace lookout::eval
