// Distances for an autopilot, against exact geometry.
#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/plotter/mavlink_fixture.hpp"

namespace lookout::plotter::test {
namespace {

TEST_F(MavlinkService, SendsTheTrueDistanceOfEachSectorWhileTheBoatMovesAndTurns) {
  things_ = {Box(Ahead(1, 12.0, 0.0), 4.0, 2.0, 0.3), Box(Ahead(1, -20.0, 9.0), 6.0, 2.5, 1.2), Box(Ahead(1, 2.0, 6.0), 1.0, 1.0, 0.0),
             Box(Ahead(1, 0.0, -25.0), 60.0, 3.0, 0.5)};
  for (int i = 0; i < 5; ++i) {
    const auto frame = Last();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->system_id, 3);
    EXPECT_EQ(frame->component_id, 196);
    EXPECT_EQ(frame->At<std::uint64_t>(0), static_cast<std::uint64_t>(host_us_));
    EXPECT_EQ(frame->At<std::uint16_t>(152), 1);
    EXPECT_EQ(frame->At<std::uint16_t>(154), 4000);
    EXPECT_EQ(frame->At<float>(158), 5.0F);
    EXPECT_EQ(frame->At<float>(162), 0.0F);
    EXPECT_EQ(frame->At<std::uint8_t>(166), 12);
    ExpectTruth(*frame);
  }
}

// As of a lidar of many rings.
TEST_F(MavlinkService, SendsTheSameOfAScanInParts) {
  is_in_parts_ = true;
  things_ = {Box(Ahead(1, 12.0, 0.0), 4.0, 2.0, 0.3), Box(Ahead(1, 0.0, -25.0), 60.0, 3.0, 0.5)};
  for (int i = 0; i < 3; ++i) {
    const auto frame = Last();
    ASSERT_TRUE(frame);
    ExpectTruth(*frame);
  }
}

// The second lidar turns by itself: its scan ended 60 ms before the first one's.
TEST_F(MavlinkService, LooksWithTwoLidars) {
  auto second = params_.surroundings->lidars.front();
  second.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {-1.2, 0.2, 1.0}, .yaw_rad = DegToRad(180.0)});
  params_.surroundings->lidars.push_back(second);
  Start();
  things_ = {Box(Ahead(2, -10.0, 0.0), 3.0, 3.0, 0.3), Box(Ahead(2, 14.0, 2.0), 3.0, 3.0, 0.3)};
  Run(1);
  // The first looks ahead and abeam, the second all round but 30 deg ahead: beside the hull both are needed.
  fires_ = [](double azimuth_deg) { return azimuth_deg < 165.0 || azimuth_deg > 255.0; };
  auto frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->distance_cm(36), MavSectors::kUnknown);
  Wait(kScanUs);
  SendScan();
  fires_ = [](double azimuth_deg) { return azimuth_deg < 165.0 || azimuth_deg > 195.0; };
  SendScan(1, 60'000);
  link_->sent.clear();
  SendTracks();
  support::HandleAll(*bus_);
  ASSERT_EQ(Frames(support::kObstacleDistanceId).size(), 1U);
  ExpectTruth(Frames(support::kObstacleDistanceId).front());
}

// It is not on the earth, and has no position.
TEST_F(MavlinkService, SendsTheSameInAFrameOfItsOwn) {
  is_relative_ = true;
  pose_status_ = pose_t::STATUS_RELATIVE;
  things_ = {Box(Ahead(1, 15.0, 3.0), 4.0, 2.0, 0.3), Box(Ahead(1, 0.0, -25.0), 60.0, 3.0, 0.5)};
  for (int i = 0; i < 3; ++i) {
    const auto frame = Last();
    ASSERT_TRUE(frame);
    ExpectTruth(*frame);
  }
}

TEST_F(MavlinkService, SendsWhatTheLidarSawWherePoseKnowsNothing) {
  pose_status_ = pose_t::STATUS_UNKNOWN;
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  things_ = {Box(Ahead(1, 15.0, 3.0), 4.0, 2.0, 0.3)};
  Run(2);
  const auto frame = Last();
  ASSERT_TRUE(frame);
  ExpectTruth(*frame);
}

