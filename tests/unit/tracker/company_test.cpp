// Which tracks move together.
#include "services/tracker/core/company.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <vector>

#include "services/tracker/core/things.hpp"

namespace lookout::tracker {
namespace {

constexpr Utime kFirstScan{std::chrono::seconds(1'700'000'000)};

// A box along the east axis, confirmed long ago.
Track Underway(std::int64_t id, double east_m, double length_m, const Eigen::Vector2d& velocity_mps = {1.6, 0.0}) {
  Track track;
  track.id = id;
  track.status = id < 0 ? TrackStatus::kTentative : TrackStatus::kConfirmed;
  track.existence_probability = 0.9;
  track.first = kFirstScan - std::chrono::seconds(60);
  track.velocity_mps = velocity_mps;
  track.position_m = track.rectangle.center_m = {east_m, 0.0};
  track.rectangle.length_m = length_m;
  track.rectangle.width_m = 1.0;
  for (const auto& [along, across] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    track.outline_m.emplace_back(east_m + along * length_m, across);
  }
  return track;
}

// Through Things, as the tracker uses it.
class CompanyTest : public ::testing::Test {
 protected:
  void Scans(int num, const std::vector<Track>& tracks) {
    for (int i = 0; i < num; ++i) {
      things_.Update(time_ += std::chrono::milliseconds(100), tracks, {});
      merged_.insert(merged_.end(), things_.merged().begin(), things_.merged().end());
    }
  }

  using Renamed = std::vector<std::pair<std::int64_t, std::int64_t>>;
  Utime time_ = kFirstScan;
  Things things_;
  Renamed merged_;
};

TEST_F(CompanyTest, OfPiecesOfALongHullIsOneThing) {
  const std::vector<Track> barge{Underway(3, 0.0, 6.0), Underway(5, 6.0, 2.0, {1.4, 0.2}), Underway(-7, 10.0, 1.0)};
  Scans(1, barge);
  EXPECT_EQ(things_.ThingOf(5), 5) << "two scans make a company, three an alert";
  Scans(1, barge);
  EXPECT_EQ(things_.ThingOf(5), 3);
  EXPECT_EQ(things_.ThingOf(-7), 3) << "by the piece between";
  EXPECT_TRUE(things_.IsGroup(3));
  EXPECT_EQ(merged_, (Renamed{{-7, 3}, {5, 3}}));
}

TEST_F(CompanyTest, IsNotThatOfBoatsThatMeetOrOvertake) {
  Scans(10, {Underway(3, 0.0, 6.0), Underway(5, 5.0, 2.0, {-1.6, 0.0}), Underway(8, -5.0, 2.0, {2.4, 0.0})});
  EXPECT_EQ(things_.ThingOf(5), 5);
  EXPECT_EQ(things_.ThingOf(8), 8);
  EXPECT_TRUE(merged_.empty());
}

TEST_F(CompanyTest, IsNotThatOfBoatsBetweenWhichOneCanSteer) {
  Scans(10, {Underway(3, 0.0, 6.0), Underway(5, 8.0, 2.0)});
  EXPECT_EQ(things_.ThingOf(5), 5) << "4 m off";
}

// The velocity of a piece is uncertain by a metre a second and more.
TEST_F(CompanyTest, LastsUntilTheTracksAreApart) {
  Scans(2, {Underway(3, 0.0, 6.0), Underway(5, 5.0, 2.0)});
  Scans(10, {Underway(3, 0.0, 6.0), Underway(5, 9.9, 2.0, {3.5, 0.0})});
  EXPECT_EQ(things_.ThingOf(5), 3) << "5.9 m off";
  Scans(1, {Underway(3, 0.0, 6.0), Underway(5, 10.1, 2.0, {3.5, 0.0})});
  EXPECT_EQ(things_.ThingOf(5), 5) << "6.1 m off";
}

TEST_F(CompanyTest, GoesOnUnderAnotherNameWithoutItsFirst) {
  Scans(2, {Underway(3, 0.0, 6.0), Underway(5, 5.0, 2.0), Underway(6, 8.0, 2.0)});
  merged_.clear();
  Scans(1, {Underway(5, 5.0, 2.0), Underway(6, 8.0, 2.0)});
  EXPECT_EQ(things_.ThingOf(6), 5);
  EXPECT_EQ(merged_, (Renamed{{3, 5}}));
}

TEST_F(CompanyTest, HasWhatComesUpBesideItAndSeemsToStand) {
  auto part = Underway(9, 5.0, 2.0, Eigen::Vector2d::Zero());  // 1 m off
  part.first = kFirstScan;
  Scans(2, {Underway(3, 0.0, 6.0), part});
  EXPECT_EQ(things_.ThingOf(9), 3);
  Scans(40, {Underway(3, 0.0, 6.0), part});
  EXPECT_EQ(things_.ThingOf(9), 3) << "for as long as it is there";
  Scans(1, {Underway(3, -2.0, 6.0), part});
  EXPECT_EQ(things_.ThingOf(9), 9) << "3 m off: what moves has left it";
}

TEST_F(CompanyTest, HasNothingThatStoodBefore) {
  Scans(10, {Underway(3, 0.0, 6.0), Underway(9, 5.0, 2.0, Eigen::Vector2d::Zero())});
  EXPECT_EQ(things_.ThingOf(9), 9) << "a mooring buoy that a boat passes";
}

TEST_F(CompanyTest, KeepsTogetherWhereTracksBecomeOne) {
  Scans(2, {Underway(3, 0.0, 6.0), Underway(5, 5.0, 2.0), Underway(6, 8.0, 2.0)});
  things_.Rename(5, 6);
  EXPECT_EQ(things_.ThingOf(6), 3);
  Scans(1, {Underway(3, 0.0, 6.0), Underway(6, 9.0, 4.0)});
  EXPECT_EQ(things_.ThingOf(6), 3) << "4 m off";
}

}  // namespace
}  // namespace lookout::tracker
