#include "services/tracker/core/dangers.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout::tracker {
namespace {

Pose Own(double heading_deg = 0.0, const Eigen::Vector2d& velocity_mps = {0.0, 2.0}) {
  Pose own;
  own.is_placed = true;
  own.position_map_m = {100.0, 50.0, 0.0};
  own.heading_rad = DegToRad(heading_deg);
  own.velocity_map_mps = velocity_mps;
  return own;
}

Track At(std::int64_t id, const Eigen::Vector2d& from_own_m, TrackStatus status = TrackStatus::kConfirmed) {
  Track track;
  track.id = id;
  track.status = status;
  track.existence_probability = 1.0;
  const Eigen::Vector2d center = Eigen::Vector2d(100.0, 50.0) + from_own_m;
  track.outline_m = {center + Eigen::Vector2d(-0.5, -0.5), center + Eigen::Vector2d(0.5, -0.5), center + Eigen::Vector2d(0.5, 0.5),
                     center + Eigen::Vector2d(-0.5, 0.5)};
  track.approach = {.distance_m = from_own_m.norm() - 2.0, .cpa_m = 1.0, .tcpa_s = 9.0, .probability = 0.8};
  return track;
}

// A square of 1 m with its nearest return, so far ahead of the vessel.
VesselOutline Ahead(std::int32_t id, double distance_m, bool is_sure = true) {
  VesselOutline outline;
  outline.segment_id = id;
  outline.is_sure = is_sure;
  outline.corners_m = {{distance_m, -0.5}, {distance_m + 1.0, -0.5}, {distance_m + 1.0, 0.5}, {distance_m, 0.5}};
  outline.nearest_m = {distance_m, 0.0};
  return outline;
}

VesselOutline Land(std::int32_t id, const std::vector<Eigen::Vector2d>& waterline_vessel_m) {
  VesselOutline land;
  land.segment_id = id;
  land.is_land = land.is_line = true;
  land.corners_m = waterline_vessel_m;
  return land;
}

constexpr ApproachParams kApproach{.limit_m = 5.0};
constexpr GuardZoneParams kZone{.range_m = 10.0, .bearing = {DegToRad(300.0), DegToRad(120.0)}};

TEST(GuardZoneDangers, AreNearAndInTheSector) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 6.0}), At(2, {0.0, 13.0}), At(3, {0.0, -6.0}), At(4, {6.0, 4.5})};
  const auto dangers = GuardZoneDangers(kZone, picture, {}, Own());
  ASSERT_EQ(dangers.size(), 2U);
  EXPECT_EQ(dangers[0].thing, 1);
  EXPECT_NEAR(dangers[0].distance_m, 5.5, 1e-9);
  EXPECT_NEAR(WrapToPi(dangers[0].bearing_rad), 0.0, 1e-9);
  EXPECT_FALSE(dangers[0].is_grave) << "what is in the zone is worth a look";
  EXPECT_EQ(dangers[0].probability, 1.0);
  EXPECT_EQ(dangers[1].thing, 4);
}

// 0.5 m and less beyond the edge, now in and now out: below what raises an alert, above what ends one.
TEST(GuardZoneDangers, AtTheEdgeOfTheZoneEndNoAlert) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 11.0})};
  const auto dangers = GuardZoneDangers(kZone, picture, {}, Own());
  ASSERT_EQ(dangers.size(), 1U);
  EXPECT_LT(dangers[0].probability, AlertParams{}.raise_probability);
  EXPECT_GT(dangers[0].probability, AlertParams{}.clear_probability);
  picture.tracks[0].status = TrackStatus::kTentative;
  EXPECT_TRUE(GuardZoneDangers(kZone, picture, {}, Own()).empty());
}

