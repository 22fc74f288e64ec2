#include "services/tracker/core/proof.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <vector>

namespace lookout::tracker::proven {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Utime kBegin{seconds(1'700'000'000)};

Track BoxAt(std::int64_t id, double east_m, double north_m, const Eigen::Vector2d& velocity_mps = Eigen::Vector2d::Zero()) {
  Track track;
  track.id = id;
  track.status = TrackStatus::kConfirmed;
  track.velocity_mps = velocity_mps;
  track.position_m = track.rectangle.center_m = {east_m, north_m};
  track.rectangle.length_m = track.rectangle.width_m = 2.0;
  track.outline_m = {{east_m - 1.0, north_m - 1.0}, {east_m + 1.0, north_m - 1.0}, {east_m + 1.0, north_m + 1.0}, {east_m - 1.0, north_m + 1.0}};
  return track;
}

// A boat that goes north from the origin, along a row of what stands.
class ProofTest : public ::testing::Test {
 protected:
  // @param shown  share of the course that it truly goes
  void Run(double for_s, double speed_mps, double shown = 1.0, bool is_seen = true) {
    for (int i = 0; i < static_cast<int>(10.0 * for_s + 0.5); ++i) {
      time_ += milliseconds(100);
      north_m_ += 0.1 * shown * speed_mps;
      boat_ = BoxAt(1, 0.0, north_m_, {0.0, speed_mps});
      seen_ = is_seen ? time_ : seen_;
      boat_.seen = seen_;
      boat_.is_on_ground = is_on_ground_;
      auto tracks = standing_;
      tracks.push_back(boat_);
      proof_.Update(tracks, shore_m_);
    }
  }

  Proof proof_;
  Utime time_ = kBegin;
  Utime seen_ = kBegin;
  double north_m_ = 0.0;
  Track boat_;
  bool is_on_ground_ = false;
  std::vector<Track> standing_;
  std::vector<Eigen::Vector2d> shore_m_;
};

TEST_F(ProofTest, AFastCourseIsProvenByItsWay) {
  Run(0.8, 4.0);
  EXPECT_FALSE(proof_.IsProven(boat_));
  EXPECT_FALSE(proof_.MayBePiece(1));
  Run(0.5, 4.0);
  EXPECT_TRUE(proof_.IsProven(boat_));
}

TEST_F(ProofTest, ACourseThatDoesNotGetAnywhereIsNot) {
  Run(5.0, 4.0, 0.2);
  EXPECT_FALSE(proof_.IsProven(boat_));
}

TEST_F(ProofTest, AWayThatIsGuessedProvesNothing) {
  Run(0.5, 4.0);
  Run(3.0, 4.0, 1.0, false);
  EXPECT_FALSE(proof_.IsProven(boat_));
}

TEST_F(ProofTest, WhatIsSlowInOpenWaterIsProvenAfterASecond) {
  Run(0.8, 0.8);
  EXPECT_FALSE(proof_.IsProven(boat_));
  Run(0.5, 0.8);
  EXPECT_TRUE(proof_.IsProven(boat_));
}

TEST_F(ProofTest, WhatCreepsAlongAQuayAndThenRunsIsNoPieceSoon) {
  standing_ = {BoxAt(2, -4.0, 0.0)};
  Run(20.0, 0.3, 0.1);
  EXPECT_TRUE(proof_.MayBePiece(1));
  const double from_m = north_m_;
  for (int i = 0; i < 100 && proof_.MayBePiece(1); ++i) Run(0.1, 3.0);
  EXPECT_LT(north_m_ - from_m, 20.0);
}

TEST_F(ProofTest, ACourseIsGoneOnWithWhereItSeemsToStandForAMoment) {
  standing_ = {BoxAt(2, -4.0, 0.0), BoxAt(3, -4.0, 4.0), BoxAt(4, -4.0, 8.0), BoxAt(5, -4.0, 12.0)};
  for (int i = 0; i < 6; ++i) {
    Run(2.0, 1.0);
    Run(0.5, 0.0);
    north_m_ += 0.5;
  }
  Run(0.1, 1.0);
  EXPECT_FALSE(proof_.MayBePiece(1));
  EXPECT_TRUE(proof_.IsProven(boat_));
}

TEST_F(ProofTest, WhatBeganBesideSomethingThatStandsMayBeAPieceOfIt) {
  for (const bool is_shore : {false, true}) {
    SCOPED_TRACE(is_shore);
    proof_.Clear();
    north_m_ = 0.0;
    standing_.clear();
    shore_m_.clear();
    if (is_shore) {
      shore_m_ = {{-2.0, 0.0}};
    } else {
      standing_ = {BoxAt(2, -4.0, 0.0)};
    }
    Run(3.0, 0.8);
    EXPECT_TRUE(proof_.MayBePiece(1)) << "2.3 m";
    EXPECT_FALSE(proof_.IsProven(boat_)) << "slow as it is";
    Run(2.0, 0.8);
    EXPECT_FALSE(proof_.MayBePiece(1));
    EXPECT_TRUE(proof_.IsProven(boat_)) << "it has left";
  }
}

// Along a quay it is off by less than 1 m all the time.
TEST_F(ProofTest, WhatGoesAlongAQuayIsProvenFartherOn) {
  for (int i = -2; i < 10; ++i) standing_.push_back(BoxAt(10 + i, -2.5, 2.0 * i));
  Run(3.0, 2.0);
  EXPECT_FALSE(proof_.MayBePiece(1)) << "to act on";
  EXPECT_FALSE(proof_.IsProven(boat_));
  Run(2.5, 2.0);
  EXPECT_TRUE(proof_.IsProven(boat_));
}

// As a piece of a quay that is taken for the whole, now this and now that, in the middle of nothing else that is known.
TEST_F(ProofTest, WhatComesToWhereSomethingStoodIsAPiece) {
  is_on_ground_ = true;
  Run(10.0, 4.0);
  EXPECT_FALSE(proof_.IsProven(boat_));
  EXPECT_TRUE(proof_.MayBePiece(1));
  is_on_ground_ = false;
  Run(0.7, 4.0);
  EXPECT_TRUE(proof_.MayBePiece(1)) << "its way counts from here on";
  Run(0.6, 4.0);
  EXPECT_TRUE(proof_.IsProven(boat_));
}

TEST_F(ProofTest, WhatWasHiddenBesideAPileStaysProven) {
  Run(1.3, 4.0);
  Run(0.7, 4.0, 1.0, false);
  is_on_ground_ = true;
  Run(0.2, 4.0);
  EXPECT_TRUE(proof_.IsProven(boat_));
}

TEST_F(ProofTest, OfTwoTracksThatAreOneEitherProvesIt) {
  for (const bool is_first : {false, true}) {
    SCOPED_TRACE(is_first);
    proof_.Clear();
    for (int i = 0; i <= 15; ++i) {
      auto bow = BoxAt(is_first ? 1 : 2, 0.0, 0.4 * i, {0.0, 4.0});
      auto stern = BoxAt(is_first ? 2 : 1, 0.0, 0.4 * i - 2.0, {0.0, 4.0});
      stern.is_on_ground = true;
      bow.seen = stern.seen = kBegin + milliseconds(100 * i);
      proof_.Update(is_first ? std::vector{bow, stern} : std::vector{stern, bow});
    }
    proof_.Rename(2, 1);
    auto boat = BoxAt(1, 0.0, 6.4, {0.0, 4.0});
    boat.seen = kBegin + milliseconds(1600);
    boat.is_on_ground = true;
    proof_.Update(std::vector{boat});
    EXPECT_TRUE(proof_.IsProven(boat));
  }
}

TEST_F(ProofTest, ACourseThatIsProvenStaysSoBesideABuoyAndNotAlongAQuay) {
  Run(1.3, 4.0);
  is_on_ground_ = true;
  Run(0.4, 4.0);
  EXPECT_TRUE(proof_.IsProven(boat_)) << "it passes a buoy";
  is_on_ground_ = false;
  Run(0.1, 4.0);
  is_on_ground_ = true;
  Run(0.4, 4.0);
  EXPECT_TRUE(proof_.IsProven(boat_)) << "and another";
  Run(0.2, 4.0);
  EXPECT_FALSE(proof_.IsProven(boat_)) << "it goes from one thing that stands to the next";
  EXPECT_FALSE(proof_.MayBePiece(1)) << "it was proven: what is grave is told";
  Run(1.0, 4.0);
  EXPECT_FALSE(proof_.MayBePiece(1));
  is_on_ground_ = false;
  Run(1.3, 4.0);
  EXPECT_TRUE(proof_.IsProven(boat_));
}

}  // namespace
}  // namespace lookout::tracker::proven
