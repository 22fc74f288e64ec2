#include "tools/calibrate/pose_track.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/calibrate/made_track.hpp"

namespace lookout::calibrate {
namespace {

TEST(PoseTrack, IsLinearBetweenPosesAndKnowsNothingOutside) {
  const MadeWay way;
  const auto track = MakeTrack(way, 10.0, 0.0);
  const auto pose = track.At(MadeTime(3.0), 0.0137);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->T_map_vessel.translation() - way.At(3.0137).translation()).norm(), 1e-4);
  EXPECT_NEAR(HeadingOf(pose->T_map_vessel), HeadingOf(way.At(3.0137)), 1e-5);
  EXPECT_FALSE(track.At(MadeTime(-2.0), 0.0));
  EXPECT_FALSE(track.At(MadeTime(12.0), 0.0));
  EXPECT_TRUE(track.At(MadeTime(12.0), -2.0));
}

TEST(PoseTrack, KnowsNothingInAGap) {
  PoseTrack track;
  TrackPose pose;
  for (const double time_s : {0.0, 0.02, 0.5, 0.52}) {
    pose.time = MadeTime(time_s);
    EXPECT_TRUE(track.Add(pose));
  }
  EXPECT_TRUE(track.At(MadeTime(0.01), 0.0));
  EXPECT_FALSE(track.At(MadeTime(0.3), 0.0));
  EXPECT_TRUE(track.At(MadeTime(0.51), 0.0));
  EXPECT_FALSE(track.Add(pose)) << "a pose that is not later";
}

TEST(PoseTrack, HeadingHasOneLatencyAndTiltAnother) {
  const MadeWay way;
  const auto track = MakeTrack(way, 10.0, 0.0);
  const auto pose = track.At(MadeTime(4.0), Latency{0.1, -0.2});
  ASSERT_TRUE(pose);
  EXPECT_NEAR(HeadingOf(pose->T_map_vessel), HeadingOf(way.At(4.1)), 1e-3);
  const Eigen::Vector3d up_then = way.At(3.8).linear().row(2);
  EXPECT_LT((Eigen::Vector3d(pose->T_map_vessel.linear().row(2)) - up_then).norm(), 1e-4);
  EXPECT_LT((pose->T_map_vessel.translation() - way.At(4.1).translation()).norm(), 1e-4);
}

}  // namespace
}  // namespace lookout::calibrate
