// One thing, one alert: by whatever causes, under whatever name, seen or not.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "tests/unit/tracker/alerts_fixture.hpp"

namespace lookout::tracker {
namespace {

TEST_F(AlertsTest, GoWithATrackThatBecomesPartOfAnother) {
  Scans(3, {Cpa(7, 0.9)});
  Acknowledge(Only());
  alerts_.Rename(7, 4, time_);
  Scan({Cpa(4, 0.9)});
  EXPECT_EQ(Only().thing, 4);
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
  EXPECT_EQ(both[0].thing, 4);
  EXPECT_EQ(both[0].level, AlertLevel::kWarning);
  EXPECT_EQ(both[0].state, AlertState::kActive) << "the graver one was not acknowledged";
  EXPECT_EQ(both[1].id, 2);
  EXPECT_EQ(both[1].state, AlertState::kCleared);
  Scan({Cpa(4, 0.9, 10.0)});
  EXPECT_EQ(Only().id, 1);
}

// A graver cause and a cause less: one panel, one sound.
TEST_F(AlertsTest, AreOneForAThingInTheZoneAndOnItsWay) {
  auto zone = Zone(7, 6.2);
  zone.is_grave = false;
  Scans(3, {Cpa(7, 0.9), zone});
  EXPECT_TRUE(Only().is_in_zone);
  EXPECT_TRUE(Only().comes_near);
  EXPECT_EQ(Only().cause, AlertCause::kClosestApproach);
  EXPECT_EQ(Only().level, AlertLevel::kCaution);
  EXPECT_EQ(Only().distance_m, 6.2);
  EXPECT_EQ(Only().tcpa_s, 25.0);
  Scans(3, {Cpa(7, 0.9, 10.0), zone});
  EXPECT_EQ(Only().level, AlertLevel::kWarning);
  Scans(40, {zone});
  EXPECT_EQ(Only().cause, AlertCause::kGuardZone);
  EXPECT_FALSE(Only().comes_near);
  EXPECT_EQ(Only().level, AlertLevel::kCaution);
  EXPECT_EQ(Only().id, 1);
}

// Now this track, now that one, now none: something is in the zone in 3 of 5 scans.
// A shore abeam in the zone, and the same shore dead ahead.
TEST_F(AlertsTest, TellWhatLiesOnTheWayWhereItIsElsewhere) {
  auto beside = Zone(kLandTrack, 8.0);
  beside.is_grave = false;
  beside.bearing_rad = DegToRad(60.0);
  auto ahead = Cpa(kLandTrack, 0.9, 20.0, 25.0);
  ahead.bearing_rad = DegToRad(355.0);
  ahead.time_left_s = 15.0;
  Scans(3, {beside, ahead});
  EXPECT_TRUE(Only().is_in_zone && Only().comes_near);
  EXPECT_TRUE(Only().tells_way);
  EXPECT_EQ(Only().distance_m, 25.0);
  ahead.bearing_rad = DegToRad(50.0);
  Scan({beside, ahead});
  EXPECT_FALSE(Only().tells_way);
  EXPECT_EQ(Only().distance_m, 8.0) << "the nearest of the same place";
  beside.probability = 0.3;
  Scan({beside, ahead});
  EXPECT_EQ(Only().distance_m, 25.0) << "that is beyond the edge of the zone";
}

TEST_F(AlertsTest, ComeUpForTheZoneWhateverItsThingsAreCalled) {
  Scan({Zone(7)});
  Scan({Zone(kUnnamed)});
  EXPECT_TRUE(alerts_.alerts().empty());
  Scan({Zone(8, 6.0), Zone(kLandTrack, 9.0)});
  EXPECT_EQ(Only().thing, kUnnamed);
  EXPECT_EQ(Only().level, AlertLevel::kWarning);
  EXPECT_EQ(Only().distance_m, 6.0) << "the nearest";
}

TEST_F(AlertsTest, AreOneForAThingThatIsNamedFromTheFirst) {
  for (int i = 0; i < 10; ++i) {
    const auto& alerts = Scan({Zone(7)});
    ASSERT_EQ(alerts.size(), i < 2 ? 0U : 1U) << i;
  }
  EXPECT_EQ(Only().thing, 7);
}

TEST_F(AlertsTest, OfTheZoneHaveNothingToSayOfWhatIsNamedMeanwhile) {
  Scans(3, {Zone(kUnnamed)});
  Scans(3, {Zone(7)});
  ASSERT_EQ(alerts_.alerts().size(), 2U);
  Scans(30, {Zone(7)});
  ASSERT_EQ(alerts_.alerts().size(), 2U);
  EXPECT_EQ(alerts_.alerts()[1].state, AlertState::kCleared) << "and not rectified: the other one is to be acknowledged";
  Scan({Zone(7)});
  EXPECT_EQ(Only().thing, 7);
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
  EXPECT_EQ(alerts_.alerts()[0].thing, kUnnamed);
  EXPECT_EQ(alerts_.alerts()[0].state, AlertState::kActive);
}

// Tracks around a boat that looks north.
class AlertsOfTracks : public AlertsTest {
 protected:
  AlertsOfTracks() {
    around_.own.emplace();
    around_.own->is_placed = true;
    Show();
  }
  void MoveOwn(double north_m) { around_.own->position_map_m = {0.0, north_m, 0.0}; }
  void Show(const std::vector<Track>& tracks = {}) {
    tracks_ = tracks;
    around_.tracks = tracks_;
  }
  static Track Known(std::int64_t id, TrackStatus status = TrackStatus::kConfirmed, double existence = 0.99) {
    Track track;
    track.id = id;
    track.status = status;
    track.existence_probability = existence;
    return track;
  }
  // On its way, seen at a place.
  Danger At(std::int64_t id, double east_m, double north_m) const {
    auto danger = Cpa(id, 0.9);
    danger.place_map_m = {east_m, north_m};
    danger.first = danger.seen = time_;
    return danger;
  }

