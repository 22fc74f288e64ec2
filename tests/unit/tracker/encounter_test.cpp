#include "services/tracker/core/encounter.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "common/core/angles.hpp"

namespace lookout::tracker {
namespace {

constexpr EncounterParams kEncounterParams{.limit_m = 5.0, .look_ahead_s = 30.0};

RelativeCovariance Covariance(double position_sd_m, double velocity_sd_mps) {
  RelativeCovariance covariance = RelativeCovariance::Zero();
  covariance.diagonal() << Eigen::Vector2d::Constant(position_sd_m * position_sd_m), Eigen::Vector2d::Constant(velocity_sd_mps * velocity_sd_mps);
  return covariance;
}

Moving Square(const Eigen::Vector2d& center_m, const Eigen::Vector2d& velocity_mps, double side_m = 2.0) {
  Moving moving{{}, velocity_mps};
  for (const auto& corner : {Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(0.5, -0.5), Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(-0.5, 0.5)}) {
    moving.hull_m.emplace_back(center_m + side_m * corner);
  }
  return moving;
}

ClosestApproach Of(const Moving& own, const Moving& other, double position_sd_m = 0.1, double velocity_sd_mps = 0.1) {
  return ClosestApproachOf(own, other, Covariance(position_sd_m, velocity_sd_mps), kEncounterParams);
}

TEST(ClosestApproach, IsHullToHull) {
  const auto approach = Of(Square({0.0, 0.0}, {0.0, 0.0}), Square({20.0, 6.0}, {-2.0, 0.0}));
  EXPECT_NEAR(approach.distance_m, std::hypot(18.0, 4.0), 1e-9);
  EXPECT_NEAR(approach.cpa_m, 4.0, 1e-9);
  EXPECT_NEAR(approach.tcpa_s, 9.0, 1e-9) << "when it is reached first: they stay 4 m apart for another 2 s";
}

TEST(ClosestApproach, OfACollisionIsWhenTheyTouch) {
  const auto approach = Of(Square({0.0, 0.0}, {1.0, 0.0}), Square({20.0, 0.5}, {-2.0, 0.0}));
  EXPECT_NEAR(approach.distance_m, 18.0, 1e-9);
  EXPECT_EQ(approach.cpa_m, 0.0);
  EXPECT_NEAR(approach.tcpa_s, 6.0, 1e-9);
  EXPECT_GT(approach.probability, 0.99);
}

TEST(ClosestApproach, IsThatOfNowWhereTheyPart) {
  const auto approach = Of(Square({0.0, 0.0}, {0.0, 0.0}), Square({20.0, 0.0}, {2.0, 1.0}));
  EXPECT_NEAR(approach.cpa_m, 18.0, 1e-9);
  EXPECT_EQ(approach.tcpa_s, 0.0);
  EXPECT_EQ(approach.probability, 0.0);
}

TEST(ClosestApproach, IsThatOfNowWhereTheyHardlyMove) {
  const auto approach = Of(Square({0.0, 0.0}, {1.0, 0.0}), Square({20.0, 0.0}, {0.97, 0.0}));
  EXPECT_NEAR(approach.cpa_m, 18.0, 1e-9);
  EXPECT_EQ(approach.tcpa_s, 0.0);
}

TEST(ClosestApproach, OfHullsThatOverlapIsNow) {
  const auto approach = Of(Square({0.0, 0.0}, {1.0, 0.0}), Square({1.0, 1.0}, {-1.0, 0.0}));
  EXPECT_EQ(approach.distance_m, 0.0);
  EXPECT_EQ(approach.cpa_m, 0.0);
  EXPECT_EQ(approach.tcpa_s, 0.0);
  EXPECT_NEAR(approach.probability, 1.0, 1e-3);
  EXPECT_TRUE(std::isnan(approach.bearing_drift_radps));
}

TEST(ClosestApproach, HoldsForPointsAndLines) {
  const Moving point{{{0.0, 0.0}}, {0.0, 0.0}};
  const Moving line{{{10.0, 3.0}, {10.0, 8.0}}, {-1.0, 0.0}};
  const auto approach = Of(point, line);
  EXPECT_NEAR(approach.distance_m, std::hypot(10.0, 3.0), 1e-9);
  EXPECT_NEAR(approach.cpa_m, 3.0, 1e-9);
  EXPECT_NEAR(approach.tcpa_s, 10.0, 1e-9);
  EXPECT_GT(Of(point, Moving{{{10.0, 3.0}}, {-1.0, 0.0}}).probability, 0.9);
}

// A standing point at 5 m plus so many deviations: no motion, so a normal distribution.
TEST(ClosestApproach, ProbabilityOfAWallIsThatOfANormalDistribution) {
  const Moving own{{{0.0, 0.0}}, {0.0, 0.0}};
  for (const double deviations : {-3.0, -1.0, 0.0, 0.5, 1.0, 2.0}) {
    const double x = 5.0 + 0.4 * deviations;
    const Moving wall{{{x, -300.0}, {x, 300.0}}, {0.0, 0.0}};
    EXPECT_NEAR(Of(own, wall, 0.4, 0.0).probability, 0.5 * std::erfc(deviations / std::numbers::sqrt2), 0.002) << deviations;
  }
}

// The same wall passed at the limit in 20 s: the deviation is that of then.
TEST(ClosestApproach, ProbabilityGrowsWithTheDeviationOfTheVelocity) {
  const Moving own{{{0.0, 0.0}}, {0.0, 0.0}};
  const Moving post{{{40.0, 7.0}}, {-2.0, 0.0}};
  const double sd_m = std::hypot(0.1, 0.1 * 20.0);
  const double expected = 0.5 * std::erfc(2.0 / sd_m / std::numbers::sqrt2) - 0.5 * std::erfc(12.0 / sd_m / std::numbers::sqrt2);
  EXPECT_NEAR(Of(own, post).probability, expected, 0.02) << "about: later it comes nearer, earlier less so";
}

TEST(ClosestApproach, BeyondTheLookAheadDoesNotCount) {
  const Moving own{{{0.0, 0.0}}, {0.0, 0.0}};
  EXPECT_LT(Of(own, {{{100.0, 0.0}}, {-2.0, 0.0}}).probability, 0.001);
  EXPECT_NEAR(Of(own, {{{65.0, 0.0}}, {-2.0, 0.0}}, 0.5, 0.0).probability, 0.5, 0.02);
}

TEST(ClosestApproach, OfAStandingPairWithPoorVelocityIsNotCertain) {
  const auto approach = Of(Square({0.0, 0.0}, {0.0, 0.0}), Square({12.0, 0.0}, {0.0, 0.0}), 0.1, 0.5);
  EXPECT_GT(approach.probability, 0.2);
  EXPECT_LT(approach.probability, 0.5);
}

// Speeds and deviations that no boat has, hulls without extent, nothing known and everything known: a probability, and in bounded time.
TEST(ClosestApproach, OfAbsurdStatesIsStillAProbability) {
  for (const double speed_mps : {0.0, 1e-9, 1.0, 1e3, 1e9}) {
    for (const double position_sd_m : {0.0, 1e-9, 1.0, 1e6}) {
      for (const double velocity_sd_mps : {0.0, 1e-9, 1.0, 1e6}) {
        for (const double distance_m : {0.0, 5.0, 5.0 + 1e-12, 1e7}) {
          const Moving own{{{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}}, {0.0, 0.0}};
          for (const auto& direction : {Eigen::Vector2d(-1.0, 0.0), Eigen::Vector2d(0.0, 1.0)}) {
            const Moving other{{{distance_m, 0.0}, {distance_m + 1.0, 0.0}}, speed_mps * direction};
            const auto approach = Of(own, other, position_sd_m, velocity_sd_mps);
            EXPECT_GE(approach.probability, 0.0);
            EXPECT_LE(approach.probability, 1.0);
            EXPECT_GE(approach.cpa_m, 0.0);
            EXPECT_LE(approach.cpa_m, approach.distance_m);
          }
        }
      }
    }
  }
}

TEST(ClosestApproach, BearingDriftsClockwiseWhereItPassesAhead) {
  const auto drift = Of(Square({0.0, 0.0}, {0.0, 0.0}), Square({0.0, 20.0}, {2.0, 0.0})).bearing_drift_radps;
  EXPECT_NEAR(drift, 0.1, 1e-9);
  EXPECT_NEAR(Of(Square({0.0, 0.0}, {0.0, 0.0}), Square({0.0, 20.0}, {0.0, -2.0})).bearing_drift_radps, 0.0, 1e-12) << "collision course";
}

// Own boat at the origin to north at 3 m/s; the other collides with it in 10 s on a course.
Encounter FromCourse(double course_deg, double speed_mps = 3.0) {
  const double course_rad = DegToRad(course_deg);
  const Eigen::Vector2d velocity_mps = speed_mps * Eigen::Vector2d(std::sin(course_rad), std::cos(course_rad));
  const auto own = Square({0.0, 0.0}, {0.0, 3.0});
  const auto other = Square(Eigen::Vector2d(0.0, 30.0) - 10.0 * velocity_mps, velocity_mps);
  return EncounterOf(own, 0.0, other, Of(own, other), kEncounterParams);
}

TEST(Encounter, IsAsRules13To15Say) {
  EXPECT_EQ(FromCourse(180.0), Encounter::kHeadOn);
  EXPECT_EQ(FromCourse(165.0), Encounter::kHeadOn);
  EXPECT_EQ(FromCourse(195.0), Encounter::kHeadOn);
  EXPECT_EQ(FromCourse(270.0), Encounter::kCrossingGiveWay) << "from starboard";
  EXPECT_EQ(FromCourse(225.0), Encounter::kCrossingGiveWay);
  EXPECT_EQ(FromCourse(90.0), Encounter::kCrossingStandOn) << "from port";
  EXPECT_EQ(FromCourse(135.0), Encounter::kCrossingStandOn);
  EXPECT_EQ(FromCourse(0.0, 1.0), Encounter::kOvertaking);
  EXPECT_EQ(FromCourse(15.0, 1.5), Encounter::kOvertaking);
  EXPECT_EQ(FromCourse(0.0, 6.0), Encounter::kOvertaken);
  EXPECT_EQ(FromCourse(340.0, 6.0), Encounter::kOvertaken);
}

TEST(Encounter, IsNoneWithoutMotionOrRisk) {
  const auto own = Square({0.0, 0.0}, {0.0, 3.0});
  const auto none = [&own](const Moving& other) { return EncounterOf(own, 0.0, other, Of(own, other), kEncounterParams) == Encounter::kNone; };
  EXPECT_TRUE(none(Square({0.0, 30.0}, {0.0, 0.0}))) << "it stands";
  EXPECT_TRUE(none(Square({0.0, 30.0}, {0.0, 4.0}))) << "they part";
  EXPECT_TRUE(none(Square({0.0, 300.0}, {0.0, -3.0}))) << "too late";
  EXPECT_TRUE(none(Square({60.0, 60.0}, {0.0, -3.0}))) << "far off";
  EXPECT_FALSE(none(Square({0.0, 60.0}, {0.0, -3.0})));
}

}  // namespace
}  // namespace lookout::tracker
