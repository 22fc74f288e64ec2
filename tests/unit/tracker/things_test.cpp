// Which tracks are one thing with others.
#include "services/tracker/core/things.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <vector>

#include "services/tracker/core/danger.hpp"

namespace lookout::tracker {
namespace {

// A box along the east axis.
Track Standing(std::int64_t id, double east_m, double length_m, double north_m = 0.0) {
  Track track;
  track.id = id;
  track.status = TrackStatus::kConfirmed;
  track.kind = length_m > 20.0 ? TrackKind::kStructure : TrackKind::kObstacle;
  track.position_m = {east_m, north_m};
  track.rectangle.center_m = track.position_m;
  track.rectangle.length_m = length_m;
  track.rectangle.width_m = 1.0;
  const double half_m = 0.5 * length_m;
  track.outline_m = {
      {east_m - half_m, north_m - 0.5}, {east_m + half_m, north_m - 0.5}, {east_m + half_m, north_m + 0.5}, {east_m - half_m, north_m + 0.5}};
  return track;
}

class ThingsTest : public ::testing::Test {
 protected:
  void Scans(int num, const std::vector<Track>& tracks, const std::vector<Eigen::Vector2d>& shore_m = {}, bool is_own_still = false) {
    for (int i = 0; i < num; ++i) {
      things_.Update(time_ += std::chrono::milliseconds(100), tracks, shore_m, nullptr, is_own_still);
      merged_.insert(merged_.end(), things_.merged().begin(), things_.merged().end());
    }
  }