// One end of a pontoon, then the other: beside a boat that is tied up to it.
TEST(GuardZoneDangers, OfAPieceOfTheBerthEndNoAlertAndRaiseNone) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 8.0}), At(2, {1.5, 8.0})};
  for (auto& track : picture.tracks) track.rectangle.center_m = track.position_m = track.outline_m[0];
  picture.tracks[0].velocity_mps = {3.0, 0.0};
  Proof proof;
  proof.Update(picture.tracks);
  const auto told = [&](const Proof* doubted, GuardZoneParams zone = kZone) {
    return GuardZoneDangers(zone, picture, {}, Own(), {}, nullptr, {}, doubted).at(0);
  };
  EXPECT_EQ(told(nullptr).probability, 1.0);
  const auto doubted = told(&proof);
  EXPECT_LT(doubted.probability, AlertParams{}.raise_probability);
  EXPECT_GT(doubted.probability, AlertParams{}.clear_probability);
  EXPECT_TRUE(doubted.places.empty()) << "no acknowledgement covers it";
  auto all = kZone;
  all.takes_tentative = true;
  EXPECT_EQ(told(&proof, all).probability, 1.0) << "such a zone tells all";
  picture.tracks[0].velocity_mps.setZero();
  proof.Update(picture.tracks);
  EXPECT_EQ(told(&proof).probability, 1.0);
}

// A speedboat comes at a boat at anchor: nobody waits until it has shown that it moves.
TEST(GuardZoneDangers, OfABoatInOpenWaterAreOfABoatThatLiesStillToo) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 8.0})};
  picture.tracks[0].rectangle.center_m = picture.tracks[0].position_m = picture.tracks[0].outline_m[0];
  picture.tracks[0].velocity_mps = {0.0, -12.0};
  Proof proof;
  proof.Update(picture.tracks);
  ASSERT_FALSE(proof.IsProven(picture.tracks[0]));
  EXPECT_EQ(GuardZoneDangers(kZone, picture, {}, Own(), {}, nullptr, {}, &proof).at(0).probability, 1.0);
}

TEST(GuardZoneDangers, TurnWithTheBoat) {
  Picture picture;
  picture.tracks = {At(1, {6.0, 0.0})};  // to the east
  EXPECT_TRUE(GuardZoneDangers(kZone, picture, {}, Own(0.0)).empty());
  const auto dangers = GuardZoneDangers(kZone, picture, {}, Own(80.0));
  ASSERT_EQ(dangers.size(), 1U);
  EXPECT_GT(WrapToPi(dangers[0].bearing_rad), 0.0) << "to starboard of the bow";
  EXPECT_EQ(GuardZoneDangers(kZone, picture, {}, Own(100.0)).size(), 1U);
  EXPECT_TRUE(GuardZoneDangers(kZone, picture, {}, Own(180.0)).empty());
}

TEST(GuardZoneDangers, AreTentativeOnlyWhereTheZoneTakesThem) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 6.0}, TrackStatus::kTentative), At(2, {0.0, 6.0}, TrackStatus::kLost), At(3, {0.0, 6.0}, TrackStatus::kCoasting)};
  EXPECT_EQ(GuardZoneDangers(kZone, picture, {}, Own()).size(), 1U);
  auto all = kZone;
  all.takes_tentative = true;
  EXPECT_EQ(GuardZoneDangers(all, picture, {}, Own()).size(), 2U);
}

TEST(GuardZoneDangers, AreKnownOfATrackThatIsSeenForASecond) {
  const Utime now{std::chrono::seconds(1000)};
  Picture picture;
  picture.tracks = {At(1, {0.0, 6.0})};
  const auto is_known = [&](const std::vector<VesselOutline>& outlines = {}) {
    const auto dangers = GuardZoneDangers(kZone, picture, outlines, Own(), {}, nullptr, now);
    return dangers.size() == 1 && dangers.front().is_known;
  };
  picture.tracks[0].first = now - std::chrono::milliseconds(900);
  EXPECT_FALSE(is_known());
  picture.tracks[0].first = now - std::chrono::milliseconds(1000);
  EXPECT_TRUE(is_known());
  picture.tracks[0].status = TrackStatus::kCoasting;
  EXPECT_FALSE(is_known()) << "it is not seen now";
  // Its segment reaches into the zone in one scan, as with a crest before it.
  picture.tracks = {At(1, {0.0, 12.0})};
  picture.tracks[0].segment_ids = {4};
  EXPECT_FALSE(is_known({Ahead(4, 9.5)}));
}

