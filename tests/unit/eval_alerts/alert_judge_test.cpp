// Situations drawn by hand: the own boat is a square of 2 m that goes north, or lies at the origin.
#include "lab/eval/tracks/alert_judge.hpp"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/eval_tracks/track_cases.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

AlertRules Rules() {
  AlertRules rules;
  rules.zone = {.range_m = 10.0, .bearing = {DegToRad(300.0), DegToRad(120.0)}};
  return rules;
}

AlertThing Thing(int id, const Vector2d& center_m, const Vector2d& velocity_mps = {0.0, 0.0}, double side_m = 2.0) {
  AlertThing thing;
  thing.id = id;
  thing.group = id;
  thing.name = "thing_" + std::to_string(id);
  thing.kind = "boat";
  thing.is_in_water = true;
  thing.outline_m = std::make_shared<const HullOutline>(SquareAt(center_m, side_m));
  thing.motion.velocity_mps = velocity_mps;
  thing.num_returns = 20;
  return thing;
}

AlertThing Land(int id, const Vector2d& center_m, double side_m) {
  auto land = Thing(id, center_m, {0.0, 0.0}, side_m);
  land.is_in_water = false;
  land.kind = "island";
  return land;
}

JudgedAlert Approach(std::int64_t id, const Vector2d& track_m) {
  JudgedAlert alert;
  alert.id = id;
  alert.is_of_approach = true;
  alert.holds = true;
  alert.is_open = true;
  alert.track_id = 100 + id;
  alert.track = AlertTrackPlace{track_m, {}};
  alert.distance_m = track_m.norm();
  return alert;
}

JudgedAlert Zone(std::int64_t id, const Vector2d& track_m) {
  auto alert = Approach(id, track_m);
  alert.is_of_approach = false;
  alert.is_of_zone = true;
  alert.is_warning = true;
  return alert;
}

JudgedAlert OfNoTrack(std::int64_t id, bool is_of_zone, double distance_m, double bearing_deg) {
  JudgedAlert alert;
  alert.id = id;
  alert.is_of_zone = is_of_zone;
  alert.is_of_approach = !is_of_zone;
  alert.holds = true;
  alert.is_open = true;
  alert.distance_m = distance_m;
  alert.bearing_rad = DegToRad(bearing_deg);
  return alert;
}

// A run that is written scan by scan.
struct Situation {
  AlertJudge judge{Rules()};
  std::int64_t utime_us = 0;
  double speed_mps = 2.0;  // to the north
  Vector2d own_m = Vector2d::Zero();

  void Scan(std::vector<AlertThing> things, std::vector<JudgedAlert> alerts) {
    AlertScan scan;
    scan.utime_us = utime_us;
    scan.own.hull_m = SquareAt(own_m);
    scan.own.reference_m = own_m;
    scan.own.motion.velocity_mps = {0.0, speed_mps};
    scan.things = std::move(things);
    scan.alerts = std::move(alerts);
    judge.Add(scan);
    utime_us += kScanUs;
  }
  // The boat stays where it is, as on a treadmill.
  void Scans(int num_scans, const std::vector<AlertThing>& things, const std::vector<JudgedAlert>& alerts) {
    for (int n = 0; n < num_scans; ++n) Scan(things, alerts);
  }
  AlertScores Scores() {
    judge.Finish();
    return judge.scores();
  }
};

AlertVerdict TheVerdict(const AlertScores& scores) {
  EXPECT_EQ(scores.NumAlerts(), 1);
  for (const auto verdict : {AlertVerdict::kRight, AlertVerdict::kBorder, AlertVerdict::kFar, AlertVerdict::kNothing, AlertVerdict::kRepeated}) {
    if (scores.Num(verdict) == 1) return verdict;
  }
  ADD_FAILURE() << "no alert";
  return AlertVerdict::kNothing;
}

// The gap abeam of what is passed is its place to the east less 2 m.
AlertVerdict VerdictOfPassing(double gap_m) {
  Situation run;
  const Vector2d place_m(gap_m + 2.0, 30.0);
  run.Scan({Thing(1, place_m)}, {Approach(1, place_m)});
  return TheVerdict(run.Scores());
}

