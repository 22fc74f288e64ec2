#include "services/tracker/core/turning.hpp"

#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout::tracker::turning {
namespace {

using std::chrono::milliseconds;

constexpr EncounterParams kEncounterParams{.limit_m = 5.0, .look_ahead_s = 30.0};

std::vector<Eigen::Vector2d> Square(const Eigen::Vector2d& center_m, double half_m) {
  return {center_m + Eigen::Vector2d(-half_m, -half_m), center_m + Eigen::Vector2d(half_m, -half_m), center_m + Eigen::Vector2d(half_m, half_m),
          center_m + Eigen::Vector2d(-half_m, half_m)};
}

// At the origin, northward at 3 m/s.
Moving Own(double turn_rate_degps) { return {Square({0.0, 0.0}, 1.0), {0.0, 3.0}, DegToRad(turn_rate_degps)}; }
Moving Pile(double east_m, double north_m) { return {Square({east_m, north_m}, 0.3)}; }

ClosestApproach Of(const Moving& own, const Moving& other) {
  RelativeCovariance covariance = RelativeCovariance::Identity() * 0.01;
  covariance.bottomRightCorner<2, 2>() *= 2.0;
  return ClosestApproachOf(own, other, covariance, kEncounterParams);
}

TEST(AfterTurn, OfAQuarterToStarboardGoesEast) {
  const double rate_radps = DegToRad(9.0);
  const auto after = AfterTurn({{{0.0, 2.0}, {0.0, -2.0}}, {0.0, 3.0}, rate_radps}, 10.0);
  const double radius_m = 3.0 / rate_radps;
  EXPECT_NEAR(after.velocity_mps.x(), 3.0, 1e-12);
  EXPECT_NEAR(after.velocity_mps.y(), 0.0, 1e-12);
  EXPECT_NEAR(after.hull_m[0].x(), radius_m + 2.0, 1e-9) << "its bow points east";
  EXPECT_NEAR(after.hull_m[0].y(), radius_m, 1e-9);
  EXPECT_NEAR(after.hull_m[1].x(), radius_m - 2.0, 1e-9);
  const auto straight = AfterTurn({{{0.0, 2.0}}, {0.0, 3.0}, 0.0}, 10.0);
  EXPECT_NEAR(straight.hull_m[0].y(), 32.0, 1e-12);
}

// In a turn at 20 deg/s four of five alerts were of things that never came near: each passed over the tangent for a moment.
TEST(ApproachInTurns, IsNoDangerOnTheTangentThatTheBoatTurnsAwayFrom) {
  EXPECT_GT(Of(Own(0.0), Pile(0.0, 30.0)).probability, 0.99);
  EXPECT_LT(Of(Own(20.0), Pile(0.0, 30.0)).probability, 0.35);
  EXPECT_LT(Of(Own(-20.0), Pile(0.0, 30.0)).probability, 0.35);
}

TEST(ApproachInTurns, IsADangerRightAheadWhereNoTurnIsInTime) {
  const auto approach = Of(Own(10.0), Pile(0.0, 9.0));
  EXPECT_GT(approach.probability, 0.95);
  EXPECT_GT(approach.tcpa_s, 0.5);
  EXPECT_LT(approach.tcpa_s, 4.0);
}

TEST(ApproachInTurns, IsADangerOnTheArc) {
  // A radius of 17 m to starboard: the pile stands on the circle, 60 deg of turn ahead, and 8.6 m beside the straight way.
  const double radius_m = 3.0 / DegToRad(10.0);
  const Moving pile = Pile(radius_m * (1.0 - std::cos(DegToRad(60.0))), radius_m * std::sin(DegToRad(60.0)));
  EXPECT_GT(Of(Own(10.0), pile).probability, 0.5);
  EXPECT_LT(Of(Own(0.0), pile).probability, 0.5);
  EXPECT_LT(Of(Own(-10.0), pile).probability, 0.2);
}

TEST(ApproachInTurns, IsAsStraightAheadForAHardlyTurningBoat) {
  const auto straight = Of(Own(0.0), Pile(3.0, 20.0));
  const auto turning = Of(Own(0.01), Pile(3.0, 20.0));
  EXPECT_NEAR(turning.probability, straight.probability, 0.01);
  EXPECT_NEAR(turning.cpa_m, straight.cpa_m, 0.05);
  EXPECT_NEAR(turning.tcpa_s, straight.tcpa_s, 0.8) << "it is abeam for 0.77 s";
}

TEST(ApproachInTurns, IsTheSameInTheMirror) {
  const auto to_starboard = Of(Own(15.0), Pile(6.0, 14.0));
  const auto to_port = Of(Own(-15.0), Pile(-6.0, 14.0));
  EXPECT_NEAR(to_starboard.probability, to_port.probability, 1e-9);
  EXPECT_NEAR(to_starboard.cpa_m, to_port.cpa_m, 1e-9);
  EXPECT_NEAR(to_starboard.tcpa_s, to_port.tcpa_s, 1e-9);
}

TEST(ApproachInTurns, FollowsTheTurnOfTheOther) {
  // It passes 20 m off, and turns towards the own boat, which lies still.
  const Moving own{Square({0.0, 0.0}, 1.0)};
  Moving other{Square({-20.0, -25.0}, 1.0), {0.0, 4.0}};
  EXPECT_LT(Of(own, other).probability, 0.01);
  other.turn_rate_radps = DegToRad(12.0);
  EXPECT_GT(Of(own, other).probability, 0.3);
  other.turn_rate_radps = DegToRad(-12.0);
  EXPECT_LT(Of(own, other).probability, 0.01);
}

TEST(ApproachInTurns, TellsTheDistanceOfNow) {
  EXPECT_NEAR(Of(Own(20.0), Pile(0.0, 30.0)).distance_m, 28.7, 1e-9);
  const auto touching = Of(Own(20.0), Pile(0.0, 1.0));
  EXPECT_EQ(touching.distance_m, 0.0);
  EXPECT_NEAR(touching.probability, 1.0, 1e-6);
}

class TurnWatchTest : public ::testing::Test {
 protected:
  double Scan(double heading_deg, double course_deg, double speed_mps = 2.0) {
    time_ += milliseconds(100);
    const double course_rad = DegToRad(course_deg);
    return RadToDeg(watch_.Update(time_, WrapTo2Pi(DegToRad(heading_deg)), speed_mps * Eigen::Vector2d(std::sin(course_rad), std::cos(course_rad))));
  }