  Utime time_{std::chrono::seconds(1'700'000'000)};
  Things things_;
  std::vector<std::pair<std::int64_t, std::int64_t>> merged_;
};

TEST_F(ThingsTest, OfAPierInPiecesAreOne) {
  Scans(25, {Standing(3, 0.0, 10.0), Standing(5, 12.0, 10.0), Standing(6, 40.0, 10.0)});
  EXPECT_EQ(things_.ThingOf(5), 3);
  EXPECT_EQ(things_.ThingOf(3), 3);
  EXPECT_EQ(things_.ThingOf(6), 6) << "18 m off";
  EXPECT_TRUE(things_.IsGroup(3));
  EXPECT_FALSE(things_.IsGroup(6));
  EXPECT_EQ(merged_, (std::vector<std::pair<std::int64_t, std::int64_t>>{{5, 3}}));
}

TEST_F(ThingsTest, OfABoatAtItsPierIsThePierUntilItCastsOff) {
  const auto pier = Standing(1, 0.0, 30.0);
  auto boat = Standing(2, 0.0, 5.0, 3.0);
  Scans(5, {pier, boat});
  EXPECT_EQ(things_.ThingOf(2), 1);
  boat.velocity_mps = {0.0, 0.8};
  Scans(1, {pier, boat});
  EXPECT_EQ(things_.ThingOf(2), 2);
}

TEST_F(ThingsTest, OfWhatMayBeAPieceOfAPierIsThePierAlthoughItSeemsToMove) {
  const auto pier = Standing(1, 0.0, 30.0);
  auto piece = Standing(2, 0.0, 5.0, 3.0);
  piece.velocity_mps = {0.0, 0.8};
  Proof proof;
  for (int i = 0; i < 60; ++i) {
    time_ += std::chrono::milliseconds(100);
    piece.seen = time_;
    const double way_m = 0.08 * i;
    auto moved = piece;
    moved.position_m.y() += way_m;
    moved.rectangle.center_m.y() += way_m;
    for (auto& corner_m : moved.outline_m) corner_m.y() += way_m;
    const std::vector<Track> tracks{pier, moved};
    proof.Update(tracks);
    things_.Update(time_, tracks, {}, &proof);
    if (i == 20) {
      EXPECT_EQ(things_.ThingOf(2), 1);
    }
  }
  EXPECT_EQ(things_.ThingOf(2), 2) << "it has left";
}

// The boat was followed first, so the pier beside it bore its number: as it cast off, both were one thing for ever.
TEST_F(ThingsTest, OfWhatStaysAreNoneOfTheBoatThatCastsOff) {
  auto boat = Standing(2, 0.0, 5.0, 3.0);
  const auto pier = Standing(4, 0.0, 30.0);
  const auto pile = Standing(7, 0.0, 1.0, -2.0);
  Scans(5, {boat, pier, pile});
  EXPECT_EQ(things_.ThingOf(4), 2);
  boat.velocity_mps = {0.0, 0.8};
  merged_.clear();
  Scans(2, {boat, pier, pile});
  EXPECT_EQ(things_.ThingOf(2), 2);
  EXPECT_FALSE(things_.IsGroup(2));
  EXPECT_EQ(things_.ThingOf(4), 4);
  EXPECT_EQ(things_.ThingOf(7), 4);
  EXPECT_EQ(merged_, (std::vector<std::pair<std::int64_t, std::int64_t>>{{2, 4}}));
}

TEST_F(ThingsTest, OfShoreWithAllThatStandsBesideItAreLand) {
  std::vector<Eigen::Vector2d> shore_m;
  for (double east_m = -20.0; east_m < 20.0; east_m += 0.5) shore_m.emplace_back(east_m, -2.0);
  Scans(25, {Standing(1, 0.0, 6.0), Standing(2, 0.0, 9.0, 3.0), Standing(4, 0.0, 5.0, 20.0)}, shore_m);
  EXPECT_EQ(things_.ThingOf(1), kLandTrack);
  EXPECT_EQ(things_.ThingOf(2), kLandTrack) << "moored to it";
  EXPECT_EQ(things_.ThingOf(4), 4);
}

TEST_F(ThingsTest, OfBuoysSideBySideAreTheirOwn) {
  Scans(25, {Standing(1, 0.0, 0.6), Standing(2, 2.0, 0.6)});
  EXPECT_EQ(things_.ThingOf(1), 1);
  EXPECT_EQ(things_.ThingOf(2), 2);
}

TEST_F(ThingsTest, OfPiecesAreOneBeforeAnAlertCanComeUp) {
  Scans(2, {Standing(3, 0.0, 10.0), Standing(5, 12.0, 10.0)});
  EXPECT_EQ(things_.ThingOf(5), 3);
}

TEST_F(ThingsTest, OfWhatComesUpBesideAKnownOneAreThat) {
  const auto known = Standing(1, 0.0, 2.0);
  auto piece = Standing(2, 3.0, 1.0);  // 1.5 m off
  auto other = Standing(4, 0.0, 1.0, 4.5);
  piece.first = other.first = time_;
  Scans(5, {known, piece, other});
  EXPECT_EQ(things_.ThingOf(2), 1);
  EXPECT_EQ(things_.ThingOf(4), 4) << "3.5 m off";
  // As the run begins nobody knows which was there before.
  auto first = known;
  first.first = time_;
  things_.Clear();
  Scans(5, {first, piece});
  EXPECT_EQ(things_.ThingOf(2), 2);
}

TEST_F(ThingsTest, OfAConfirmedOneKeepItsNameBesideATentativeOne) {
  auto tentative = Standing(-7, 3.0, 1.0);
  tentative.status = TrackStatus::kTentative;
  tentative.existence_probability = 0.7;
  Scans(5, {tentative, Standing(2, 0.0, 2.0)});
  EXPECT_EQ(things_.ThingOf(-7), 2);
  EXPECT_EQ(things_.ThingOf(2), 2);
  tentative.existence_probability = 0.5;
  Scans(1, {tentative, Standing(2, 0.0, 2.0)});
  EXPECT_EQ(things_.ThingOf(-7), -7) << "it may be a crest";
}

TEST_F(ThingsTest, AroundABoatThatLiesStillAreItsBerth) {
  const std::vector<Track> buoys{Standing(1, 0.0, 0.6), Standing(2, 3.0, 0.6), Standing(3, 8.0, 0.6)};
  Scans(5, buoys, {}, true);
  EXPECT_EQ(things_.ThingOf(2), 1);
  EXPECT_EQ(things_.ThingOf(3), 3);
}

TEST_F(ThingsTest, KeepTheirNameWhenTracksBecomeOne) {
  Scans(25, {Standing(3, 0.0, 10.0), Standing(5, 12.0, 10.0)});
  things_.Rename(3, 2);
  EXPECT_EQ(things_.ThingOf(2), 2);
  EXPECT_EQ(things_.ThingOf(5), 2);
}

}  // namespace
}  // namespace lookout::tracker