TEST(GuardZoneDangers, OfLandAreOne) {
  Picture picture;
  auto remembered = Land(8, {{7.0, -20.0}, {7.0, 20.0}});
  remembered.is_land = false;
  picture.land_segment_ids = {8};
  const std::vector<VesselOutline> outlines{Land(7, {{9.0, -20.0}, {9.0, 20.0}}), remembered, Land(9, {{-3.0, -20.0}, {-3.0, 20.0}})};
  const auto dangers = GuardZoneDangers(kZone, picture, outlines, Own());
  ASSERT_EQ(dangers.size(), 1U);
  EXPECT_EQ(dangers[0].thing, kLandTrack);
  EXPECT_NEAR(dangers[0].distance_m, 7.0, 1e-9) << "between its corners; what is astern is not in the sector";
}

// Of land an acknowledgement covers places: the nearest of each bearing, on the map where the own pose is known.
TEST(GuardZoneDangers, OfLandTellTheNearestOfEachBearing) {
  const std::vector<VesselOutline> outlines{Land(7, {{6.0, -20.0}, {6.0, 20.0}}), Land(8, {{3.0, 5.0}, {3.0, 20.0}})};
  const auto dangers = GuardZoneDangers(kZone, {}, outlines, Own(90.0));
  ASSERT_EQ(dangers.size(), 1U);
  const auto& places = dangers[0].places;
  // As far as 53 deg to both sides the wall is within 10 m; from 60 deg to port on the sector ends.
  ASSERT_GT(places.size(), 20U);
  double least_m = 100.0;
  for (const auto& place : places) {
    const double bearing_rad = WrapToPi(place.bearing_rad);
    EXPECT_LE(std::fabs(bearing_rad), DegToRad(60.0));
    EXPECT_LE(place.range_m, 10.0);
    const bool is_wall = std::fabs(place.range_m * std::cos(bearing_rad) - 6.0) < 1e-9;
    const bool is_shore = std::fabs(place.range_m * std::cos(bearing_rad) - 3.0) < 1e-9 && bearing_rad < DegToRad(-55.0);
    EXPECT_TRUE(is_wall || is_shore) << bearing_rad;
    // The bow points east: ahead of the boat at (100, 50).
    EXPECT_NEAR(place.position_map_m.x(), 100.0 + place.range_m * std::cos(bearing_rad), 1e-6);
    EXPECT_NEAR(place.position_map_m.y(), 50.0 - place.range_m * std::sin(bearing_rad), 1e-6);
    least_m = std::min(least_m, place.range_m);
  }
  EXPECT_NEAR(least_m, dangers[0].distance_m, 1e-9);
}

// Somebody swims beside a quay that was acknowledged: his place is told with those of the quay, or nobody would hear of him.
TEST(GuardZoneDangers, OfLandTellWhatComesUpBesideIt) {
  Picture picture;
  const std::vector<VesselOutline> outlines{Land(1, {{9.0, -20.0}, {9.0, 20.0}}), Ahead(2, 7.5)};
  Newcomers newcomers;
  Things things;
  const auto dangers = GuardZoneDangers(kZone, picture, outlines, Own(), things, &newcomers, Utime{});
  ASSERT_EQ(dangers.size(), 1U);
  EXPECT_EQ(dangers[0].thing, kLandTrack);
  EXPECT_NEAR(std::ranges::min_element(dangers[0].places, {}, &DangerPlace::range_m)->range_m, 7.5, 1e-9);
}

