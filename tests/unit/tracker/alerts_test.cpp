#include "services/tracker/core/alerts.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout::tracker {
namespace {

constexpr AlertParams kAlertParams{.warning_tcpa_s = 15.0};

Danger Cpa(std::int64_t track_id, double probability, double tcpa_s = 25.0, double distance_m = 40.0) {
  return {.cause = AlertCause::kClosestApproach,
          .track_id = track_id,
          .probability = probability,
          .tcpa_s = tcpa_s,
          .distance_m = distance_m,
          .cpa_m = 2.0,
          .is_inside = distance_m < 5.0};
}

Danger Zone(std::int64_t track_id, double distance_m = 8.0) {
  return {.cause = AlertCause::kGuardZone, .track_id = track_id, .probability = 1.0, .distance_m = distance_m, .is_inside = true};
}

DangerPlace At(double bearing_deg, double range_m) { return {range_m, WrapTo2Pi(DegToRad(bearing_deg))}; }

// The nearest is what is told.
Danger Of(std::int64_t track_id, std::vector<DangerPlace> places) {
  const auto nearest = *std::ranges::min_element(places, {}, &DangerPlace::range_m);
  auto danger = Zone(track_id, nearest.range_m);
  danger.bearing_rad = nearest.bearing_rad;
  danger.places = std::move(places);
  return danger;
}

// A straight shore as the guard zone tells it: a place every 5 deg, as far as 10 m.
std::vector<DangerPlace> Shore(double bearing_deg, double range_m) {
  std::vector<DangerPlace> places;
  for (double aside_deg = -85.0; aside_deg <= 85.0; aside_deg += 5.0) {
    const double at_m = range_m / std::cos(DegToRad(aside_deg));
    if (at_m <= 10.0) places.push_back(At(bearing_deg + aside_deg, at_m));
  }
  return places;
}

std::vector<DangerPlace> Both(std::vector<DangerPlace> one, const std::vector<DangerPlace>& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

// Scans at 10 Hz.
class AlertsTest : public ::testing::Test {
 protected:
  const std::vector<Alert>& Scan(const std::vector<Danger>& dangers, bool is_whole = true) {
    time_ += std::chrono::milliseconds(100);
    return alerts_.Update(time_, is_whole, dangers);
  }
  void Scans(int num, const std::vector<Danger>& dangers, bool is_whole = true) {
    for (int i = 0; i < num; ++i) Scan(dangers, is_whole);
  }
  bool Acknowledge(const Alert& alert) {
    return alerts_.Acknowledge({time_, "page", alert.id, alert.raised}, time_ + std::chrono::milliseconds(100));
  }
  const Alert& Only() const {
    EXPECT_EQ(alerts_.alerts().size(), 1U);
    static const Alert kNone{};
    return alerts_.alerts().empty() ? kNone : alerts_.alerts().front();
  }

  Utime time_{std::chrono::seconds(1'700'000'000)};
  Alerts alerts_{kAlertParams};
};

TEST_F(AlertsTest, ComeUpInThreeOfFiveScans) {
  EXPECT_TRUE(Scan({Cpa(7, 0.6)}).empty());
  EXPECT_TRUE(Scan({Cpa(7, 0.4)}).empty());
  EXPECT_TRUE(Scan({Cpa(7, 0.6)}).empty());
  EXPECT_TRUE(Scan({}).empty());
  const auto& raised = Scan({Cpa(7, 0.5, 24.0, 33.0)});
  ASSERT_EQ(raised.size(), 1U);
  EXPECT_EQ(raised[0].id, 1);
  EXPECT_EQ(raised[0].cause, AlertCause::kClosestApproach);
  EXPECT_EQ(raised[0].track_id, 7);
  EXPECT_EQ(raised[0].state, AlertState::kActive);
  EXPECT_EQ(raised[0].level, AlertLevel::kCaution);
  EXPECT_EQ(raised[0].raised, time_);
  EXPECT_EQ(raised[0].tcpa_s, 24.0);
  EXPECT_EQ(raised[0].distance_m, 33.0);
  EXPECT_EQ(raised[0].cpa_probability, 0.5);
}

TEST_F(AlertsTest, DoNotComeUpInTwoOfFiveOrBelowOneHalf) {
  for (int i = 0; i < 20; ++i) {
    Scans(2, {Cpa(7, 0.9)});
    Scans(3, {Cpa(7, 0.3)});
  }
  Scans(50, {Cpa(7, 0.49)});
  EXPECT_TRUE(alerts_.alerts().empty());
}

TEST_F(AlertsTest, ClearBelowTheLowerLimitForThreeSecondsAndAreToldOnce) {
  Scans(3, {Cpa(7, 0.9)});
  Scans(100, {Cpa(7, 0.21)});
  EXPECT_EQ(Only().state, AlertState::kActive) << "between both limits it stays";
  Scans(30, {Cpa(7, 0.1)});
  EXPECT_EQ(Only().state, AlertState::kActive);
  Scan({});
  EXPECT_EQ(Only().state, AlertState::kCleared);
  EXPECT_EQ(Only().changed, time_);
  EXPECT_TRUE(Scan({}).empty());
}

TEST_F(AlertsTest, BeginClearingAnewWheneverTheyHold) {
  Scans(3, {Cpa(7, 0.9)});
  for (int i = 0; i < 5; ++i) {
    Scans(29, {});
    Scan({Cpa(7, 0.3)});
  }
  EXPECT_EQ(Only().state, AlertState::kActive);
}

TEST_F(AlertsTest, AreNotClearedByScansThatLostSomethingButRaisedByThem) {
  Scans(3, {Cpa(7, 0.9)}, false);
  EXPECT_EQ(Only().state, AlertState::kActive);
  Scans(200, {}, false);
  EXPECT_EQ(Only().state, AlertState::kActive);
}

TEST_F(AlertsTest, AreNotClearedByAGap) {
  Scans(3, {Cpa(7, 0.9)});
  Scans(3, {});
  time_ += std::chrono::seconds(60);
  Scans(30, {});
  EXPECT_EQ(Only().state, AlertState::kActive) << "nobody looked meanwhile";
  Scan({});
  EXPECT_EQ(Only().state, AlertState::kCleared);
}

TEST_F(AlertsTest, DoNotComeUpFromScansBeforeAGap) {
  Scans(2, {Cpa(7, 0.9)});
  time_ += std::chrono::seconds(2);
  EXPECT_TRUE(Scan({Cpa(7, 0.9)}).empty());
}

TEST_F(AlertsTest, GoOnWhenTimeStepsBack) {
  Scans(3, {Cpa(7, 0.9)});
  time_ -= std::chrono::hours(1);
  Scans(30, {});
  EXPECT_EQ(Only().state, AlertState::kActive);
  Scan({});
  EXPECT_EQ(Only().state, AlertState::kCleared);
}

TEST_F(AlertsTest, BecomeWarningsByTimeAndBack) {
  Scans(3, {Cpa(7, 0.9, 20.0)});
  EXPECT_EQ(Only().level, AlertLevel::kCaution);
  Scans(2, {Cpa(7, 0.9, 14.0)});
  EXPECT_EQ(Only().level, AlertLevel::kCaution);
  Scan({Cpa(7, 0.9, 14.0)});
  EXPECT_EQ(Only().level, AlertLevel::kWarning);
  EXPECT_EQ(Only().changed, time_);
  Scans(30, {Cpa(7, 0.9, 16.0)});
  EXPECT_EQ(Only().level, AlertLevel::kWarning);
  Scan({Cpa(7, 0.9, 16.0)});
  EXPECT_EQ(Only().level, AlertLevel::kCaution);
}

TEST_F(AlertsTest, AreWarningsAtOnceWhatIsInside) {
  Scans(3, {Cpa(7, 0.9, 0.0, 4.0)});
  EXPECT_EQ(Only().level, AlertLevel::kWarning);
  Scans(3, {Zone(3)});
  EXPECT_EQ(alerts_.alerts()[1].level, AlertLevel::kWarning);
}

TEST_F(AlertsTest, AreNoWarningsBecauseTimeIsZeroWhereTheyPart) {
  Scans(10, {Cpa(7, 0.6, 0.0, 6.0)});
  EXPECT_EQ(Only().level, AlertLevel::kCaution);
}

TEST_F(AlertsTest, AreAcknowledgedByIdAndTimeOfRaising) {
  Scans(3, {Cpa(7, 0.9)});
  auto other_run = Only();
  other_run.raised -= std::chrono::seconds(1);
  EXPECT_FALSE(Acknowledge(other_run));
  auto other_id = Only();
  other_id.id = 2;
  EXPECT_FALSE(Acknowledge(other_id));
  const auto alert = Only();
  EXPECT_TRUE(Acknowledge(alert));
  Scan({Cpa(7, 0.9)});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  EXPECT_EQ(Only().changed, time_);
  EXPECT_FALSE(Acknowledge(alert)) << "it is already";
  Scans(31, {});
  EXPECT_EQ(Only().state, AlertState::kCleared);
}

// Acknowledged ones that come back whenever a probability wavers are what users complain of most.
TEST_F(AlertsTest, StayAcknowledgedWhileTheProbabilityWavers) {
  Scans(3, {Cpa(7, 0.9)});
  Acknowledge(Only());
  for (int i = 0; i < 20; ++i) {
    Scans(15, {Cpa(7, 0.1)});
    Scans(5, {Cpa(7, 0.9)});
  }
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  EXPECT_EQ(Only().id, 1);
}

TEST_F(AlertsTest, WantANewAcknowledgementWhenTheyBecomeWarnings) {
  Scans(3, {Cpa(7, 0.9, 20.0)});
  Acknowledge(Only());
  Scans(3, {Cpa(7, 0.9, 10.0)});
  EXPECT_EQ(Only().state, AlertState::kActive);
  EXPECT_EQ(Only().level, AlertLevel::kWarning);
  Acknowledge(Only());
  Scans(40, {Cpa(7, 0.9, 20.0)});
  EXPECT_EQ(Only().level, AlertLevel::kCaution);
  EXPECT_EQ(Only().state, AlertState::kAcknowledged) << "less grave needs no new one";
}

TEST_F(AlertsTest, StayRectifiedUntilAcknowledgedWhereTheyWereWarnings) {
  Scans(3, {Cpa(7, 0.9, 10.0)});
  Scans(31, {});
  EXPECT_EQ(Only().state, AlertState::kRectified);
  Scans(1000, {});
  EXPECT_EQ(Only().state, AlertState::kRectified);
  EXPECT_TRUE(Acknowledge(Only()));
  Scan({});
  EXPECT_EQ(Only().state, AlertState::kCleared);
  EXPECT_TRUE(Scan({}).empty());
}

TEST_F(AlertsTest, AreTheSameAlertWhenTheyHoldAgainWhileRectified) {
  Scans(3, {Cpa(7, 0.9, 10.0)});
  const auto first = Only();
  Scans(40, {});
  Scans(3, {Cpa(7, 0.9, 10.0)});
  EXPECT_EQ(Only().state, AlertState::kActive);
  EXPECT_EQ(Only().id, first.id);
  EXPECT_EQ(Only().raised, first.raised);
}

TEST_F(AlertsTest, GetANewIdAfterTheyWereCleared) {
  Scans(3, {Cpa(7, 0.9)});
  Scans(40, {});
  Scans(3, {Cpa(7, 0.9)});
  EXPECT_EQ(Only().id, 2);
  EXPECT_EQ(Only().state, AlertState::kActive);
}

TEST_F(AlertsTest, OfManyRectifiedOnlyTheNewestStay) {
  for (std::int64_t track = 1; track <= 30; ++track) {
    Scans(3, {Cpa(track, 0.9, 10.0)});
    Scans(31, {});
  }
  Scans(3, {});
  EXPECT_EQ(alerts_.alerts().size(), Alerts::kMostRectified);
  for (const auto& alert : alerts_.alerts()) EXPECT_GT(alert.track_id, 14);
}

TEST_F(AlertsTest, GoWithATrackThatBecomesPartOfAnother) {
  Scans(3, {Cpa(7, 0.9)});
  Acknowledge(Only());
  alerts_.Rename(7, 4, time_);
  Scan({Cpa(4, 0.9)});
  EXPECT_EQ(Only().track_id, 4);
  EXPECT_EQ(Only().id, 1);
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  Scans(100, {Cpa(4, 0.9)});
  EXPECT_EQ(alerts_.alerts().size(), 1U);
}

TEST_F(AlertsTest, OfTwoTracksThatBecomeOneTheOlderStays) {
  Scans(3, {Cpa(7, 0.9)});
  Acknowledge(Only());
  Scans(3, {Cpa(7, 0.9), Cpa(4, 0.9, 10.0)});
  alerts_.Rename(7, 4, time_);
  const auto& both = Scan({Cpa(4, 0.9, 10.0)});
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].id, 1);
  EXPECT_EQ(both[0].track_id, 4);
  EXPECT_EQ(both[0].level, AlertLevel::kWarning);
  EXPECT_EQ(both[0].state, AlertState::kActive) << "the graver one was not acknowledged";
  EXPECT_EQ(both[1].id, 2);
  EXPECT_EQ(both[1].state, AlertState::kCleared);
  Scan({Cpa(4, 0.9, 10.0)});
  EXPECT_EQ(Only().id, 1);
}

TEST_F(AlertsTest, AreTwoForOneTrackInTheZoneAndOnItsWay) {
  Scans(3, {Cpa(7, 0.9), Zone(7)});
  ASSERT_EQ(alerts_.alerts().size(), 2U);
  EXPECT_EQ(alerts_.alerts()[0].cause, AlertCause::kGuardZone);
  EXPECT_TRUE(std::isnan(alerts_.alerts()[0].tcpa_s));
  EXPECT_TRUE(std::isnan(alerts_.alerts()[0].cpa_probability));
}

// Now this track, now that one, now none: something is in the zone in 3 of 5 scans.
TEST_F(AlertsTest, ComeUpForTheZoneWhateverItsThingsAreCalled) {
  Scan({Zone(7)});
  Scan({Zone(kUnnamed)});
  EXPECT_TRUE(alerts_.alerts().empty());
  Scan({Zone(8, 6.0), Zone(kLandTrack, 9.0)});
  EXPECT_EQ(Only().track_id, kUnnamed);
  EXPECT_EQ(Only().level, AlertLevel::kWarning);
  EXPECT_EQ(Only().distance_m, 6.0) << "the nearest";
}

TEST_F(AlertsTest, AreOneForAThingThatIsNamedFromTheFirst) {
  for (int i = 0; i < 10; ++i) {
    const auto& alerts = Scan({Zone(7)});
    ASSERT_EQ(alerts.size(), i < 2 ? 0U : 1U) << i;
  }
  EXPECT_EQ(Only().track_id, 7);
}

TEST_F(AlertsTest, OfTheZoneHaveNothingToSayOfWhatIsNamedMeanwhile) {
  Scans(3, {Zone(kUnnamed)});
  Scans(3, {Zone(7)});
  ASSERT_EQ(alerts_.alerts().size(), 2U);
  Scans(30, {Zone(7)});
  ASSERT_EQ(alerts_.alerts().size(), 2U);
  EXPECT_EQ(alerts_.alerts()[1].state, AlertState::kCleared) << "and not rectified: the other one is to be acknowledged";
  Scan({Zone(7)});
  EXPECT_EQ(Only().track_id, 7);
}

// What has an alert goes, and another thing, which is called otherwise in each scan, was there all the time.
TEST_F(AlertsTest, OfTheZoneComeUpAsSoonAsNoOtherOfItHolds) {
  Scans(3, {Zone(7)});
  std::int64_t id = 100;
  for (int i = 0; i < 40; ++i) {
    const auto& alerts = Scan({Zone(id++)});
    ASSERT_TRUE(std::ranges::any_of(alerts, &Alert::Holds)) << i;
    ASSERT_TRUE(i >= 29 || alerts.size() == 1U) << "one is enough";
  }
}

// Who has taken note of the pile beside the boat is told of what comes, also where nobody can follow it.
TEST_F(AlertsTest, AreRaisedBesideAnAcknowledgedOneByWhatHasNoName) {
  Scans(3, {Zone(7)});
  EXPECT_TRUE(Acknowledge(Only()));
  Scan({Zone(7), Zone(11)});
  Scan({Zone(7), Zone(12)});
  Scan({Zone(7), Zone(13)});
  ASSERT_EQ(alerts_.alerts().size(), 2U);
  EXPECT_EQ(alerts_.alerts()[0].track_id, kUnnamed);
  EXPECT_EQ(alerts_.alerts()[0].state, AlertState::kActive);
}

TEST_F(AlertsTest, StandTheGravestFirst) {
  Scans(3, {Cpa(9, 0.9, 10.0)});
  Acknowledge(Only());
  Scans(3, {Cpa(9, 0.9, 10.0), Cpa(1, 0.9, 28.0), Cpa(2, 0.9, 22.0), Cpa(3, 0.9, 12.0), Cpa(5, 0.9, 11.0)});
  std::vector<std::int64_t> tracks;
  for (const auto& alert : alerts_.alerts()) tracks.push_back(alert.track_id);
  EXPECT_EQ(tracks, (std::vector<std::int64_t>{5, 3, 9, 2, 1}));
}

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

}  // namespace
}  // namespace lookout::tracker
