#include "common/core/pose.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using test::At;
using test::MakePose;

TEST(PoseHistory, OfNothingGivesNothing) {
  const PoseHistory poses;
  EXPECT_FALSE(poses.At(At(0)));
  EXPECT_EQ(poses.newest(), nullptr);
  EXPECT_TRUE(std::isnan(poses.DatumAt(At(0)).latitude_deg));
}

TEST(PoseHistory, GivesThePoseOfTheGridExactlyAlsoWithoutANeighbour) {
  PoseHistory poses;
  Pose pose = MakePose(0);
  pose.heading_rad = 1.25;
  poses.Add(pose);
  ASSERT_TRUE(poses.At(At(0)));
  EXPECT_EQ(poses.At(At(0))->heading_rad, 1.25);
  EXPECT_FALSE(poses.At(At(1)));
  EXPECT_FALSE(poses.At(At(-1)));
}

TEST(PoseHistory, AGridPoseCountsWhateverItsNeighboursAre) {
  PoseHistory poses;
  for (int i = 0; i < 3; ++i) {
    Pose pose = MakePose(20'000 * i);
    pose.is_placed = i == 1;
    poses.Add(pose);
  }
  EXPECT_TRUE(poses.At(At(20'000))->is_placed);
  EXPECT_FALSE(poses.At(At(19'999))->is_placed);
  EXPECT_FALSE(poses.At(At(20'001))->is_placed);
}

TEST(PoseHistory, BetweenTwoPosesIsLinear) {
  PoseHistory poses;
  Pose a = MakePose(0);
  Pose b = MakePose(20'000);
  b.position_map_m = {4.0, -8.0, 2.0};
  b.roll_rad = 0.4;
  b.pitch_rad = -0.2;
  b.heave_m = 1.0;
  b.covariance(0, 0) = 8.0;
  a.velocity_map_mps = {0.0, 1.0};
  b.velocity_map_mps = {2.0, 1.0};
  poses.Add(a);
  poses.Add(b);
  const auto pose = poses.At(At(5'000));
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->is_placed);
  EXPECT_EQ(pose->time, At(5'000));
  EXPECT_NEAR((pose->velocity_map_mps - Eigen::Vector2d(0.5, 1.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(pose->position_map_m.x(), 1.0, 1e-12);
  EXPECT_NEAR(pose->position_map_m.y(), -2.0, 1e-12);
  EXPECT_NEAR(pose->position_map_m.z(), 0.5, 1e-12);
  EXPECT_NEAR(pose->roll_rad, 0.1, 1e-12);
  EXPECT_NEAR(pose->pitch_rad, -0.05, 1e-12);
  EXPECT_NEAR(pose->heave_m, 0.25, 1e-12);
  EXPECT_NEAR(pose->covariance(0, 0), 2.0, 1e-12);
}

TEST(PoseHistory, HeadingGoesTheShortWayRoundNorthInBothSenses) {
  for (const auto& [from_deg, to_deg, expected_deg] : {std::tuple{350.0, 20.0, 5.0}, {20.0, 350.0, 5.0}, {358.0, 1.0, 359.5}, {90.0, 100.0, 95.0}}) {
    PoseHistory poses;
    Pose a = MakePose(0);
    Pose b = MakePose(20'000);
    a.heading_rad = DegToRad(from_deg);
    b.heading_rad = DegToRad(to_deg);
    poses.Add(a);
    poses.Add(b);
    EXPECT_NEAR(RadToDeg(poses.At(At(10'000))->heading_rad), expected_deg, 1e-9);
  }
}

TEST(PoseHistory, NothingIsKnownBetweenPosesMoreThan100MillisecondsApart) {
  PoseHistory poses;
  poses.Add(MakePose(0));
  poses.Add(MakePose(100'000));
  poses.Add(MakePose(200'001));
  EXPECT_TRUE(poses.At(At(50'000)));
  EXPECT_FALSE(poses.At(At(150'000)));
  EXPECT_TRUE(poses.At(At(200'001)));
}

TEST(PoseHistory, PosesInDifferentMapFramesDoNotMix) {
  PoseHistory poses;
  Pose a = MakePose(0);
  Pose b = MakePose(20'000);
  b.datum.latitude_deg += 0.1;
  poses.Add(a);
  poses.Add(b);
  EXPECT_FALSE(poses.At(At(10'000))->is_placed);
  EXPECT_TRUE(poses.At(At(20'000))->is_placed);
}

TEST(PoseHistory, ForgetsWhatIsOlderThanTwoMinutes) {
  PoseHistory poses;
  for (int i = 0; i <= 6100; ++i) poses.Add(MakePose(20'000 * i));
  EXPECT_TRUE(poses.At(At(20'000 * 100)));
  EXPECT_FALSE(poses.At(At(20'000 * 100 - 1)));
}

TEST(PoseHistory, DatumIsThatOfTheLatestPoseAtOrBeforeTheTime) {
  PoseHistory poses;
  Pose first = MakePose(0);
  first.datum = {};
  poses.Add(first);
  poses.Add(MakePose(20'000));
  EXPECT_TRUE(std::isnan(poses.DatumAt(At(-1)).latitude_deg));
  EXPECT_TRUE(std::isnan(poses.DatumAt(At(19'999)).latitude_deg));
  EXPECT_TRUE(poses.DatumAt(At(20'000)).IsSameAs(test::kLake));
  EXPECT_TRUE(poses.DatumAt(At(5'000'000)).IsSameAs(test::kLake));
}

TEST(Datum, EqualsItselfAlsoWithoutHeightAndNothingWhenUnknown) {
  Datum datum = test::kLake;
  datum.ellipsoid_height_m = kNan;
  EXPECT_TRUE(datum.IsSameAs(datum));
  EXPECT_FALSE(datum.IsSameAs(test::kLake));
  EXPECT_FALSE(Datum{}.IsSameAs(Datum{}));
}

}  // namespace
}  // namespace lookout::georeferencer