TEST(AlertVerdicts, OfAnApproachGoByTheTruePassingDistance) {
  EXPECT_EQ(VerdictOfPassing(0.5), AlertVerdict::kRight);
  EXPECT_EQ(VerdictOfPassing(5.9), AlertVerdict::kRight);
  EXPECT_EQ(VerdictOfPassing(6.1), AlertVerdict::kBorder);
  EXPECT_EQ(VerdictOfPassing(7.9), AlertVerdict::kBorder);
  EXPECT_EQ(VerdictOfPassing(8.1), AlertVerdict::kFar);
}

TEST(AlertVerdicts, OfWhatComesLaterThanTheLookAheadAreFar) {
  Situation run;
  run.Scan({Thing(1, {0.0, 90.0})}, {Approach(1, {0.0, 90.0})});
  EXPECT_EQ(TheVerdict(run.Scores()), AlertVerdict::kFar);
}

TEST(AlertVerdicts, OfAMovingThingGoByItsCourse) {
  for (const double east_mps : {-2.0, 2.0}) {  // towards the bow, and away
    Situation run;
    run.Scan({Thing(1, {20.0, 20.0}, {east_mps, 0.0})}, {Approach(1, {20.0, 20.0})});
    EXPECT_EQ(TheVerdict(run.Scores()), east_mps < 0.0 ? AlertVerdict::kRight : AlertVerdict::kFar);
  }
}

TEST(AlertVerdicts, WhereNothingLiesWithin3mOfTheTrackIsNothing) {
  for (const double off_m : {2.9, 3.1}) {
    Situation run;
    run.Scan({Thing(1, {0.0, 30.0})}, {Approach(1, {1.0 + off_m, 30.0})});
    EXPECT_EQ(TheVerdict(run.Scores()), off_m < 3.0 ? AlertVerdict::kRight : AlertVerdict::kNothing);
  }
}

// The middle of a bent pier's track lies in the water, its outline on the pier.
TEST(AlertVerdicts, TheOutlineOfATrackTellsWhereItsMiddleDoesNot) {
  Situation run;
  auto alert = Approach(1, {8.0, 30.0});
  alert.track->outline_m = SquareAt({6.0, 30.0}, 8.0);
  run.Scan({Thing(1, {2.0, 30.0})}, {alert});
  EXPECT_EQ(TheVerdict(run.Scores()), AlertVerdict::kRight);
}

TEST(AlertVerdicts, OfTwoThingsTheNearerToTheTrackCounts) {
  Situation run;
  run.Scan({Thing(1, {0.0, 30.0}), Thing(2, {20.0, 30.0})}, {Approach(1, {17.5, 30.0})});
  EXPECT_EQ(TheVerdict(run.Scores()), AlertVerdict::kFar);
}

AlertVerdict VerdictOfZone(double range_m, double bearing_deg) {
  Situation run;
  run.speed_mps = 0.0;
  const Vector2d direction(std::sin(DegToRad(bearing_deg)), std::cos(DegToRad(bearing_deg)));
  const Vector2d place_m = range_m * direction;
  run.Scan({Thing(1, place_m, {0.0, 0.0}, 0.02)}, {Zone(1, place_m)});
  return TheVerdict(run.Scores());
}

TEST(AlertVerdicts, OfTheGuardZoneGoByRangeAndSector) {
  EXPECT_EQ(VerdictOfZone(9.0, 0.0), AlertVerdict::kRight);
  EXPECT_EQ(VerdictOfZone(10.9, 30.0), AlertVerdict::kRight);
  EXPECT_EQ(VerdictOfZone(12.0, 0.0), AlertVerdict::kBorder);
  EXPECT_EQ(VerdictOfZone(13.2, 0.0), AlertVerdict::kFar);
  EXPECT_EQ(VerdictOfZone(9.0, 64.0), AlertVerdict::kRight);
  EXPECT_EQ(VerdictOfZone(9.0, 70.0), AlertVerdict::kBorder);
  EXPECT_EQ(VerdictOfZone(9.0, 80.0), AlertVerdict::kFar);
}

