#include "lab/eval/tracks/alert_geometry.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "common/core/angles.hpp"
#include "lab/eval/tracks/track_geometry.hpp"
#include "tests/unit/eval_tracks/track_cases.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

constexpr ApproachQuestion kQuestion{5.0, 30.0, 33.0};

Polygon RoundOf(const Vector2d& center_m, double radius_m, int num_corners, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.5, 1.0);
  Polygon corners_m;
  for (int i = 0; i < num_corners; ++i) {
    const double angle_rad = kTwoPi * i / num_corners;
    corners_m.emplace_back(center_m + radius_m * share(random) * Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  }
  return corners_m;
}

TEST(HullOutline, GapIsThatOfTheObviousComputation) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-40.0, 40.0);
  for (int i = 0; i < 300; ++i) {
    const auto outline_m = RoundOf({place(random), place(random)}, 15.0, 40, random);
    const auto hull_m = RoundOf({place(random), place(random)}, 2.0, 5, random);
    const double gap_m = HullGap(outline_m, hull_m);
    const HullOutline prepared(outline_m);
    EXPECT_NEAR(prepared.Gap(hull_m), gap_m, 1e-9) << i;
    const double bounded_m = prepared.Gap(hull_m, 3.0);
    if (gap_m <= 3.0) {
      EXPECT_NEAR(bounded_m, gap_m, 1e-9) << i;
    } else {
      EXPECT_GT(bounded_m, 3.0) << i;
      EXPECT_LE(bounded_m, gap_m + 1e-9) << i;
    }
  }
}

// In the box around a shore that runs askew one may be far from it.
TEST(HullOutline, WhatIsMoreThanEnoughIsMore) {
  const HullOutline shore({{-100.0, -100.0}, {100.0, 100.0}, {90.0, 110.0}, {-110.0, -90.0}});
  EXPECT_GT(shore.Distance({50.0, -50.0}, 3.0), 3.0);
}

TEST(HullOutline, OneWithinTheOtherHasNoGap) {
  EXPECT_DOUBLE_EQ(HullOutline(SquareAt({0.0, 0.0}, 20.0)).Gap(SquareAt({1.0, 1.0})), 0.0);
  EXPECT_DOUBLE_EQ(HullOutline(SquareAt({0.0, 0.0})).Gap(SquareAt({1.0, 1.0}, 20.0)), 0.0);
  EXPECT_DOUBLE_EQ(HullOutline(SquareAt({0.0, 0.0})).Distance({4.0, 0.0}), 3.0);
}

TEST(ApproachWithin, OfOneThatPassesAbeamIsItsGapThen) {
  const HullOutline thing(SquareAt({30.0, 8.0}));
  const auto found = ApproachWithin(kQuestion, SquareAt({0.0, 0.0}), {{2.0, 0.0}, 0.0}, thing, {});
  EXPECT_NEAR(found.least_m, 6.0, 1e-9);
  EXPECT_NEAR(found.greatest_m, 6.0, 1e-9);
  EXPECT_TRUE(std::isinf(found.until_limit_s));
}

TEST(ApproachWithin, SaysWhenTheLimitIsPassed) {
  const HullOutline thing(SquareAt({47.0, 0.0}));  // 45 m ahead, so nearer than 5 m in 20 s
  const auto found = ApproachWithin(kQuestion, SquareAt({0.0, 0.0}), {{2.0, 0.0}, 0.0}, thing, {});
  EXPECT_NEAR(found.least_m, 0.0, 1e-9);
  EXPECT_NEAR(found.until_limit_s, 20.0, 0.2);
}

TEST(ApproachWithin, WhatComesLaterThanTheTimeAheadIsFar) {
  const HullOutline thing(SquareAt({102.0, 0.0}));  // 100 m ahead: 40 m are left after 30 s
  const auto found = ApproachWithin(kQuestion, SquareAt({0.0, 0.0}), {{2.0, 0.0}, 0.0}, thing, {});
  EXPECT_GT(found.least_m, kQuestion.limit_m + kApproachCapM);
}

TEST(ApproachWithin, WhereBothStandNothingApproaches) {
  const HullOutline thing(SquareAt({3.0, 0.0}));
  EXPECT_TRUE(std::isinf(ApproachWithin(kQuestion, SquareAt({0.0, 0.0}), {{0.05, 0.0}, 0.0}, thing, {}).least_m));
}

// A boat that turns off what lies ahead: the tangent leads to it, the turn does not.
TEST(ApproachWithin, OfATurnIsKnownFromSeveralEnds) {
  const HullOutline ahead(SquareAt({40.0, 0.0}));
  const MovingHull turning{{2.0, 0.0}, DegToRad(10.0)};
  const auto found = ApproachWithin(kQuestion, SquareAt({0.0, 0.0}), turning, ahead, {});
  EXPECT_NEAR(found.straight_m, 0.0, 1e-9);
  EXPECT_NEAR(found.least_m, 0.0, 1e-9);
  EXPECT_GT(found.greatest_m, 8.0);
  // What lies on the arc, 90 degrees on, is met by the turn alone: radius 11.5 m.
  const HullOutline on_arc(SquareAt({11.5, 11.5}, 1.0));
  const auto met = ApproachWithin(kQuestion, SquareAt({0.0, 0.0}), turning, on_arc, {});
  EXPECT_NEAR(met.least_m, 0.0, 1e-9);
  EXPECT_GT(met.straight_m, 5.0);
}

TEST(ApproachWithin, AgreesWithTheExactOneOfConvexHulls) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-60.0, 60.0);
  std::uniform_real_distribution<double> speed(-4.0, 4.0);
  for (int i = 0; i < 200; ++i) {
    const Polygon own_m = SquareAt({0.0, 0.0});
    const Polygon thing_m = SquareAt({place(random), place(random)}, 6.0);
    const Vector2d own_mps(speed(random), speed(random));
    const Vector2d thing_mps(speed(random), speed(random));
    const auto exact = ApproachOf(own_m, own_mps, thing_m, thing_mps);
    const double expected_m = exact.tcpa_s <= 30.0 ? exact.cpa_m : GapAfter(30.0, own_m, own_mps, thing_m, thing_mps);
    const auto found = ApproachWithin(kQuestion, own_m, {own_mps, 0.0}, HullOutline(thing_m), {thing_mps, 0.0});
    if (expected_m < kQuestion.limit_m + kApproachCapM) {
      EXPECT_NEAR(found.greatest_m, expected_m, 0.3) << i;  // 0.05 s of the relative motion
    } else {
      EXPECT_GT(found.greatest_m, kQuestion.limit_m + kApproachCapM - 0.3) << i;
    }
  }
}

}  // namespace
}  // namespace lookout::eval