// The shore of a basin is an open line: what lies in its mouth is no part of it.
TEST(GuardZoneDangers, OfLandAreNotInTheMouthOfAHarbour) {
  Picture picture;
  const std::vector<VesselOutline> outlines{Land(1, {{6.0, 20.0}, {40.0, 20.0}, {40.0, -20.0}, {6.0, -20.0}}), Ahead(2, 6.0)};
  Newcomers newcomers;
  Things things;
  constexpr std::chrono::milliseconds kScan(100);
  std::vector<Danger> dangers;
  for (int scan = 0; scan < 20; ++scan) dangers = GuardZoneDangers(kZone, picture, outlines, Own(), things, &newcomers, Utime{} + scan * kScan);
  ASSERT_EQ(dangers.size(), 1U);
  EXPECT_EQ(dangers[0].thing, kUnnamed);
}

TEST(GuardZoneDangers, OfWhatHasNoTrackTellEachThing) {
  const auto dangers = GuardZoneDangers(kZone, {}, std::vector{Ahead(4, 8.0), Ahead(5, 9.5), Ahead(6, 12.0)}, std::nullopt);
  ASSERT_EQ(dangers.size(), 1U);
  ASSERT_EQ(dangers[0].places.size(), 2U);
  EXPECT_NEAR(dangers[0].places[0].range_m, 8.0, 1e-9);
  EXPECT_NEAR(dangers[0].places[1].range_m, 9.5, 1e-9);
  EXPECT_TRUE(dangers[0].places[0].position_map_m.hasNaN());
}

// What is sure counts from the first scan that shows it, whatever the tracker makes of it.
TEST(GuardZoneDangers, AreOfWhatIsSeenBeforeItIsConfirmed) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 30.0}, TrackStatus::kTentative), At(2, {0.0, 30.0})};
  picture.tracks[0].segment_ids = {4};
  picture.tracks[0].existence_probability = 0.7;
  picture.tracks[1].segment_ids = {5};
  const std::vector<VesselOutline> outlines{Ahead(4, 8.0), Ahead(5, 7.0, false), Ahead(6, 6.0), Ahead(7, 5.0, false), Ahead(8, 11.0)};
  const auto dangers = GuardZoneDangers(kZone, picture, outlines, Own());
  ASSERT_EQ(dangers.size(), 3U);
  EXPECT_EQ(dangers[0].thing, kUnnamed) << "of no track";
  EXPECT_NEAR(dangers[0].distance_m, 6.0, 1e-9);
  EXPECT_EQ(dangers[1].thing, 1);
  EXPECT_NEAR(dangers[1].distance_m, 8.0, 1e-9) << "where it is seen, not where the track is";
  EXPECT_EQ(dangers[2].thing, 2) << "tentative in this scan, but confirmed by others";
}

TEST(GuardZoneDangers, AreFoundWithoutAPose) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 6.0})};  // where that is from the vessel nobody knows
  const auto dangers =
      GuardZoneDangers(kZone, picture, std::vector{Ahead(4, 8.0), Ahead(5, 9.5), Land(6, {{7.0, -20.0}, {7.0, 20.0}})}, std::nullopt);
  ASSERT_EQ(dangers.size(), 2U);
  EXPECT_EQ(dangers[0].thing, kUnnamed);
  EXPECT_NEAR(dangers[0].distance_m, 8.0, 1e-9) << "the nearest";
  EXPECT_EQ(dangers[1].thing, kLandTrack);
}

TEST(GuardZoneDangers, AreAsNearAsTheNearestReturn) {
  auto outline = Ahead(4, 8.0);
  outline.nearest_m = {3.0, 0.0};
  EXPECT_NEAR(GuardZoneDangers(kZone, {}, std::vector{outline}, Own()).at(0).distance_m, 3.0, 1e-9);
}

TEST(GuardZoneDangers, AreNoneWithoutAZone) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 1.0})};
  EXPECT_TRUE(GuardZoneDangers({}, picture, std::vector{Ahead(4, 1.0)}, Own()).empty());
}