// A berth: the neighbour lies 1 m off, and neither of both goes anywhere.
TEST(AlertVerdicts, InABerthNothingApproaches) {
  Situation run;
  run.speed_mps = 0.03;
  run.Scan({Thing(1, {3.0, 0.0})}, {Approach(1, {3.0, 0.0})});
  EXPECT_EQ(TheVerdict(run.Scores()), AlertVerdict::kFar);
  EXPECT_EQ(run.judge.scores().NumDangers(), 0);
  EXPECT_EQ(run.judge.scores().num_false_in_berth, 1);
}

TEST(AlertVerdicts, WhatWasSoInTheLastHalfSecondCounts) {
  for (const int num_scans_since : {4, 7}) {
    Situation run;
    run.Scan({Thing(1, {0.0, 30.0})}, {});
    run.Scans(num_scans_since - 1, {Thing(1, {20.0, 30.0})}, {});
    run.Scan({Thing(1, {20.0, 30.0})}, {Approach(1, {20.0, 30.0})});
    EXPECT_EQ(TheVerdict(run.Scores()), num_scans_since == 4 ? AlertVerdict::kRight : AlertVerdict::kFar);
  }
}

TEST(AlertVerdicts, LandIsFoundByThePlaceThatIsTold) {
  // An island 20 m on each side, its shore 30 m ahead.
  const auto island = Land(1, {0.0, 40.0}, 20.0);
  {
    Situation run;
    run.Scan({island}, {OfNoTrack(1, false, 29.0, 0.0)});  // from the hull, whose bow is 1 m ahead
    EXPECT_EQ(TheVerdict(run.Scores()), AlertVerdict::kRight);
  }
  {
    Situation run;
    run.Scan({island}, {OfNoTrack(1, false, 29.0, 90.0)});
    EXPECT_EQ(TheVerdict(run.Scores()), AlertVerdict::kNothing);
  }
  {
    Situation run;  // in the zone: 9 m from the reference point
    run.Scan({Land(1, {0.0, 19.0}, 20.0)}, {OfNoTrack(1, true, 9.0, 0.0)});
    EXPECT_EQ(TheVerdict(run.Scores()), AlertVerdict::kRight);
  }
}

TEST(AlertVerdicts, RepeatedIsWhatHasAnAlertOrHadOneLessThan10sAgo) {
  const auto thing = Thing(1, {0.0, 30.0});
  {
    Situation run;  // holds still; of another cause and track
    run.Scan({thing}, {Approach(1, {0.0, 30.0})});
    run.Scan({thing}, {Approach(1, {0.0, 30.0}), Approach(2, {0.5, 30.0})});
    const auto scores = run.Scores();
    EXPECT_EQ(scores.Num(AlertVerdict::kRight), 1);
    EXPECT_EQ(scores.Num(AlertVerdict::kRepeated), 1);
  }
  for (const int num_scans_between : {98, 101}) {
    Situation run;
    run.Scan({thing}, {Approach(1, {0.0, 30.0})});
    run.Scans(num_scans_between, {thing}, {});
    run.Scan({thing}, {Approach(2, {0.0, 30.0})});
    EXPECT_EQ(run.Scores().Num(AlertVerdict::kRepeated), num_scans_between < 100 ? 1 : 0) << num_scans_between;
  }
  {
    Situation run;  // two of one scan: the second of both
    run.Scan({thing}, {Approach(1, {0.0, 30.0}), Zone(2, {0.0, 30.0}), Approach(3, {0.0, 30.0})});
    const auto scores = run.Scores();
    EXPECT_EQ(scores.Num(AlertVerdict::kRight), 1);
    EXPECT_EQ(scores.Num(AlertVerdict::kFar), 1);  // 29 m off is not in the zone
    EXPECT_EQ(scores.Num(AlertVerdict::kRepeated), 1);
  }
  {
    Situation run;  // the same alert that comes up again
    run.Scan({thing}, {Approach(1, {0.0, 30.0})});
    run.Scans(20, {thing}, {});
    run.Scan({thing}, {Approach(1, {0.0, 30.0})});
    EXPECT_EQ(run.Scores().Num(AlertVerdict::kRepeated), 1);
  }
  {
    Situation run;  // of another thing
    run.Scan({thing, Thing(2, {0.0, 50.0})}, {Approach(1, {0.0, 30.0}), Approach(2, {0.0, 50.0})});
    EXPECT_EQ(run.Scores().Num(AlertVerdict::kRight), 2);
  }
}

