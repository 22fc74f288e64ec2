// When alerts come up, how grave they are, and when they end.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "tests/unit/tracker/alerts_fixture.hpp"

namespace lookout::tracker {
namespace {

TEST_F(AlertsTest, ComeUpInThreeOfFiveScans) {
  EXPECT_TRUE(Scan({Cpa(7, 0.6)}).empty());
  EXPECT_TRUE(Scan({Cpa(7, 0.4)}).empty());
  EXPECT_TRUE(Scan({Cpa(7, 0.6)}).empty());
  EXPECT_TRUE(Scan({}).empty());
  const auto& raised = Scan({Cpa(7, 0.5, 24.0, 33.0)});
  ASSERT_EQ(raised.size(), 1U);
  EXPECT_EQ(raised[0].id, 1);
  EXPECT_EQ(raised[0].cause, AlertCause::kClosestApproach);
  EXPECT_EQ(raised[0].thing, 7);
  EXPECT_EQ(raised[0].state, AlertState::kActive);
  EXPECT_EQ(raised[0].level, AlertLevel::kCaution);
  EXPECT_EQ(raised[0].raised, time_);
  EXPECT_EQ(raised[0].tcpa_s, 24.0);
  EXPECT_EQ(raised[0].distance_m, 33.0);
  EXPECT_EQ(raised[0].cpa_probability, 0.5);
}

TEST_F(AlertsTest, ComeUpAtOnceWhereAKnownTrackEntersTheZone) {
  auto known = Zone(7);
  known.is_known = true;
  EXPECT_EQ(Scan({known}).size(), 1U);
  Scans(40, {});
  EXPECT_TRUE(alerts_.alerts().empty());
  known.probability = 0.4;
  EXPECT_TRUE(Scan({known}).empty());
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

// Its course is on the bow now and beside it now, as the boat yaws.
TEST_F(AlertsTest, StandLongerOfWhatIsFarAhead) {
  Scans(3, {Cpa(7, 0.9, 25.0), Cpa(8, 0.9, 16.0)});
  Scans(52, {Cpa(7, 0.1, 24.0), Cpa(8, 0.1, 15.0)});
  EXPECT_EQ(Only().thing, 7);
  Scans(20, {Cpa(7, 0.1, 20.0)});
  EXPECT_EQ(Only().state, AlertState::kActive);
  Scans(5, {Cpa(7, 0.1, 19.0)});
  EXPECT_TRUE(alerts_.alerts().empty());
}

TEST_F(AlertsTest, DoNotEndBeforeTheThingEntersTheZone) {
  Scans(3, {Cpa(7, 0.9, 5.0)});
  auto at_edge = Zone(7, 11.0);
  at_edge.probability = 0.3;
  Scans(100, {Cpa(7, 0.1, 5.0), at_edge});
  EXPECT_EQ(Only().state, AlertState::kActive);
  const auto changed = Only().changed;
  Scans(5, {Cpa(7, 0.1, 5.0), Zone(7)});
  EXPECT_EQ(Only().changed, changed);
  EXPECT_TRUE(Only().is_in_zone);
  Scans(31, {});
  EXPECT_TRUE(Only().state == AlertState::kCleared || Only().state == AlertState::kRectified);
}

// A companion opens out and stays on a course that is now likely and now not: when it closes again it is told again.
TEST_F(AlertsTest, OfTheZoneEndWhereTheThingIsFarOutsideAndMayComeNear) {
  Scans(3, {Zone(7)});
  ASSERT_TRUE(Acknowledge(Only()));
  Scans(1, {Zone(7)});
  Scans(200, {Cpa(7, 0.3, 25.0, 30.0)});
  Scans(5, {Zone(7)});
  EXPECT_EQ(Only().state, AlertState::kActive);
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
  Scans(95, {}, false);
  EXPECT_EQ(Only().state, AlertState::kActive);
  Scans(5 + 30, {}, false);
  EXPECT_EQ(Only().state, AlertState::kCleared) << "where each scan lacks a packet, an alert must not stand for ever";
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

TEST_F(AlertsTest, AreTheSameAlertWhenTheyComeAgainWithinTenSeconds) {
  Scans(3, {Cpa(7, 0.9)});
  const auto first = Only();
  Scans(31, {});
  EXPECT_EQ(Only().state, AlertState::kCleared);
  EXPECT_EQ(Only().end, AlertEnd::kClear);
  Scans(90, {});
  EXPECT_TRUE(alerts_.alerts().empty());
  EXPECT_FALSE(Acknowledge(first)) << "it is over";
  Scans(3, {Cpa(7, 0.9)});
  EXPECT_EQ(Only().id, first.id);
  EXPECT_EQ(Only().raised, first.raised);
  EXPECT_EQ(Only().state, AlertState::kActive);
  EXPECT_EQ(Only().end, AlertEnd::kNone);
}

// Nobody wants to take note of the same buoy twice.
TEST_F(AlertsTest, ComeAgainAcknowledgedUnlessTheyAreGraver) {
  Scans(3, {Cpa(7, 0.9)});
  Acknowledge(Only());
  Scans(40, {});
  Scans(3, {Cpa(7, 0.9)});
  EXPECT_EQ(Only().state, AlertState::kAcknowledged);
  Scans(40, {});
  Scans(3, {Cpa(7, 0.9, 10.0)});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

TEST_F(AlertsTest, GetANewIdLaterThanThat) {
  Scans(3, {Cpa(7, 0.9)});
  Scans(31, {});
  Scans(101, {});
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
  for (const auto& alert : alerts_.alerts()) EXPECT_GT(alert.thing, 14);
}

TEST_F(AlertsTest, StandTheGravestFirst) {
  Scans(3, {Cpa(9, 0.9, 10.0)});
  Acknowledge(Only());
  Scans(3, {Cpa(9, 0.9, 10.0), Cpa(1, 0.9, 28.0), Cpa(2, 0.9, 22.0), Cpa(3, 0.9, 12.0), Cpa(5, 0.9, 11.0)});
  std::vector<std::int64_t> tracks;
  for (const auto& alert : alerts_.alerts()) tracks.push_back(alert.thing);
  EXPECT_EQ(tracks, (std::vector<std::int64_t>{5, 3, 9, 2, 1}));
}

}  // namespace
}  // namespace lookout::tracker