TEST(ClosestApproachDangers, AreThoseOfConfirmedAndCoastingTracks) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 6.0}), At(2, {0.0, 26.0}, TrackStatus::kCoasting), At(3, {0.0, 6.0}, TrackStatus::kTentative),
                    At(4, {0.0, 6.0}, TrackStatus::kLost)};
  const auto dangers = ClosestApproachDangers(kApproach, picture, Own(), false);
  ASSERT_EQ(dangers.size(), 2U);
  EXPECT_EQ(dangers[0].thing, 1);
  EXPECT_TRUE(dangers[0].is_grave);
  EXPECT_EQ(dangers[0].time_left_s, 0.0);
  EXPECT_EQ(dangers[0].probability, 0.8);
  EXPECT_EQ(dangers[0].tcpa_s, 9.0);
  EXPECT_EQ(dangers[1].thing, 2);
  EXPECT_GT(dangers[1].time_left_s, 5.0);
}

TEST(ClosestApproachDangers, AreNoneBetweenWhatStandsAndABoatThatLiesStill) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 3.0}), At(2, {0.0, 9.0})};
  picture.tracks[1].velocity_mps = {0.0, -1.0};
  const auto dangers = ClosestApproachDangers(kApproach, picture, Own(), true);
  ASSERT_EQ(dangers.size(), 1U);
  EXPECT_EQ(dangers[0].thing, 2) << "another that comes is told";
  EXPECT_EQ(ClosestApproachDangers(kApproach, picture, Own(), false).size(), 2U);
}

constexpr Utime kStart{std::chrono::seconds(1'700'000'000)};

// One end of a pontoon, then the other: it seems to run at the boat. That is nothing, but the pontoon itself is too near where it lies ahead.
TEST(ClosestApproachDangers, OfAPieceOfWhatStandsCountAsIfItStood) {
  for (const double abeam_m : {20.0, 3.0}) {
    for (const bool is_own_still : {false, true}) {
      Picture picture;
      picture.tracks = {At(1, {abeam_m + 3.0, 20.0}), At(2, {abeam_m, 20.0})};
      for (auto& track : picture.tracks) track.rectangle.center_m = track.position_m = track.outline_m[0];
      picture.tracks[0].approach.probability = 0.0;
      picture.tracks[1].velocity_mps = {-4.0, -4.0};
      picture.tracks[1].approach.tcpa_s = 3.0;
      if (abeam_m < 10.0) picture.tracks[1].approach_if_standing = {.distance_m = 20.0, .cpa_m = 3.0, .tcpa_s = 10.0, .probability = 0.9};
      picture.tracks[1].first = kStart - std::chrono::seconds(5);
      picture.tracks[1].seen = kStart;
      Proof proof;
      proof.Update(picture.tracks);
      const auto dangers = ClosestApproachDangers(kApproach, picture, Own(), is_own_still, {}, &proof, kStart);
      const auto& piece = dangers.back();
      EXPECT_EQ(piece.thing, 2);
      EXPECT_EQ(piece.probability > 0.0, abeam_m < 10.0 && !is_own_still) << abeam_m << " " << is_own_still;
    }
  }
}

// A boat at its mooring, dead ahead, swings: a velocity that has not shown itself takes no warning away.
TEST(ClosestApproachDangers, OfACourseThatIsNotProvenAreToldNoLaterThanIfItStood) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 30.0})};
  auto& moored = picture.tracks[0];
  moored.rectangle.center_m = moored.position_m = moored.outline_m[0];
  moored.approach = moored.approach_if_standing = {.distance_m = 28.0, .cpa_m = 0.0, .tcpa_s = 9.0, .probability = 1.0};
  moored.first = kStart - std::chrono::seconds(60);
  moored.seen = kStart;
  Proof proof;
  const auto told = [&] {
    proof.Update(picture.tracks);
    return ClosestApproachDangers(kApproach, picture, Own(), false, {}, &proof, kStart).at(0);
  };
  const auto standing = told();
  EXPECT_TRUE(standing.is_grave);
  moored.velocity_mps = {0.4, 0.0};
  moored.approach = {.distance_m = 28.0, .cpa_m = 6.0, .tcpa_s = 14.0, .probability = 0.1};
  const auto swinging = told();
  EXPECT_EQ(swinging.probability, standing.probability);
  EXPECT_TRUE(swinging.is_grave);
  EXPECT_EQ(swinging.time_left_s, standing.time_left_s);
}