TEST(AlertVerdicts, OfOneShoreASecondAlertIsNewsOnlyMuchNearerOrOnAnotherSide) {
  const auto verdicts_after = [](const JudgedAlert& second) {
    Situation run;
    // A bay: land ahead and to starboard, in two pieces that belong together.
    auto ahead = Land(1, {0.0, 45.0}, 30.0);
    auto aside = Land(2, {22.0, 15.0}, 28.0);
    aside.group = 1;
    run.Scan({ahead, aside}, {OfNoTrack(1, false, 29.0, 0.0)});
    run.Scan({ahead, aside}, {OfNoTrack(1, false, 29.0, 0.0), second});
    return run.Scores();
  };
  EXPECT_EQ(verdicts_after(OfNoTrack(2, false, 27.0, 10.0)).Num(AlertVerdict::kRepeated), 1);
  EXPECT_EQ(verdicts_after(OfNoTrack(2, false, 14.0, 40.0)).Num(AlertVerdict::kRepeated), 0);  // nearer than half
  EXPECT_EQ(verdicts_after(OfNoTrack(2, true, 8.1, 80.0)).Num(AlertVerdict::kRepeated), 0);    // another side
}

AlertFault TheFault(const AlertThing& thing, const Vector2d& told_mps, double told_side_m, double east_m = 0.0) {
  Situation run;
  auto alert = Approach(1, {east_m, 30.0});
  alert.track->outline_m = SquareAt({east_m, 30.0}, told_side_m);
  alert.track->velocity_mps = told_mps;
  run.Scan({thing}, {alert});
  return run.Scores().events.front().fault;
}

TEST(AlertFaults, TellWhatWasBelievedAgainstTheTruth) {
  const auto quay = Land(1, {30.0, 30.0}, 40.0);  // passes 9 m off
  const auto moored = Thing(1, {20.0, 30.0}), passing = Thing(1, {20.0, 30.0}, {2.0, 0.0});
  EXPECT_EQ(TheFault(quay, {-2.0, 0.0}, 2.0, 12.0), AlertFault::kPieceMoves);
  EXPECT_EQ(TheFault(moored, {-2.0, 0.0}, 2.0, 20.0), AlertFault::kStandingMoves);
  EXPECT_EQ(TheFault(passing, {0.0, 0.0}, 2.0, 20.0), AlertFault::kOtherCourse);
  EXPECT_EQ(TheFault(passing, {1.9, 0.0}, 2.0, 20.0), AlertFault::kTooNear);
  EXPECT_EQ(TheFault(moored, {0.0, 0.0}, 2.0), AlertFault::kNothingThere);
  EXPECT_EQ(TheFault(Thing(1, {0.0, 30.0}), {0.0, 0.0}, 2.0), AlertFault::kNone) << "right";
}

TEST(AlertFaults, OfWhatIsRepeatedTellWhetherTheOtherAlertHolds) {
  for (const bool holds : {true, false}) {
    Situation run;
    const auto thing = Thing(1, {0.0, 30.0});
    run.Scans(10, {thing}, {Approach(1, {0.0, 30.0})});
    if (!holds) run.Scans(20, {thing}, {});
    std::vector<JudgedAlert> alerts{Approach(2, {0.5, 30.0})};
    if (holds) alerts.push_back(Approach(1, {0.0, 30.0}));
    run.Scan({thing}, alerts);
    const auto scores = run.Scores();
    EXPECT_EQ(scores.Num(AlertVerdict::kRepeated, AlertFault::kTwoTracks), holds ? 1 : 0);
    EXPECT_EQ(scores.Num(AlertVerdict::kRepeated, AlertFault::kToldAgain), holds ? 0 : 1);
  }
}

