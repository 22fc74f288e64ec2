#include "lab/eval/baselines/kiss_icp.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"

namespace lookout::eval {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d Motion(const Vector3d& way_m, double roll_deg, double pitch_deg, double yaw_deg) {
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = RotationAboutZ(DegToRad(yaw_deg)) * RotationAboutY(DegToRad(pitch_deg)) * RotationAboutX(DegToRad(roll_deg));
  motion.translation() = way_m;
  return motion;
}

// Points on the walls, floor and ceiling of a room of 24 m x 18 m x 9 m, 3 m apart: each has a voxel of its own, so that every scan holds all of
// them.
std::vector<Vector3d> Room() {
  std::vector<Vector3d> points_m;
  for (int x = 0; x <= 8; ++x) {
    for (int y = 0; y <= 6; ++y) {
      for (int z = 0; z <= 3; ++z) {
        if (x % 8 == 0 || y % 6 == 0 || z % 3 == 0) points_m.emplace_back(3.0 * x - 11.9, 3.0 * y - 8.8, 3.0 * z - 4.3);
      }
    }
  }
  return points_m;
}

// All shots of the scan at its end.
std::vector<LidarPoint> Seen(const std::vector<Vector3d>& points_map_m, const Isometry3d& T_map_lidar) {
  std::vector<LidarPoint> seen;
  for (const auto& p_map_m : points_map_m) seen.push_back({T_map_lidar.inverse() * p_map_m, 0.0});
  return seen;
}

void ExpectNear(const Isometry3d& found, const Isometry3d& truth, double tolerance_m, double tolerance_deg) {
  EXPECT_LT((found.translation() - truth.translation()).norm(), tolerance_m);
  EXPECT_LT(RadToDeg(Eigen::AngleAxisd(found.linear().transpose() * truth.linear()).angle()), tolerance_deg);
}

TEST(KissIcp, FindsARoomAgainToAMillimetre) {
  KissIcp method;
  const auto room = Room();
  ExpectNear(method.Register(Seen(room, Isometry3d::Identity()), 0.0), Isometry3d::Identity(), 1e-9, 1e-6);
  const auto truth = Motion({0.4, -0.2, 0.1}, 1.0, -2.0, 3.0);
  ExpectNear(method.Register(Seen(room, truth), 0.1), truth, 1e-3, 1e-3);
}

TEST(KissIcp, FollowsALidarThroughAnEighthOfATurn) {
  KissIcp method;
  const auto room = Room();
  Isometry3d truth = Isometry3d::Identity();
  method.Register(Seen(room, truth), 0.0);
  // 45 deg in all.
  for (int i = 0; i < 15; ++i) {
    truth = truth * Motion({0.05, 0.02, 0.01}, 0.5, -0.5, 3.0);
    ExpectNear(method.Register(Seen(room, truth), 0.1), truth, 2e-3, 2e-3);
  }
}

TEST(KissIcp, IsNotMisledByABoatThatMovesInTheRoom) {
  KissIcp method;
  auto room = Room();
  const auto num_room = room.size();
  for (int i = 0; i < 6; ++i) room.emplace_back(3.0 * i - 7.0, 2.0, -1.0);
  method.Register(Seen(room, Isometry3d::Identity()), 0.0);
  for (auto i = num_room; i < room.size(); ++i) room[i].x() += 0.5;
  const auto truth = Motion({0.3, 0.0, 0.0}, 0.0, 0.0, 1.0);
  // The kernel of the first scans is wide (0.67): six of 172 points, 0.5 m off, still pull by centimetres.
  ExpectNear(method.Register(Seen(room, truth), 0.1), truth, 0.02, 0.2);
}

TEST(KissIcp, GoesOnAsBeforeWhereNothingIsInSight) {
  KissIcp method;
  const auto room = Room();
  const auto step = Motion({0.3, 0.1, 0.0}, 0.0, 0.0, 2.0);
  method.Register(Seen(room, Isometry3d::Identity()), 0.0);
  method.Register(Seen(room, step), 0.1);
  ExpectNear(method.Register({}, 0.1), step * step, 2e-3, 2e-3);
  // Also after a scan that took twice the time.
  ExpectNear(method.Register({}, 0.2), step * step * LidarVelocity::Of(step, 0.1).MotionOver(0.2), 4e-3, 4e-3);
}

TEST(KissIcp, OfScansWithoutReturnsStaysWhereItIs) {
  KissIcp method;
  for (int i = 0; i < 3; ++i) ExpectNear(method.Register({}, 0.1), Isometry3d::Identity(), 1e-12, 1e-9);
}

TEST(KissIcp, OfOneReturnStaysFinite) {
  KissIcp method;
  for (int i = 0; i < 20; ++i) {
    const std::vector<LidarPoint> one{{{20.0 - 0.3 * i, 0.1 * i, 0.0}, 0.0}};
    EXPECT_TRUE(method.Register(one, 0.1).matrix().allFinite());
  }
}

TEST(KissIcp, LeavesOutReturnsBeyondTheGreatestRange) {
  KissIcp method({.max_range_m = 13.0});
  auto room = Room();
  method.Register(Seen(room, Isometry3d::Identity()), 0.0);
  const auto truth = Motion({0.2, 0.0, 0.0}, 0.0, 0.0, 0.0);
  // Those farther than 13 m jump to elsewhere, at the same range.
  for (auto& p_m : room) {
    if (p_m.norm() > 12.7) p_m.x() = p_m.x() > 0.0 ? p_m.x() + 2.0 : p_m.x() - 2.0;
  }
  ExpectNear(method.Register(Seen(room, truth), 0.1), truth, 1e-3, 1e-3);
}

TEST(KissIcp, GivesTheSameBitsAgain) {
  std::vector<Isometry3d> first;
  for (int run = 0; run < 2; ++run) {
    KissIcp method;
    Isometry3d truth = Isometry3d::Identity();
    for (int i = 0; i < 5; ++i) {
      const auto found = method.Register(Seen(Room(), truth), 0.1);
      if (run == 0) first.push_back(found);
      EXPECT_EQ(found.matrix(), first[static_cast<std::size_t>(i)].matrix());
      truth = truth * Motion({0.3, 0.0, 0.0}, 0.0, 0.0, 1.0);
    }
  }
}

TEST(LidarVelocity, MovesAShotToTheEndOfItsScan) {
  // 10 m/s forward: a shot of 0.05 s before is 0.5 m nearer at the end.
  const std::vector<LidarPoint> points{{{5.0, 1.0, 0.0}, 0.05}, {{5.0, 1.0, 0.0}, 0.0}};
  const auto straight = Deskewed(points, {{10.0, 0.0, 0.0}, Vector3d::Zero()});
  EXPECT_TRUE(straight[0].isApprox(Vector3d(4.5, 1.0, 0.0), 1e-12));
  EXPECT_TRUE(straight[1].isApprox(Vector3d(5.0, 1.0, 0.0), 1e-12));
  // A quarter turn a second to port: what was ahead a second ago is to starboard.
  const std::vector<LidarPoint> ahead{{{2.0, 0.0, 0.0}, 1.0}};
  EXPECT_TRUE(Deskewed(ahead, {Vector3d::Zero(), {0.0, 0.0, 0.5 * kPi}})[0].isApprox(Vector3d(0.0, -2.0, 0.0), 1e-12));
}

TEST(LidarVelocity, IsThatOfAMotion) {
  const auto motion = Motion({0.3, -0.1, 0.05}, 2.0, -3.0, 40.0);
  const auto again = LidarVelocity::Of(motion, 0.1).MotionOver(0.1);
  EXPECT_TRUE(again.matrix().isApprox(motion.matrix(), 1e-12));
  const auto still = LidarVelocity::Of(Isometry3d::Identity(), 0.1);
  EXPECT_EQ(still.velocity_mps, Vector3d::Zero());
  EXPECT_EQ(still.rotation_radps, Vector3d::Zero());
}

TEST(AdaptiveThreshold, IsTheRootMeanSquareOfWhatDepartsFromAConstantVelocity) {
  AdaptiveThreshold threshold(KissIcpParams{});
  EXPECT_EQ(threshold.SigmaM(), 2.0);
  threshold.Add(Motion({0.06, 0.08, 0.0}, 0.0, 0.0, 0.0));  // 0.1 m does not count
  EXPECT_EQ(threshold.SigmaM(), 2.0);
  threshold.Add(Motion({0.3, 0.0, 0.4}, 0.0, 0.0, 0.0));
  EXPECT_NEAR(threshold.SigmaM(), 0.5, 1e-12);
  // 60 deg at 100 m: a chord of 100 m. With 3.5 m of way 103.5 m.
  AdaptiveThreshold turned(KissIcpParams{});
  turned.Add(Motion({0.0, 3.5, 0.0}, 0.0, 0.0, 60.0));
  EXPECT_NEAR(turned.SigmaM(), 103.5, 1e-9);
  // 0.1 deg alone: 2 x 100 m x sin 0.05 deg = 0.174533 m. With 0.5 m: the root of (0.030462 + 0.25) / 2.
  threshold.Add(Motion(Vector3d::Zero(), 0.1, 0.0, 0.0));
  EXPECT_NEAR(threshold.SigmaM(), 0.374474, 1e-6);
}

TEST(VoxelMap, KeepsTheFirstPointsOfEachVoxel) {
  VoxelMap map(1.0, 2);
  EXPECT_TRUE(map.empty());
  map.Add({0.1, 0.1, 0.1});
  map.Add({0.5, 0.1, 0.1});
  map.Add({0.9, 0.1, 0.1});  // the third of two
  EXPECT_EQ(map.Nearest({0.95, 0.1, 0.1}), Vector3d(0.5, 0.1, 0.1));
}

TEST(VoxelMap, LooksIntoTheVoxelsAroundAndNoFurther) {
  VoxelMap map(1.0, 20);
  map.Add({-0.2, 0.5, 0.5});
  EXPECT_EQ(map.Nearest({0.9, 0.5, 0.5}), Vector3d(-0.2, 0.5, 0.5));
  EXPECT_EQ(map.Nearest({1.1, 0.5, 0.5}), std::nullopt);
  // Of two that are as near, the one of the lower voxel.
  map.Add({1.2, 0.5, 0.5});
  EXPECT_EQ(map.Nearest({0.5, 0.5, 0.5}), Vector3d(-0.2, 0.5, 0.5));
}

TEST(VoxelMap, ForgetsWhatIsFar) {
  VoxelMap map(1.0, 20);
  map.Add({0.5, 0.5, 0.5});
  map.Add({10.5, 0.5, 0.5});
  map.Add({20.5, 0.5, 0.5});
  map.Forget({20.0, 0.0, 0.0}, 15.0);
  EXPECT_EQ(map.Nearest({0.5, 0.5, 0.5}), std::nullopt);
  EXPECT_EQ(map.Nearest({10.4, 0.5, 0.5}), Vector3d(10.5, 0.5, 0.5));
  map.Add({0.6, 0.5, 0.5});
  EXPECT_EQ(map.Nearest({0.5, 0.5, 0.5}), Vector3d(0.6, 0.5, 0.5));
  EXPECT_EQ(map.Nearest({20.4, 0.5, 0.5}), Vector3d(20.5, 0.5, 0.5));
}

}  // namespace
}  // namespace lookout::eval
