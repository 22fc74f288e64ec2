#include "lab/sim/motion.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(Placement, PutsTheBowWhereTheHeadingPoints) {
  const Placement east{{10.0, 20.0}, kPi / 2.0};
  EXPECT_TRUE(east.ToMap({1.0, 0.0}).isApprox(Vector2d(11.0, 20.0)));
  EXPECT_TRUE(east.ToMap({0.0, 1.0}).isApprox(Vector2d(10.0, 21.0))) << "port is north when the bow is east";
}

TEST(Track, GoesRoundClockwiseWithPositiveTurnRate) {
  const Track track{{{0.0, 0.0}, 0.0}, kPi / 2.0, kPi / 2.0};  // a circle of 1 m in 4 s
  EXPECT_TRUE(track.At(1.0).position_map_m.isApprox(Vector2d(1.0, 1.0)));
  EXPECT_NEAR(track.At(1.0).heading_rad, kPi / 2.0, 1e-12);
  EXPECT_LT(track.At(4.0).position_map_m.norm(), 1e-12);
}

TEST(Track, StraightLineKeepsItsHeading) {
  const Track track{{{0.0, 0.0}, kPi / 2.0}, 2.0};
  EXPECT_TRUE(track.At(3.0).position_map_m.isApprox(Vector2d(6.0, 0.0)));
  EXPECT_DOUBLE_EQ(track.At(3.0).heading_rad, kPi / 2.0);
}

TEST(Route, GoesThroughItsLegsAndRoundsItsCorners) {
  // North 20 m, then east 20 m; the corner is cut 5 m before and behind by a quarter of a circle.
  const Track route = MakeRoute({{0.0, 0.0}, {0.0, 20.0}, {20.0, 20.0}}, 1.0, 5.0, false);
  EXPECT_NEAR(route.route_s, 15.0 + 5.0 * kPi / 2.0 + 15.0, 1e-9);
  EXPECT_TRUE(route.At(10.0).position_map_m.isApprox(Vector2d(0.0, 10.0)));
  const Placement middle = route.At(15.0 + 5.0 * kPi / 4.0);
  EXPECT_NEAR(middle.heading_rad, kPi / 4.0, 1e-9);
  EXPECT_NEAR((middle.position_map_m - Vector2d(5.0, 15.0)).norm(), 5.0, 1e-9) << "on the arc about (5, 15)";
  EXPECT_TRUE(route.At(1000.0).position_map_m.isApprox(Vector2d(20.0, 20.0))) << "it stops at the last waypoint";
  EXPECT_NEAR(route.At(1000.0).heading_rad, kPi / 2.0, 1e-9);
}

TEST(Route, NeverJumpsAndKeepsItsSpeed) {
  for (const bool is_closed : {false, true}) {
    // A sharp corner, and legs too short for the radius that is asked for.
    const Track route = MakeRoute({{0.0, 0.0}, {30.0, 5.0}, {2.0, 9.0}, {1.0, 12.0}, {-8.0, 3.0}}, 2.0, 6.0, is_closed);
    constexpr double kStepS = 0.01;
    const double end_s = is_closed ? 2.5 * route.route_s : route.route_s;
    for (double time_s = 0.0; time_s + kStepS < end_s; time_s += kStepS) {
      const Placement before = route.At(time_s);
      const Placement after = route.At(time_s + kStepS);
      ASSERT_NEAR((after.position_map_m - before.position_map_m).norm(), 2.0 * kStepS, 1e-3) << time_s;
      ASSERT_LT(std::abs(WrapToPi(after.heading_rad - before.heading_rad)), 0.2) << time_s;
    }
  }
}

TEST(Route, ClosedOnesComeRoundAgain) {
  const Track square = MakeRoute({{0.0, 0.0}, {0.0, 10.0}, {10.0, 10.0}, {10.0, 0.0}}, 1.0, 2.0, true);
  EXPECT_NEAR(square.route_s, 4.0 * 6.0 + 2.0 * kPi * 2.0, 1e-9);
  for (const double time_s : {0.0, 3.3, 17.0}) {
    EXPECT_TRUE(square.At(time_s).position_map_m.isApprox(square.At(time_s + 3.0 * square.route_s).position_map_m, 1e-9));
  }
}

TEST(Route, OfTwoPointsIsAStraightLineThatEnds) {
  const Track line = MakeRoute({{1.0, 1.0}, {1.0, 11.0}}, 2.0, 5.0, false);
  EXPECT_TRUE(line.At(2.5).position_map_m.isApprox(Vector2d(1.0, 6.0)));
  EXPECT_TRUE(line.At(9.0).position_map_m.isApprox(Vector2d(1.0, 11.0)));
}

TEST(OwnMotion, GoesAlongATrackInPlaceOfAnEllipse) {
  OwnMotion motion;
  motion.track = Track{{{1.0, 2.0}, 0.0}, 2.0, 0.1};
  for (double time_s = 0.0; time_s < 70.0; time_s += 7.3) {
    constexpr double kStepS = 1e-4;
    const auto state = StateAt(motion, 0.5, time_s);
    const Vector3d difference = StateAt(motion, 0.5, time_s + kStepS).position_map_m - StateAt(motion, 0.5, time_s - kStepS).position_map_m;
    EXPECT_LT((difference.head<2>() / (2.0 * kStepS) - state.velocity_map_mps).norm(), 1e-6) << time_s;
    EXPECT_NEAR(WrapToPi(state.heading_rad - 0.1 * time_s), 0.0, 1e-9);
  }
}

TEST(OwnMotion, VelocityIsTheDerivativeOfPositionAndHeadingFollowsIt) {
  OwnMotion motion;
  motion.semi_axes_m = {30.0, 20.0};
  motion.period_s = 70.0;
  for (double time_s = 0.0; time_s < 70.0; time_s += 3.7) {
    constexpr double kStepS = 1e-4;
    const auto state = StateAt(motion, 0.5, time_s);
    const Vector3d difference = StateAt(motion, 0.5, time_s + kStepS).position_map_m - StateAt(motion, 0.5, time_s - kStepS).position_map_m;
    EXPECT_LT((difference.head<2>() / (2.0 * kStepS) - state.velocity_map_mps).norm(), 1e-6) << time_s;
    const Vector3d bow = state.T_map_vessel().linear() * Vector3d::UnitX();
    EXPECT_GT(bow.head<2>().dot(state.velocity_map_mps.normalized()), 1.0 - 1e-12) << time_s;
  }
}

TEST(OwnMotion, PositiveRollPutsStarboardDownAndPositivePitchTheBowUp) {
  OwnMotion motion;
  motion.roll_rad = {{0.1, 4.0, kPi / 2.0}};
  motion.pitch_rad = {{0.05, 4.0, kPi / 2.0}};
  const Eigen::Matrix3d R_map_vessel = StateAt(motion, 0.5, 0.0).T_map_vessel().linear();
  EXPECT_LT((R_map_vessel * Vector3d(0.0, -1.0, 0.0)).z(), -0.09);
  EXPECT_NEAR((R_map_vessel * Vector3d(1.0, 0.0, 0.0)).z(), std::sin(0.05), 1e-12);
}

TEST(OwnMotion, HeaveLiftsTheReferencePoint) {
  OwnMotion motion;
  motion.heave_m = {{0.3, 4.0, kPi / 2.0}};
  EXPECT_DOUBLE_EQ(StateAt(motion, 0.5, 0.0).position_map_m.z(), 0.8);
}

}  // namespace
}  // namespace lookout::sim