TEST(AlertSound, IsWhatAlertsLetRing) {
  Situation run;
  auto alert = Approach(1, {0.0, 30.0});
  alert.is_warning = alert.sounds = true;
  run.Scans(11, {Thing(1, {0.0, 30.0})}, {alert});
  alert.sounds = false;
  run.Scans(10, {Thing(1, {0.0, 30.0})}, {alert});
  const auto scores = run.Scores();
  EXPECT_NEAR(scores.sounding_s, 1.0, 1e-6);
  EXPECT_NEAR(scores.warning_sounding_s, 1.0, 1e-6);
  EXPECT_NEAR(scores.sound_s, 2.0, 1e-6);
}

TEST(AlertLevels, AreTheGraverThatTheAlertHad) {
  Situation run;
  const auto thing = Thing(1, {0.0, 30.0});
  auto alert = Approach(1, {0.0, 30.0});
  run.Scan({thing}, {alert});
  alert.is_warning = true;
  run.Scan({thing}, {alert});
  alert.is_warning = false;
  run.Scan({thing}, {alert});
  const auto scores = run.Scores();
  EXPECT_EQ(scores.Num(AlertVerdict::kRight, true), 1);
  EXPECT_EQ(scores.Num(AlertVerdict::kRight, false), 0);
}

// Where an alert of the thing holds from some scan on.
AlertScores ScoresOfDanger(int num_scans, int told_from, const AlertThing& thing, double speed_mps = 2.0) {
  Situation run;
  run.speed_mps = speed_mps;
  for (int n = 0; n < num_scans; ++n) {
    std::vector<JudgedAlert> alerts;
    if (n >= told_from) alerts.push_back(Approach(1, thing.outline_m->box_m().center()));
    run.Scan({thing}, alerts);
  }
  return run.Scores();
}

TEST(Dangers, AreToldInTimeLateOrNever) {
  const auto near = Thing(1, {0.0, 20.0});  // nearer than the limit in 6.5 s
  const auto in_time = ScoresOfDanger(100, 5, near);
  EXPECT_EQ(in_time.Num(DangerVerdict::kInTime), 1);
  EXPECT_NEAR(in_time.delay_s.Median(), 0.5, 1e-9);
  EXPECT_EQ(ScoresOfDanger(100, 30, near).Num(DangerVerdict::kInTime), 1);
  EXPECT_EQ(ScoresOfDanger(100, 31, near).Num(DangerVerdict::kLate), 1);
  const auto missed = ScoresOfDanger(100, 1000, near);
  EXPECT_EQ(missed.Num(DangerVerdict::kMissed), 1);
  EXPECT_TRUE(std::isinf(missed.delay_s.Median()));
}

TEST(Dangers, ToldWithTimeToActAreToldInTime) {
  const auto distant = Thing(1, {0.0, 50.0});  // nearer than the limit in 21.5 s
  const auto scores = ScoresOfDanger(100, 60, distant);
  EXPECT_EQ(scores.Num(DangerVerdict::kInTime), 1);
  EXPECT_NEAR(scores.delay_s.Median(), 6.0, 1e-9);
}

TEST(Dangers, NeedReturnsLengthAndDistance) {
  auto few = Thing(1, {0.0, 20.0});
  few.num_returns = 4;
  EXPECT_EQ(ScoresOfDanger(100, 1000, few).NumDangers(), 0);
  EXPECT_EQ(ScoresOfDanger(20, 1000, Thing(1, {0.0, 20.0})).NumDangers(), 0);       // 1.9 s
  EXPECT_EQ(ScoresOfDanger(100, 1000, Thing(1, {6.1, 20.0})).NumDangers(), 0);      // passes at 4.1 m
  EXPECT_EQ(ScoresOfDanger(100, 1000, Thing(1, {5.9, 20.0})).NumDangers(), 1);      // at 3.9 m
  EXPECT_EQ(ScoresOfDanger(100, 1000, Thing(1, {3.0, 0.0}), 0.0).NumDangers(), 0);  // both stand
}

TEST(Dangers, AnAlertFromBeforeHasNoDelay) {
  Situation run;
  auto thing = Thing(1, {0.0, 30.0});
  thing.num_returns = 3;
  run.Scans(10, {thing}, {Approach(1, {0.0, 30.0})});
  thing.num_returns = 5;
  run.Scans(40, {thing}, {Approach(1, {0.0, 30.0})});
  const auto scores = run.Scores();
  EXPECT_EQ(scores.Num(DangerVerdict::kInTime), 1);
  EXPECT_DOUBLE_EQ(scores.delay_s.Median(), 0.0);
}