TEST(ClosestApproachDangers, OfAPieceOfTheBerthAreNoneForABoatThatLiesStill) {
  for (const bool is_beside : {false, true}) {
    SCOPED_TRACE(is_beside ? "beside a boat that stands" : "in open water");
    Picture picture;
    picture.tracks = {At(1, {0.0, 20.0})};
    if (is_beside) picture.tracks.push_back(At(2, {1.5, 20.0}));
    for (auto& track : picture.tracks) track.rectangle.center_m = track.position_m = track.outline_m[0];
    Proof proof;
    const auto told = [&](int scan) {
      auto& track = picture.tracks[0];
      track.velocity_mps = {0.0, -4.0};
      track.approach = {.distance_m = 18.0, .cpa_m = 0.0, .tcpa_s = 4.5, .probability = 0.9};
      track.seen = kStart + scan * std::chrono::milliseconds(100);
      track.first = kStart - std::chrono::seconds(5);
      track.position_m = track.rectangle.center_m = Eigen::Vector2d(100.0, 70.0 - 0.4 * scan);
      for (auto& corner : track.outline_m) corner.y() -= scan > 0 ? 0.4 : 0.0;
      proof.Update(picture.tracks);
      return ClosestApproachDangers(kApproach, picture, Own(), true, {}, &proof, track.seen).at(0);
    };
    const auto first = told(0);
    EXPECT_EQ(first.probability, is_beside ? 0.0 : 0.9);
    EXPECT_TRUE(first.is_just_seen);
    for (int scan = 1; scan < 12; ++scan) told(scan);
    EXPECT_EQ(told(12).probability, 0.9) << "it has left";
  }
}

// A boat that passes in the fairway is seen first 50 m off, and its course is a guess: 10 cautions an hour in a berth.
TEST(ClosestApproachDangers, OfABoatFarOffWaitForABoatThatLiesStill) {
  Picture picture;
  auto track = At(1, {0.0, 50.0});
  track.velocity_mps = {0.0, -2.2};
  for (const auto& [tcpa_s, is_far] : {std::pair{22.0, true}, {12.0, false}}) {
    track.approach = {.distance_m = 2.2 * tcpa_s, .cpa_m = 0.0, .tcpa_s = tcpa_s, .probability = 0.9};
    picture.tracks = {track};
    const auto under_way = ClosestApproachDangers(kApproach, picture, Own(), false);
    const auto still = ClosestApproachDangers(kApproach, picture, Own(), true);
    ASSERT_EQ(still.size(), 1U);
    EXPECT_EQ(under_way.at(0).probability, 0.9);
    EXPECT_EQ(still[0].probability < 0.5, is_far) << tcpa_s;
    EXPECT_GT(still[0].probability, 0.2) << "ends no alert";
    const ApproachParams slow_to_act{.limit_m = 5.0, .ability = {.reaction_s = 30.0}};
    EXPECT_EQ(ClosestApproachDangers(slow_to_act, picture, Own(), true).at(0).probability, 0.9) << "no time to lose";
  }
}

// Beams that find nothing where it would be by now say that it is elsewhere. What stands is told all the same: waves may hide it.
TEST(ClosestApproachDangers, OfWhatMovesAreAsLikelyAsItIsThere) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 20.0}), At(2, {5.0, 20.0}), At(3, {-5.0, 20.0})};
  for (auto& track : picture.tracks) {
    track.existence_probability = 0.25;
    track.seen = kStart - std::chrono::seconds(1);
  }
  picture.tracks[0].velocity_mps = picture.tracks[2].velocity_mps = {0.0, -1.0};
  picture.tracks[2].seen = kStart;
  const auto dangers = ClosestApproachDangers(kApproach, picture, Own(), false, {}, nullptr, kStart);
  ASSERT_EQ(dangers.size(), 3U);
  EXPECT_DOUBLE_EQ(dangers[0].probability, 0.2);
  EXPECT_DOUBLE_EQ(dangers[1].probability, 0.8);
  EXPECT_DOUBLE_EQ(dangers[2].probability, 0.2) << "something is seen there now and then";
}

