#include "tools/sim/motion.hpp"

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