TEST(Dangers, OfOneThingWithin10sAreOne) {
  for (const int num_scans_between : {90, 110}) {
    Situation run;
    const auto near = Thing(1, {0.0, 20.0});
    run.Scans(30, {near}, {});
    run.Scans(num_scans_between, {Thing(1, {30.0, 20.0})}, {});
    run.Scans(40, {near}, {});
    EXPECT_EQ(run.Scores().Num(DangerVerdict::kMissed), num_scans_between < 100 ? 1 : 2);
  }
}

TEST(Dangers, AtTheEndOfARunAreLeftOpen) {
  const auto scores = ScoresOfDanger(28, 1000, Thing(1, {0.0, 20.0}));
  EXPECT_EQ(scores.NumDangers(), 0);
  EXPECT_EQ(scores.num_open_dangers, 1);
}

TEST(Dangers, OfLandAreToldByAnAlertOfTheSameShoreOnThatSide) {
  const auto score = [](double bearing_deg, double distance_m) {
    Situation run;
    auto ahead = Land(1, {0.0, 45.0}, 30.0);
    auto aside = Land(2, {-22.0, 15.0}, 28.0);
    aside.group = 1;
    run.Scans(50, {ahead, aside}, {OfNoTrack(1, false, distance_m, bearing_deg)});
    return run.Scores();
  };
  EXPECT_EQ(score(10.0, 29.0).Num(DangerVerdict::kInTime), 1);
  EXPECT_EQ(score(-80.0, 7.1).Num(DangerVerdict::kMissed), 1);  // tells of the other side alone
}

TEST(Dangers, ByTheTangentOfATurnAloneAreLeftOutAndCounted) {
  AlertJudge judge(Rules());
  for (int n = 0; n < 40; ++n) {
    AlertScan scan;
    scan.utime_us = n * kScanUs;
    scan.own.hull_m = SquareAt({0.0, 0.0});
    scan.own.motion = {{0.0, 2.0}, DegToRad(10.0)};
    scan.things = {Thing(1, {0.0, 40.0})};
    judge.Add(scan);
  }
  judge.Finish();
  EXPECT_EQ(judge.scores().NumDangers(), 0);
  EXPECT_EQ(judge.scores().num_turning_dangers, 1);
}

TEST(StandingAlerts, AreCountedWithTheirSound) {
  Situation run;
  const auto thing = Thing(1, {0.0, 30.0});
  auto warning = Zone(2, {0.0, 30.0});
  auto acknowledged = Approach(1, {0.0, 30.0});
  acknowledged.is_open = false;
  auto over = Approach(3, {0.0, 30.0});
  over.holds = false;
  over.is_open = false;
  run.Scan({thing}, {acknowledged, over});
  run.Scans(10, {thing}, {acknowledged, over});
  run.Scans(10, {thing}, {acknowledged, warning});
  const auto scores = run.Scores();
  EXPECT_EQ(scores.num_scans, 21);
  EXPECT_NEAR(scores.seconds, 2.0, 1e-9);
  EXPECT_NEAR(scores.sound_s, 1.0, 1e-9);
  EXPECT_NEAR(scores.warning_sound_s, 1.0, 1e-9);
  EXPECT_NEAR(scores.standing.value(), 31.0 / 21.0, 1e-9);
  EXPECT_EQ(scores.most_standing, 2);
  EXPECT_NEAR(scores.has_warning.value(), 10.0 / 21.0, 1e-9);
}

TEST(AlertJudge, ARunThroughAThingIsNotJudgedFurther) {
  Situation run;
  run.Scans(11, {Thing(1, {0.0, 30.0})}, {});
  run.Scans(20, {Thing(1, {0.0, 0.5})}, {Approach(1, {0.0, 0.5})});
  const auto scores = run.Scores();
  EXPECT_EQ(scores.NumAlerts(), 0);
  EXPECT_EQ(scores.num_scans, 11);
  EXPECT_NEAR(scores.run_in_s, 2.0, 1e-9);
}

}  // namespace
}  // namespace lookout::eval