  Utime time_{std::chrono::seconds(1'700'000'000)};
  TurnWatch watch_;
};

TEST_F(TurnWatchTest, KnowsATurnAfterASecondAlsoOverNorth) {
  double rate_degps = 0.0;
  for (int i = 0; i < 12; ++i) rate_degps = Scan(350.0 + 2.0 * i, 349.0 + 2.0 * i);
  EXPECT_NEAR(rate_degps, 20.0, 0.5);
  for (int i = 0; i < 24; ++i) rate_degps = Scan(12.0 - 2.0 * i, 12.0 - 2.0 * i);
  EXPECT_NEAR(rate_degps, -20.0, 0.5);
}

TEST_F(TurnWatchTest, KnowsTheEndOfATurnWithinHalfASecond) {
  for (int i = 0; i < 20; ++i) Scan(2.0 * i, 2.0 * i);
  EXPECT_GT(Scan(40.0, 40.0), 10.0);
  double rate_degps = 0.0;
  for (int i = 0; i < 4; ++i) rate_degps = Scan(40.0, 40.0);
  EXPECT_EQ(rate_degps, 0.0);
}

// Round a lake at 2 deg/s: in 30 s that is 60 deg.
TEST_F(TurnWatchTest, KnowsASlowTurnAfterThreeSeconds) {
  for (int i = 0; i < 28; ++i) EXPECT_EQ(Scan(0.2 * i, 0.2 * i), 0.0) << i;
  double rate_degps = 0.0;
  for (int i = 28; i < 40; ++i) rate_degps = Scan(0.2 * i, 0.2 * i);
  EXPECT_NEAR(rate_degps, 2.0, 0.1);
  for (int i = 0; i < 7; ++i) rate_degps = Scan(8.0, 8.0);
  EXPECT_EQ(rate_degps, 0.0) << "it has ended";
}

TEST_F(TurnWatchTest, TakesTheWanderOfAHelmsmanForNoTurn) {
  for (int i = 0; i < 600; ++i) EXPECT_EQ(Scan(90.0 + 2.5 * std::sin(0.05 * i), 90.0 + 2.5 * std::sin(0.05 * i - 0.2)), 0.0) << i;
}

TEST_F(TurnWatchTest, TakesYawInWavesForNoTurn) {
  for (int i = 0; i < 200; ++i) EXPECT_EQ(Scan(90.0 + 6.0 * std::sin(0.15 * i), 90.0 + 0.5 * std::sin(0.9 * i)), 0.0);
}

TEST_F(TurnWatchTest, KnowsNoTurnOnTheSpotOrWithoutAVelocity) {
  for (int i = 0; i < 30; ++i) EXPECT_EQ(Scan(3.0 * i, 3.0 * i, 0.2), 0.0);
  for (int i = 0; i < 30; ++i) {
    time_ += milliseconds(100);
    EXPECT_EQ(watch_.Update(time_, 0.1 * i, Eigen::Vector2d::Constant(kNan)), 0.0);
  }
}

TEST_F(TurnWatchTest, BeginsAnewAfterAGap) {
  for (int i = 0; i < 12; ++i) Scan(2.0 * i, 2.0 * i);
  time_ += std::chrono::seconds(5);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(Scan(100.0 + 2.0 * i, 100.0 + 2.0 * i), 0.0);
  time_ -= std::chrono::seconds(60);
  EXPECT_EQ(Scan(0.0, 0.0), 0.0);
}

}  // namespace
}  // namespace lookout::tracker::turning
