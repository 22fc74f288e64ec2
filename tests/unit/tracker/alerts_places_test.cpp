// Alerts of what many things share: land, and what has no track. An acknowledgement is one of places.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "tests/unit/tracker/alerts_fixture.hpp"

namespace lookout::tracker {
namespace {

// A quay to port was acknowledged, and the boat drove at a wall ahead: 19 s in the zone, down to 2.7 m, and nothing rang.
TEST_F(AlertsTest, OfAQuayThatWasAcknowledgedDoNotHideAWallAhead) {
  Scans(3, {Of(kLandTrack, Shore(-90.0, 5.0))});
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(600, {Of(kLandTrack, Shore(-90.0, 5.0))});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged) << "it stays beside the boat";
  double ahead_m = 9.9;
  Scan({Of(kLandTrack, Both(Shore(-90.0, 5.0), Shore(0.0, ahead_m -= 0.1)))});
  Scan({Of(kLandTrack, Both(Shore(-90.0, 5.0), Shore(0.0, ahead_m -= 0.1)))});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  Scan({Of(kLandTrack, Both(Shore(-90.0, 5.0), Shore(0.0, ahead_m -= 0.1)))});
  EXPECT_EQ(Only().state, AlertState::kActive);
  EXPECT_EQ(Only().id, 1);
  EXPECT_EQ(Only().changed, time_);
  EXPECT_NEAR(Only().distance_m, ahead_m, 1e-9) << "it tells of what rings, not of the quay, which is nearer";
  EXPECT_NEAR(WrapToPi(Only().bearing_rad), 0.0, 1e-9);
}

// A quay to port, and where it ends a wall across the bow, as the guard zone tells them.
std::vector<DangerPlace> Corner(double aside_m, double ahead_m) {
  std::vector<DangerPlace> places;
  for (double bearing_deg = -177.5; bearing_deg < 180.0; bearing_deg += 5.0) {
    const double sine = std::sin(DegToRad(bearing_deg));
    const double cosine = std::cos(DegToRad(bearing_deg));
    double range_m = 100.0;
    if (sine < 0.0 && aside_m / -sine * cosine <= ahead_m) range_m = aside_m / -sine;
    if (cosine > 0.0 && -ahead_m * sine / cosine <= aside_m) range_m = std::min(range_m, ahead_m / cosine);
    if (range_m <= 10.0) places.push_back(At(bearing_deg, range_m));
  }
  return places;
}

// The quay runs on to near the bow, so its far end lies beside the wall.
TEST_F(AlertsTest, OfAQuayCloseAlongsideDoNotHideTheWallAtItsEnd) {
  for (const double aside_m : {0.8, 1.2, 2.0, 3.0, 5.0}) {
    time_ += std::chrono::seconds(100);
    alerts_ = Alerts(kAlertParams);
    Scans(20, {Of(kLandTrack, Corner(aside_m, 30.0))});
    EXPECT_TRUE(Acknowledge(Only()));
    Scan({Of(kLandTrack, Corner(aside_m, 30.0))});
    double ahead_m = 30.0;
    for (; ahead_m > 1.0 && Only().state != AlertState::kActive; ahead_m -= 0.1) Scan({Of(kLandTrack, Corner(aside_m, ahead_m))});
    EXPECT_GT(ahead_m, 9.0) << aside_m;
    EXPECT_LT(ahead_m, 10.0) << aside_m;
  }
}

// A bank of a canal is other land than the quay of the berth, though there was land on that side all the time.
TEST_F(AlertsTest, OfABerthSayNothingOfTheBankMilesAway) {
  Scans(20, {Of(kLandTrack, Shore(-90.0, 0.8))});
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(29, {Of(kLandTrack, Shore(-90.0, 6.0))});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  Scans(10, {Of(kLandTrack, Shore(-90.0, 6.0))});
  EXPECT_EQ(Only().state, AlertState::kActive) << "it was told at 0.8 m";
}

// A boat came into the zone while somebody read of the buoy and pressed the button.
TEST_F(AlertsTest, AreAcknowledgedForWhatWasThereASecondAgo) {
  Scans(20, {Of(kUnnamed, {At(40.0, 6.0)})});
  Scans(3, {Of(kUnnamed, {At(40.0, 6.0), At(-30.0, 9.5)})});
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(3, {Of(kUnnamed, {At(40.0, 6.0), At(-30.0, 9.4)})});
  EXPECT_EQ(Only().state, AlertState::kActive);
  EXPECT_NEAR(Only().distance_m, 9.4, 1e-9);
}

// The buoy leaves the sector, another thing comes in near there.
TEST_F(AlertsTest, OfAThingThatHasGoneSayNothingOfTheNext) {
  Scans(20, {Of(kUnnamed, {At(55.0, 8.0), At(-50.0, 9.0)})});
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(11, {Of(kUnnamed, {At(-50.0, 9.0)})});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  Scans(3, {Of(kUnnamed, {At(40.0, 9.0), At(-50.0, 9.0)})});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

TEST_F(AlertsTest, OfAnotherMapKnowNoPlaceOfThisOne) {
  const auto pier = [](double bearing_deg) {
    auto place = At(bearing_deg, 8.0);
    place.position_map_m = Eigen::Vector2d(6.0, 5.0);
    return Of(kLandTrack, {place});
  };
  Scans(20, {pier(50.0)});
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(5, {pier(30.0)});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  alerts_.ForgetMap();
  Scans(3, {pier(30.0)});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

TEST_F(AlertsTest, OfLandRingAgainWhenItComesNearerThanHalfOfWhatWasTold) {
  Scans(3, {Of(kLandTrack, Shore(-90.0, 8.0))});
  EXPECT_TRUE(Acknowledge(Only()));
  for (double range_m = 8.0; range_m > 4.05; range_m -= 0.05) {
    Scan({Of(kLandTrack, Shore(-90.0, range_m))});
    ASSERT_EQ(Only().state, AlertState::kAcknowledged) << range_m;
  }
  Scans(3, {Of(kLandTrack, Shore(-90.0, 3.9))});
  EXPECT_EQ(Only().state, AlertState::kActive);
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(100, {Of(kLandTrack, Shore(-90.0, 2.5))});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged) << "3.9 m were told";
}

// In the berth half a metre of sway and some degrees of yaw are no news.
TEST_F(AlertsTest, OfTheQuayBesideABerthStayAcknowledgedInTheSway) {
  // The quay goes north, 0.8 m east of the berth.
  const auto quay = [](double own_east_m, double heading_deg) {
    std::vector<DangerPlace> places;
    for (double bearing_deg = -177.5; bearing_deg < 180.0; bearing_deg += 5.0) {
      const double course_rad = DegToRad(heading_deg + bearing_deg);
      const double range_m = (0.8 - own_east_m) / std::sin(course_rad);
      if (range_m < 0.0 || range_m > 10.0) continue;
      places.push_back(At(bearing_deg, range_m));
      places.back().position_map_m = Eigen::Vector2d(0.8, range_m * std::cos(course_rad));
    }
    return Of(kLandTrack, places);
  };
  Scans(20, {quay(0.0, 0.0)});
  EXPECT_TRUE(Acknowledge(Only()));
  for (int i = 0; i < 600; ++i) {
    Scan({quay(0.45 * std::sin(0.15 * i), 5.0 * std::sin(0.2 * i))});
    ASSERT_EQ(Only().state, AlertState::kAcknowledged) << i;
  }
}

TEST_F(AlertsTest, OfLandOnTheOtherSideRing) {
  Scans(3, {Of(kLandTrack, Shore(-90.0, 6.0))});
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(3, {Of(kLandTrack, Shore(90.0, 6.0))});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

// The land of a bearing went, other land came there much later: that was never told.
TEST_F(AlertsTest, OfLandThatComesToABearingWhereTheOldHasLongGoneRing) {
  Scans(3, {Of(kLandTrack, Both(Shore(0.0, 9.0), Shore(180.0, 6.0)))});
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(20, {Of(kLandTrack, Shore(180.0, 6.0))});
  Scans(5, {Of(kLandTrack, Both(Shore(0.0, 9.0), Shore(180.0, 6.0)))});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged) << "2 s without it: the same land";
  Scans(40, {Of(kLandTrack, Shore(180.0, 6.0))});
  Scans(3, {Of(kLandTrack, Both(Shore(0.0, 9.0), Shore(180.0, 6.0)))});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

// On the map a pier head is the same one while the boat goes past it.
TEST_F(AlertsTest, OfAPierHeadThatTheBoatPassesStayAcknowledged) {
  const auto pier = [](double ahead_m) {
    DangerPlace place{std::hypot(ahead_m, 6.0), WrapTo2Pi(std::atan2(6.0, ahead_m))};
    place.position_map_m = Eigen::Vector2d(106.0, 200.0);
    return Of(kLandTrack, {place});
  };
  Scans(3, {pier(7.5)});
  EXPECT_TRUE(Acknowledge(Only()));
  for (double ahead_m = 7.5; ahead_m > -7.5; ahead_m -= 0.1) {
    Scan({pier(ahead_m)});
    ASSERT_EQ(Only().state, AlertState::kAcknowledged) << ahead_m;
  }
}

// The place is that of the quay alongside; the boat has turned its bow to it.
TEST_F(AlertsTest, OfLandThatTheBoatTurnsToRing) {
  const auto quay = [](double bearing_deg) {
    auto place = At(bearing_deg, 6.0);
    place.position_map_m = Eigen::Vector2d(106.0, 200.0);
    return Of(kLandTrack, {place});
  };
  Scans(3, {quay(-90.0)});
  EXPECT_TRUE(Acknowledge(Only()));
  for (double bearing_deg = -90.0; bearing_deg < -31.0; bearing_deg += 2.0) {
    Scan({quay(bearing_deg)});
    ASSERT_EQ(Only().state, AlertState::kAcknowledged) << bearing_deg;
  }
  Scans(3, {quay(-20.0)});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

// Without position or heading nothing has a track. A buoy was acknowledged, then a motor boat crossed 8 m ahead for 30 scans: silence.
TEST_F(AlertsTest, OfABuoyWithoutATrackDoNotHideABoatThatCrosses) {
  Scans(3, {Of(kUnnamed, {At(40.0, 6.0)})});
  EXPECT_TRUE(Acknowledge(Only()));
  for (int i = 0; i < 300; ++i) {
    Scan({Of(kUnnamed, {At(40.0 + 10.0 * std::sin(0.1 * i), 6.0)})});
    ASSERT_EQ(Only().state, AlertState::kAcknowledged) << "it is followed";
  }
  for (double bearing_deg = -59.0; bearing_deg < 59.0; bearing_deg += 4.0) Scan({Of(kUnnamed, {At(40.0, 6.0), At(bearing_deg, 8.0)})});
  EXPECT_EQ(Only().state, AlertState::kActive);
  EXPECT_NEAR(Only().distance_m, 8.0, 1e-9) << "it tells of the boat";
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(5, {Of(kUnnamed, {At(40.0, 6.0), At(-30.0, 9.0)})});
  EXPECT_EQ(Only().state, AlertState::kActive) << "the next one";
}

TEST_F(AlertsTest, OfAThingWithoutATrackRingAgainWhenItComesMuchNearer) {
  Scans(3, {Of(kUnnamed, {At(0.0, 9.0)})});
  EXPECT_TRUE(Acknowledge(Only()));
  for (double range_m = 9.0; range_m > 4.6; range_m -= 0.2) {
    Scan({Of(kUnnamed, {At(0.0, range_m)})});
    ASSERT_EQ(Only().state, AlertState::kAcknowledged) << range_m;
  }
  Scans(3, {Of(kUnnamed, {At(0.0, 4.3)})});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

// Two moored boats, each acknowledged, turned out to lie at one quay, and rang again.
TEST_F(AlertsTest, OfTwoAcknowledgedThingsThatBecomeOneStayAcknowledged) {
  auto one = Zone(3, 8.0);
  one.bearing_rad = At(20.0, 8.0).bearing_rad;
  auto other = Zone(5, 6.0);
  other.bearing_rad = At(100.0, 6.0).bearing_rad;
  Scans(3, {one, other});
  const auto raised = alerts_.alerts();
  ASSERT_EQ(raised.size(), 2U);
  for (const auto& alert : raised) ASSERT_TRUE(Acknowledge(alert));
  Scans(3, {one, other});
  alerts_.Rename(5, 3, time_);
  Scans(20, {Of(3, {At(20.0, 8.0), At(100.0, 6.0)})});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  // A third place was told to nobody.
  Scans(5, {Of(3, {At(20.0, 8.0), At(100.0, 6.0), At(220.0, 7.0)})});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

// A swimmer comes up beside a buoy that somebody has acknowledged, and is taken for one thing with it.
TEST_F(AlertsTest, OfAThingThatWasAcknowledgedAloneRingForWhatComesToItSince) {
  for (const bool is_piece : {true, false}) {
    SCOPED_TRACE(is_piece ? "a piece of the same" : "on another side, and nearer");
    alerts_ = Alerts(kAlertParams);
    auto alone = Zone(7, 8.0);
    alone.is_grave = false;
    Scans(5, {alone});
    ASSERT_TRUE(Acknowledge(Only()));
    Scans(5, {alone});
    auto both = Of(7, {At(0.0, 8.0), is_piece ? At(4.0, 8.1) : At(80.0, 3.0)});
    both.is_grave = false;
    Scans(10, {both});
    EXPECT_EQ(Only().state, is_piece ? AlertState::kAcknowledged : AlertState::kActive);
  }
}

}  // namespace
}  // namespace lookout::tracker