// A crest runs; what stands there all the same is told as it was.
TEST(ClosestApproachDangers, OfATentativeTrackThatRunsAreAsIfItStoodUntilItIsNoCrest) {
  Picture picture;
  picture.tracks = {At(1, {0.0, 20.0}, TrackStatus::kTentative)};
  auto& track = picture.tracks[0];
  track.id = -5;
  track.existence_probability = 0.8;
  track.first = kStart - std::chrono::seconds(4);
  track.seen = kStart;
  const Proof proof;
  const auto probability = [&] { return ClosestApproachDangers(kApproach, picture, Own(), false, {}, &proof, kStart).at(0).probability; };
  EXPECT_EQ(probability(), 0.8) << "a buoy in waves";
  track.velocity_mps = {0.0, -3.0};
  EXPECT_EQ(probability(), 0.0) << "a crest, and nothing on the way";
  track.approach_if_standing = track.approach;
  track.approach_if_standing.probability = 0.7;
  EXPECT_EQ(probability(), 0.7) << "a crest, or a raft on the way";
}

TEST(StillWatch, SeesADriftAndADepartureButNoSway) {
  StillWatch watch;
  auto time = kStart;
  const auto scans = [&](double seconds, const auto& velocity) {
    bool is_still = false;
    for (double t_s = 0.0; t_s < seconds; t_s += 0.1) is_still = watch.Update(time += std::chrono::milliseconds(100), velocity(t_s));
    return is_still;
  };
  const auto constant = [](double speed_mps) { return [speed_mps](double) { return Eigen::Vector2d(speed_mps, 0.0); }; };
  EXPECT_TRUE(scans(10.0, [](double t_s) { return Eigen::Vector2d(0.5 * std::sin(kTwoPi * t_s / 4.0), 0.0); }));
  EXPECT_FALSE(scans(15.0, constant(0.3)));
  EXPECT_TRUE(scans(15.0, constant(0.0)));
  EXPECT_FALSE(scans(3.0, constant(1.0))) << "3 s after casting off";
  EXPECT_FALSE(scans(1.0, constant(kNan)));
  EXPECT_TRUE(scans(0.1, constant(0.0))) << "anew";
}

// One hour in the berth, a metre off the quay, with sway and a noisy receiver: no alert. Then the neighbour comes home.
TEST(ClosestApproachDangers, LeaveABoatInItsBerthInPeace) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.1);
  Picture picture;
  picture.tracks = {At(1, {3.0, 0.0}), At(2, {0.0, 30.0})};
  picture.tracks[0].approach.probability = 1.0;
  picture.tracks[1].approach.probability = 0.0;
  Alerts alerts({});
  StillWatch watch;
  auto time = kStart;
  for (int scan = 0; scan < 36'000; ++scan) {
    time += std::chrono::milliseconds(100);
    const double sway_mps = 0.3 * std::sin(kTwoPi * scan / 45.0);
    const bool is_still = watch.Update(time, {sway_mps + noise(random), noise(random)});
    ASSERT_TRUE(alerts.Update(time, true, ClosestApproachDangers(kApproach, picture, Own(), is_still)).empty()) << scan;
  }
  picture.tracks[1].velocity_mps = {0.0, -1.5};
  picture.tracks[1].approach.probability = 0.9;
  for (int scan = 0; scan < 3; ++scan)
    alerts.Update(time += std::chrono::milliseconds(100), true, ClosestApproachDangers(kApproach, picture, Own(), true));
  EXPECT_EQ(alerts.alerts().size(), 1U);
}

}  // namespace
}  // namespace lookout::tracker