// The boat turns by 240 deg beside a wall that stands.
TEST_F(MavlinkService, FollowsATurnOfTheBoat) {
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = DegToRad(120.0);
  things_ = {Box(place_m_ + Vector2d(0.0, 10.0), 8.0, 1.0, 0.0)};
  for (int i = 0; i < 20; ++i) {
    const auto frame = Last();
    ASSERT_TRUE(frame);
    ExpectTruth(*frame);
  }
}

TEST_F(MavlinkService, SendsCoastingTracksThatAreNotSeenWhereTheyHaveGone) {
  turn_radps_ = 0.0;
  const auto outline_m = Box(Ahead(1, 10.0, 0.0), 2.0, 2.0, -heading_rad_);
  auto track = TrackOf(7, outline_m, track_t::STATUS_COASTING);
  tracks_ = {track};
  auto frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->distance_cm(0), 900, 2);
  EXPECT_EQ(frame->distance_cm(20), 4001);
  // POSE is 60 ms farther than TRACKS: the track has gone on, and so has the boat.
  Wait(kScanUs);
  SendScan();
  auto ahead_m = Box(Ahead(0, 10.0, 0.0), 2.0, 2.0, -heading_rad_);
  track = TrackOf(7, ahead_m, track_t::STATUS_COASTING);
  const Vector2d bow(std::sin(heading_rad_), std::cos(heading_rad_));
  track.velocity_map_mps[0] = 5.0 * bow.x();
  track.velocity_map_mps[1] = 5.0 * bow.y();
  tracks_ = {track};
  const auto end_us = host_us_;
  Wait(60'000);
  host_us_ = end_us;
  link_->sent.clear();
  SendTracks();
  support::HandleAll(*bus_);
  const auto frames = Frames(support::kObstacleDistanceId);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_NEAR(frames.front().distance_cm(0), 100.0 * (9.0 + 0.06 * (5.0 - velocity_mps_.dot(bow))), 3.0);
}

TEST_F(MavlinkService, LeavesOutWhatMayBeSprayAndTentativeAndLostTracks) {
  things_ = {Box(Ahead(1, 10.0, 0.0), 1.0, 1.0, 0.0)};
  is_sure_ = false;
  tracks_ = {TrackOf(-2, Box(Ahead(1, 0.0, 10.0), 2.0, 2.0, 0.0), track_t::STATUS_TENTATIVE),
             TrackOf(5, Box(Ahead(1, 0.0, -10.0), 2.0, 2.0, 0.0), track_t::STATUS_LOST)};
  auto frame = Last();
  ASSERT_TRUE(frame);
  for (std::size_t i = 0; i < kNumSectors; ++i) EXPECT_EQ(frame->distance_cm(i), 4001) << i;
  // Land it is by what is remembered.
  land_ids_ = {1};
  frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_LT(frame->distance_cm(0), 1000);
  land_ids_.clear();
  // Or a confirmed track explains it, as one of a buoy with a return a scan.
  tracks_ = {TrackOf(5, Box(Ahead(1, 0.0, -10.0), 2.0, 2.0, 0.0))};
  tracks_.front().segment_ids = {1};
  tracks_.front().num_segments = 1;
  frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_LT(frame->distance_cm(0), 1000);
}

// The outline of a dock around the berth bridges its mouth; its returns do not.
TEST_F(MavlinkService, SendsTheReturnsOfAStructureThatIsSeenAndNotItsOutline) {
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  things_ = {Box(Ahead(1, -6.0, 0.0), 12.0, 1.0, -heading_rad_), Box(Ahead(1, 0.0, 6.0), 1.0, 12.0, -heading_rad_),
             Box(Ahead(1, 0.0, -6.0), 1.0, 12.0, -heading_rad_)};
  tracks_ = {TrackOf(9, Box(Ahead(1, 0.0, 0.0), 13.0, 13.0, -heading_rad_))};
  for (const bool is_structure : {true, false}) {
    tracks_.front().kind = is_structure ? std::int32_t{track_t::KIND_STRUCTURE} : std::int32_t{track_t::KIND_UNKNOWN};
    tracks_.front().segment_ids = {1};
    tracks_.front().num_segments = 1;
    const auto frame = Last();
    ASSERT_TRUE(frame);
    ExpectTruth(*frame);
    EXPECT_EQ(frame->distance_cm(0), 4001);
  }
}

