#include "services/georeferencer/core/georeferencer.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <string>

#include "tests/support/counters.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using std::chrono::milliseconds;
using test::At;
using test::MakePart;
using test::MakePoint;
using test::MakePose;

Georeferencer Make() { return {PlacementParams{}, milliseconds(500)}; }

// A turn from `offset_us` on, with one obstacle at 10 ms and one at 90 ms of it.
SegmentPart Turn(std::int64_t offset_us, std::int64_t seq) {
  auto early = MakePoint(offset_us + 10'000, 10.0, 0.0, 0.0);
  auto late = MakePoint(offset_us + 90'000, 20.0, 0.0, 0.0);
  late.id = 2;
  return MakePart(offset_us, seq, {early, late});
}

// Poses from `first_us` to `last_us`; gives what they released.
std::vector<ObstaclePart> AddPoses(Georeferencer& georeferencer, std::int64_t first_us, std::int64_t last_us) {
  std::vector<ObstaclePart> all;
  for (auto offset_us = first_us; offset_us <= last_us; offset_us += 20'000) {
    for (auto& part : georeferencer.AddPose(MakePose(offset_us))) all.push_back(std::move(part));
  }
  return all;
}

TEST(Georeferencer, ReleasesATurnWithTheFirstPoseAtOrAfterItsEnd) {
  auto georeferencer = Make();
  EXPECT_TRUE(georeferencer.AddSegments(Turn(0, 7)).empty());
  EXPECT_TRUE(AddPoses(georeferencer, 0, 80'000).empty());
  const auto released = georeferencer.AddPose(MakePose(100'000));
  ASSERT_EQ(released.size(), 1U);
  EXPECT_EQ(released[0].head.seq, 7);
  ASSERT_EQ(released[0].obstacles.size(), 2U);
  EXPECT_EQ(released[0].obstacles[1].status, ObstacleStatus::kOk);
  EXPECT_TRUE(released[0].datum.IsSameAs(test::kLake));
}

// The pose of that instant is all that it needs: waiting for the next would cost 20 ms.
TEST(Georeferencer, ReleasesAScanWithThePoseOfItsVeryEnd) {
  auto georeferencer = Make();
  auto part = Turn(0, 7);
  part.head.end_time = At(100'000);
  EXPECT_TRUE(georeferencer.AddSegments(part).empty());
  EXPECT_TRUE(AddPoses(georeferencer, 0, 80'000).empty());
  EXPECT_EQ(georeferencer.AddPose(MakePose(100'000)).size(), 1U);
}

TEST(Georeferencer, ReleasesAtOnceWhenPoseWasFaster) {
  auto georeferencer = Make();
  AddPoses(georeferencer, 0, 1'000'000);
  EXPECT_EQ(georeferencer.AddSegments(Turn(200'000, 2)).size(), 1U);
}

TEST(Georeferencer, ReleasesInTheOrderOfArrivalAlsoWhenALaterOneWasReadyBefore) {
  auto georeferencer = Make();
  georeferencer.AddSegments(Turn(200'000, 2));
  georeferencer.AddSegments(Turn(0, 1));
  EXPECT_TRUE(AddPoses(georeferencer, 0, 280'000).empty());
  const auto released = georeferencer.AddPose(MakePose(300'000));
  ASSERT_EQ(released.size(), 2U);
  EXPECT_EQ(released[0].head.seq, 2);
  EXPECT_EQ(released[1].head.seq, 1);
}

TEST(Georeferencer, ATurnWithoutObstaclesIsReleasedToo) {
  auto georeferencer = Make();
  georeferencer.AddSegments(MakePart(0, 0, {}));
  const auto released = AddPoses(georeferencer, 0, 100'000);
  ASSERT_EQ(released.size(), 1U);
  EXPECT_TRUE(released[0].obstacles.empty());
}

TEST(Georeferencer, WithoutHostTimeNothingTimesOut) {
  auto georeferencer = Make();
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(georeferencer.AddSegments(Turn(100'000 * i, i)).empty());
  EXPECT_EQ(support::CountOf(georeferencer, "parts_waiting"), 100);
}

TEST(Georeferencer, AfterTheTimeoutReleasesWhatWaitsAndMarksOnlyWhatHasNoPose) {
  auto georeferencer = Make();
  georeferencer.AdvanceTo(At(0));
  georeferencer.AddSegments(Turn(0, 0));
  AddPoses(georeferencer, 0, 80'000);
  EXPECT_TRUE(georeferencer.AdvanceTo(At(500'000)).empty()) << "not longer than the time-out";
  const auto released = georeferencer.AdvanceTo(At(500'001));
  ASSERT_EQ(released.size(), 1U);
  EXPECT_EQ(released[0].obstacles[0].status, ObstacleStatus::kOk);
  EXPECT_EQ(released[0].obstacles[1].status, ObstacleStatus::kPoseTimeout);
  EXPECT_EQ(support::CountOf(georeferencer, "parts_timed_out"), 1);
  EXPECT_EQ(georeferencer.last_timeout(), At(500'001));
}

TEST(Georeferencer, WhatArrivedLaterWaitsLonger) {
  auto georeferencer = Make();
  georeferencer.AdvanceTo(At(0));
  georeferencer.AddSegments(Turn(0, 0));
  georeferencer.AdvanceTo(At(300'000));
  georeferencer.AddSegments(Turn(100'000, 1));
  EXPECT_EQ(georeferencer.AdvanceTo(At(600'000)).size(), 1U);
  EXPECT_EQ(georeferencer.AdvanceTo(At(700'000)).size(), 0U);
  EXPECT_EQ(georeferencer.AdvanceTo(At(900'000)).size(), 1U);
}

// Who looks out without a navigator should not see everything half a second late.
TEST(Georeferencer, WaitsInVainForASecondOnlyWherePoseIsSilent) {
  auto georeferencer = Make();
  georeferencer.AdvanceTo(At(0));
  AddPoses(georeferencer, 0, 80'000);
  georeferencer.AdvanceTo(At(950'000));
  georeferencer.AddSegments(Turn(100'000, 0));
  EXPECT_TRUE(georeferencer.AdvanceTo(At(1'000'000)).empty());
  EXPECT_EQ(georeferencer.AdvanceTo(At(1'010'000)).size(), 1U);
  georeferencer.AddSegments(Turn(200'000, 1));
  EXPECT_EQ(georeferencer.AdvanceTo(At(1'020'000)).size(), 1U);
  AddPoses(georeferencer, 1'000'000, 1'000'000);
  georeferencer.AddSegments(Turn(1'000'000, 2));
  EXPECT_TRUE(georeferencer.AdvanceTo(At(1'500'000)).empty()) << "it is back";
}

TEST(Georeferencer, AHostClockThatIsSetBackDoesNotMakeItWaitForever) {
  auto georeferencer = Make();
  georeferencer.AdvanceTo(At(3'600'000'000));
  georeferencer.AddSegments(Turn(0, 0));
  EXPECT_TRUE(georeferencer.AdvanceTo(At(0)).empty());
  EXPECT_EQ(georeferencer.AdvanceTo(At(600'000)).size(), 1U);
}

TEST(Georeferencer, WhatArrivedBeforeHostTimeWasKnownWaitsFromThenOn) {
  auto georeferencer = Make();
  georeferencer.AddSegments(Turn(0, 0));
  EXPECT_TRUE(georeferencer.AdvanceTo(At(1'000'000)).empty());
  EXPECT_EQ(georeferencer.AdvanceTo(At(1'600'000)).size(), 1U);
}

TEST(Georeferencer, HoldsAThousandAndThenGivesTheOldestUp) {
  auto georeferencer = Make();
  for (std::int64_t i = 0; i < 1000; ++i) ASSERT_TRUE(georeferencer.AddSegments(Turn(100'000 * i, i)).empty());
  const auto released = georeferencer.AddSegments(Turn(100'000'000, 1000));
  ASSERT_EQ(released.size(), 1U);
  EXPECT_EQ(released[0].head.seq, 0);
  EXPECT_EQ(released[0].obstacles[0].status, ObstacleStatus::kPoseTimeout);
  EXPECT_EQ(support::CountOf(georeferencer, "parts_overflowed"), 1);
}

TEST(Georeferencer, ATurnFromTheFarFutureHoldsUpOthersUntilTheQueueIsFullAndLosesNone) {
  auto georeferencer = Make();
  georeferencer.AddSegments(Turn(1'000'000'000'000, 0));
  std::size_t num_released = 0;
  for (std::int64_t i = 1; i <= 1000; ++i) {
    AddPoses(georeferencer, 100'000 * i, 100'000 * i + 80'000);
    num_released += georeferencer.AddSegments(Turn(100'000 * (i - 1), i)).size();
  }
  EXPECT_EQ(num_released, 1001U);
  EXPECT_EQ(support::CountOf(georeferencer, "parts_waiting"), 0);
}

TEST(Georeferencer, AtTheEndReleasesAllWithThePosesThatAreThere) {
  auto georeferencer = Make();
  georeferencer.AddSegments(Turn(0, 0));
  georeferencer.AddSegments(Turn(100'000, 1));
  AddPoses(georeferencer, 0, 80'000);
  const auto released = georeferencer.Finish();
  ASSERT_EQ(released.size(), 2U);
  EXPECT_EQ(released[0].obstacles[0].status, ObstacleStatus::kOk);
  EXPECT_EQ(released[0].obstacles[1].status, ObstacleStatus::kVesselFrameOnly);
  EXPECT_EQ(released[1].obstacles[0].status, ObstacleStatus::kVesselFrameOnly);
  EXPECT_TRUE(georeferencer.Finish().empty());
}

TEST(Georeferencer, ADoublePoseIsLeftOutAndCounted) {
  auto georeferencer = Make();
  AddPoses(georeferencer, 0, 80'000);
  Pose second = MakePose(80'000);
  second.position_map_m.x() = 5.0;
  georeferencer.AddPose(second);
  EXPECT_EQ(georeferencer.poses().newest()->position_map_m.x(), 0.0);
  EXPECT_EQ(support::CountOf(georeferencer, "poses_duplicate"), 1);
  EXPECT_EQ(support::CountOf(georeferencer, "pose_restarts"), 0);
}

TEST(Georeferencer, APoseThatGoesBackInTimeBeginsANewRun) {
  auto georeferencer = Make();
  AddPoses(georeferencer, 0, 1'000'000);
  AddPoses(georeferencer, 500'000, 580'000);
  EXPECT_EQ(support::CountOf(georeferencer, "pose_restarts"), 1);
  EXPECT_FALSE(georeferencer.poses().At(At(490'000)));
  EXPECT_TRUE(georeferencer.poses().At(At(510'000)));
}

TEST(Georeferencer, ANewRunFarInThePastReleasesWhatTheOldOneLeftBehind) {
  auto georeferencer = Make();
  constexpr std::int64_t kOldRunUs = 3'600'000'000;
  AddPoses(georeferencer, kOldRunUs, kOldRunUs + 40'000);
  georeferencer.AddSegments(Turn(kOldRunUs, 99));
  georeferencer.AddSegments(Turn(0, 0));
  const auto released = georeferencer.AddPose(MakePose(0));
  ASSERT_EQ(released.size(), 1U);
  EXPECT_EQ(released[0].head.seq, 99);
  EXPECT_EQ(released[0].obstacles[0].status, ObstacleStatus::kOk) << "by the poses of its own run";
  EXPECT_EQ(released[0].obstacles[1].status, ObstacleStatus::kVesselFrameOnly);
  EXPECT_EQ(AddPoses(georeferencer, 20'000, 100'000).size(), 1U);
}

TEST(Georeferencer, CountsObstaclesByStatusAndThinnedOutlines) {
  auto georeferencer = Make();
  auto segment = MakePoint(10'000, 10.0, 0.0, 0.0);
  segment.hull.assign(kMaxFootprintVertices + 1, segment.hull[0]);
  georeferencer.AddSegments(MakePart(0, 0, {segment}));
  AddPoses(georeferencer, 0, 100'000);
  EXPECT_EQ(support::CountOf(georeferencer, "obstacles_ok"), 1);
  EXPECT_EQ(support::CountOf(georeferencer, "footprints_thinned"), 1);
  EXPECT_EQ(support::CountOf(georeferencer, "parts_released"), 1);
}

}  // namespace
}  // namespace lookout::georeferencer