 private:
  std::vector<Track> tracks_;
};

TEST_F(AlertsOfTracks, SayAtOnceThatATrackIsNotSeenAnyMore) {
  Show({Known(7)});
  Scans(5, {At(7, 0.0, 20.0)});
  EXPECT_EQ(Only().sight, AlertSight::kSeen);
  EXPECT_EQ(Only().nearest_track, 7);
  Show({Known(7, TrackStatus::kLost, 0.9)});
  Scan({});
  EXPECT_EQ(Only().sight, AlertSight::kLost);
  EXPECT_EQ(Only().nearest_track, 0);
  EXPECT_TRUE(std::isnan(Only().tcpa_s)) << "no frozen numbers";
  EXPECT_NEAR(Only().distance_m, 20.0, 1e-9);
  Show();
  MoveOwn(8.0);
  Scan({});
  EXPECT_NEAR(Only().distance_m, 12.0, 1e-9) << "from where it was, as the boat moves";
  EXPECT_NEAR(WrapToPi(Only().bearing_rad), 0.0, 1e-9);
}

TEST_F(AlertsOfTracks, StayForTenSecondsOfWhatMayBeHidden) {
  Show({Known(7)});
  Scans(5, {At(7, 0.0, 20.0)});
  Show();
  Scans(100, {});
  EXPECT_EQ(Only().state, AlertState::kActive);
  Scans(35, {});
  EXPECT_TRUE(alerts_.alerts().empty());
}

// Each scan lacked a packet, so none cleared anything: the alert of a boat that was gone stood for good.
TEST_F(AlertsOfTracks, EndOfWhatIsNotSeenAnyMoreThoughNoScanIsWhole) {
  Show({Known(7)});
  Scans(5, {At(7, 0.0, 20.0)});
  Show({Known(7, TrackStatus::kLost, 0.05)});
  Scan({}, false);
  Show();
  Scans(100, {}, false);
  EXPECT_EQ(Only().state, AlertState::kActive) << "it may be where the packets were lost";
  Scans(35, {}, false);
  EXPECT_TRUE(alerts_.alerts().empty());

  auto unnamed = Zone(kUnnamed);
  unnamed.place_map_m = {1.0, 7.0};
  Scans(5, {unnamed}, false);
  ASSERT_EQ(Only().thing, kUnnamed);
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(140, {}, false);
  EXPECT_TRUE(alerts_.alerts().empty());
}

// Nobody looked for 20 s: it may be seen again now.
TEST_F(AlertsOfTracks, OfWhatMayBeHiddenOutliveAGap) {
  Show({Known(7)});
  Scans(5, {At(7, 0.0, 20.0)});
  Show();
  Scans(5, {});
  time_ += std::chrono::seconds(20);
  Scans(50, {});
  EXPECT_EQ(Only().state, AlertState::kActive);
}

TEST_F(AlertsOfTracks, EndSoonOfWhatIsGoneOrAbaft) {
  Show({Known(7)});
  Scans(5, {At(7, 0.0, 20.0)});
  Show({Known(7, TrackStatus::kLost, 0.05)});
  Scan({});
  Show();
  Scans(30, {});
  EXPECT_EQ(Only().state, AlertState::kCleared);
  EXPECT_EQ(Only().end, AlertEnd::kGone) << "it was looked for";

  Show({Known(8)});
  Scans(5, {At(8, 3.0, 4.0)});
  Show({Known(8, TrackStatus::kLost)});
  MoveOwn(6.0);
  Scan({});
  Show();
  Scans(30, {});
  EXPECT_EQ(Only().state, AlertState::kCleared);
  EXPECT_EQ(Only().end, AlertEnd::kPassed);
}

TEST_F(AlertsOfTracks, EndASecondAfterAThingHasPassed) {
  Show({Known(7)});
  auto passing = At(7, 3.0, 4.0);
  Scans(5, {passing});
  passing.probability = 0.0;
  passing.tcpa_s = 0.0;
  passing.bearing_rad = DegToRad(120.0);
  Scans(11, {passing});
  EXPECT_EQ(Only().state, AlertState::kCleared);
  EXPECT_EQ(Only().end, AlertEnd::kPassed);
}

TEST_F(AlertsOfTracks, GoOnUnderTheNumberUnderWhichAThingIsFoundAgain) {
  Show({Known(7)});
  Scans(5, {At(7, 0.0, 20.0)});
  EXPECT_TRUE(Acknowledge(Only()));
  Show({Known(7, TrackStatus::kLost)});
  Scans(20, {});
  Show({Known(9), Known(10)});
  Scans(5, {At(9, 1.0, 18.5), At(10, 8.0, 20.0)});
  ASSERT_EQ(alerts_.alerts().size(), 2U);
  const auto same = std::ranges::find(alerts_.alerts(), 9, &Alert::thing);
  ASSERT_NE(same, alerts_.alerts().end());
  EXPECT_EQ(same->id, 1);
  EXPECT_EQ(same->state, AlertState::kAcknowledged);
  EXPECT_EQ(same->sight, AlertSight::kSeen);
}

// Two of Imazu's encounters told twice of a boat that was not seen for 5 s, and was 20 m farther on its way by then.
TEST_F(AlertsOfTracks, GoOnWhereAThingIsFoundAgainOnItsWay) {
  auto boat = Known(7);
  boat.velocity_mps = {0.0, -4.0};
  Show({boat});
  Scans(5, {At(7, 0.0, 60.0)});
  Show({Known(7, TrackStatus::kLost, 0.05)});
  Scans(50, {});
  Show({Known(9), Known(10)});
  Scans(5, {At(9, 1.0, 39.0), At(10, 0.0, 50.0)});
  const auto same = std::ranges::find(alerts_.alerts(), 9, &Alert::thing);
  ASSERT_NE(same, alerts_.alerts().end());
  EXPECT_EQ(same->id, 1);
  const auto other = std::ranges::find(alerts_.alerts(), 10, &Alert::thing);
  ASSERT_NE(other, alerts_.alerts().end());
  EXPECT_NE(other->id, 1);
}

// A boat got a second track, and an alert of that, before its first was given up.
TEST_F(AlertsOfTracks, BecomeOneWhereAThingHadASecondTrackWhenItsFirstWasLost) {
  Show({Known(7)});
  Scans(5, {At(7, 0.0, 20.0)});
  EXPECT_TRUE(Acknowledge(Only()));
  Show({Known(7), Known(9)});
  auto second = At(9, 1.0, 20.0);
  Scans(3, {At(7, 0.0, 20.0), second});
  ASSERT_EQ(alerts_.alerts().size(), 2U);
  Show({Known(7, TrackStatus::kLost), Known(9)});
  Scans(1, {second});
  Scans(1, {second});
  EXPECT_EQ(alerts_.alerts().size(), 2U) << "the second is told once as part of the first";
  Scans(1, {second});
  EXPECT_EQ(Only().id, 1);
  EXPECT_EQ(Only().thing, 9);
  EXPECT_EQ(Only().state, AlertState::kActive) << "nobody took note of the second";
}

// A motor boat that comes by where an acknowledged buoy was lost is no buoy.
TEST_F(AlertsOfTracks, DoNotPassToWhatWasSeenElsewhereBefore) {
  Show({Known(7), Known(9)});
  Scans(5, {At(7, 0.0, 20.0)});
  EXPECT_TRUE(Acknowledge(Only()));
  const auto long_ago = time_ - std::chrono::seconds(5);
  Show({Known(7, TrackStatus::kLost), Known(9)});
  Scans(20, {});
  auto boat = At(9, 1.0, 19.0);
  boat.first = long_ago;
  Show({Known(9)});
  Scans(5, {boat});
  const auto other = std::ranges::find(alerts_.alerts(), 9, &Alert::thing);
  ASSERT_NE(other, alerts_.alerts().end());
  EXPECT_EQ(other->state, AlertState::kActive);
  EXPECT_EQ(other->id, 2);
}

// What comes out from behind a pier so late may be another boat: it has the alert, and nobody has taken note.
TEST_F(AlertsOfTracks, SoundAgainForWhatComesUpLongAfterAnAcknowledgedBoatWasLost) {
  for (const bool is_late : {false, true}) {
    SCOPED_TRACE(is_late);
    alerts_ = Alerts(kAlertParams);
    Show({Known(7)});
    Scans(5, {At(7, 0.0, 20.0)});
    EXPECT_TRUE(Acknowledge(Only()));
    Show({Known(7, TrackStatus::kLost)});
    Scans(is_late ? 115 : 20, {});
    Show({Known(9)});
    auto boat = At(9, 0.0, is_late ? 26.0 : 21.0);
    boat.first = time_;
    Scans(5, {boat});
    EXPECT_EQ(Only().thing, 9);
    EXPECT_EQ(Only().state, is_late ? AlertState::kActive : AlertState::kAcknowledged);
  }
}

// A second boat comes out of the lee of one whose alert was acknowledged and is over: it was born acknowledged, and never rang.
TEST_F(AlertsOfTracks, DoNotPassFromABoatThatIsStillThere) {
  Show({Known(5)});
  Scans(5, {At(5, 0.0, 20.0)});
  EXPECT_TRUE(Acknowledge(Only()));
  Scans(40, {});
  EXPECT_TRUE(std::ranges::none_of(alerts_.alerts(), &Alert::Holds));
  Show({Known(5), Known(9)});
  Scans(5, {At(9, 3.0, 20.0)});
  EXPECT_EQ(Only().thing, 9);
  EXPECT_EQ(Only().id, 2);
  EXPECT_EQ(Only().state, AlertState::kActive);
}

TEST_F(AlertsOfTracks, KeepWhatHadNoNameWhenItGetsOne) {
  auto unnamed = Zone(kUnnamed);
  unnamed.place_map_m = {1.0, 7.0};
  Scans(5, {unnamed});
  EXPECT_EQ(Only().thing, kUnnamed);
  Show({Known(3)});
  auto named = Zone(3);
  named.place_map_m = {1.3, 6.5};
  named.first = time_;
  Scans(50, {named});
  EXPECT_EQ(Only().thing, 3);
  EXPECT_EQ(Only().id, 1);
}

TEST_F(AlertsOfTracks, AreToldAsJustSeenWhereAllThatIsKnownIsSo) {
  Show({Known(-5, TrackStatus::kTentative)});
  auto young = Zone(-5);
  young.is_just_seen = true;
  Scans(5, {young});
  EXPECT_EQ(Only().sight, AlertSight::kJustSeen);
  alerts_.Rename(-5, 6, time_);
  Show({Known(6)});
  Scan({Zone(6)});
  EXPECT_EQ(Only().sight, AlertSight::kSeen);
  EXPECT_EQ(Only().id, 1);
}

}  // namespace
}  // namespace lookout::tracker