// On a beach what was seen before, when a beam met it lower, is nearer than what is seen now. TRACKS tell it every tenth scan.
TEST_F(MavlinkService, SendsRememberedLandUntilItIsToldNoMore) {
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  waterline_m_ = {Ahead(0, 15.0, 0.0), Ahead(0, 0.0, 60.0)};
  auto frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->distance_cm(0), 1500, 1);
  EXPECT_EQ(frame->distance_cm(18), 4001);
  waterline_m_.clear();
  for (int i = 0; i < 10; ++i) frame = Last();
  EXPECT_NEAR(frame->distance_cm(0), 1500, 1);
  Run(25);
  EXPECT_EQ(Last()->distance_cm(0), 4001);
}

TEST_F(MavlinkService, SaysUnknownWhereNobodyLooks) {
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  // The lidar is turned by 30 deg to port: it does not fire from 120 to 240 deg of its own, 90 to 210 deg of the boat.
  fires_ = [](double azimuth_deg) { return azimuth_deg < 120.0 || azimuth_deg > 240.0; };
  tracks_ = {TrackOf(4, Box(Ahead(1, -10.0, 0.0), 2.0, 2.0, -heading_rad_), track_t::STATUS_COASTING)};
  const auto frame = Last();
  ASSERT_TRUE(frame);
  for (std::size_t i = 20; i < 41; ++i) {
    const bool is_thing = i >= 35 && i <= 37;
    EXPECT_EQ(frame->distance_cm(i) == MavSectors::kUnknown, !is_thing) << i;
  }
  EXPECT_NEAR(frame->distance_cm(36), 900, 2);  // what was there before is told
  EXPECT_EQ(frame->distance_cm(0), 4001);
  EXPECT_EQ(frame->distance_cm(50), 4001);
}

// At the start, or where the map becomes another one: the boat's way within the scan is not known.
TEST_F(MavlinkService, SaysNothingIsClearWhereAPoseWithinTheScanIsMissing) {
  host_us_ += 20'000;
  NextScan();
  for (const auto& frame : Frames(support::kObstacleDistanceId)) {
    for (std::size_t i = 0; i < kNumSectors; ++i) EXPECT_EQ(frame.distance_cm(i), MavSectors::kUnknown) << i;
  }
  const auto frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->distance_cm(0), 4001);
}

// Lasers off: packets came, without a return, and all was clear.
TEST_F(MavlinkService, SendsNothingWhereTheLidarSeesNothingAnyMore) {
  const std::vector<Polygon> quay{Box(Ahead(1, 0.0, -25.0), 60.0, 3.0, 0.5)};
  const auto num_of = [this](std::uint16_t distance_cm) {
    const auto frame = Last();
    int count = 0;
    for (std::size_t i = 0; frame && i < kNumSectors; ++i) count += frame->distance_cm(i) == distance_cm ? 1 : 0;
    return count;
  };
  constexpr std::uint16_t kClear = 4001;
  EXPECT_GT(num_of(kClear), 60) << "flat water is clear where nothing says otherwise";
  things_ = quay;
  for (int i = 0; i < 20; ++i) num_of(kClear);
  EXPECT_GT(num_of(kClear), 20);
  things_.clear();
  EXPECT_FALSE(Last()) << "nothing is known";
  tracks_ = {TrackOf(4, Box(Ahead(1, 10.0, 0.0), 2.0, 2.0, -heading_rad_))};
  EXPECT_FALSE(Last()) << "nor what is beside the track";
  tracks_.clear();
  things_ = quay;
  EXPECT_EQ(num_of(kClear), 0) << "after one scan it may be strays";
  num_of(kClear);
  EXPECT_GT(num_of(kClear), 20);
}

// The returns of a scan that did not come may be of anything: its tracks alone would have said that all else is unknown, which ArduPilot takes for
// clear.
TEST_F(MavlinkService, SendsNothingWithoutTheScan) {
  things_ = {Box(Ahead(1, 10.0, 0.0), 2.0, 2.0, -heading_rad_)};
  tracks_ = {TrackOf(4, things_.front())};
  for (bool* sends : {&sends_scan_, &sends_labels_}) {
    EXPECT_TRUE(Last());
    *sends = false;
    EXPECT_FALSE(Last());
    *sends = true;
  }
}

}  // namespace
}  // namespace lookout::plotter::test
