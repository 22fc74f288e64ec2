#include <cmath>
#include <gtest/gtest.h>

#include "lab/eval/tracks/track_metrics.hpp"
#include "tests/unit/eval_tracks/track_cases.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

constexpr int kNumScans = 50;

TEST(TrackMetrics, PerfectTracksScoreFull) {
  Case run;
  for (int n = 0; n < kNumScans; ++n) {
    run.Add({ThingAt(1, {0.0, 0.0}), ThingAt(2, {0.2 * n, 10.0}, 20, {2.0, 0.0})}, {TrackAt(7, {0.0, 0.0}), TrackAt(9, {0.2 * n, 10.0}, {2.0, 0.0})});
  }
  const auto scores = run.Score();
  EXPECT_DOUBLE_EQ(scores.Mota(), 1.0);
  EXPECT_DOUBLE_EQ(scores.Idf1(), 1.0);
  EXPECT_EQ(scores.num_expected, 2 * kNumScans);
  EXPECT_EQ(scores.num_switches, 0);
  EXPECT_EQ(scores.num_runs_without_switch, 1);
  EXPECT_DOUBLE_EQ(scores.seconds, 5.0);
  EXPECT_DOUBLE_EQ(scores.FalseTracksPerHour(), 0.0);
  EXPECT_DOUBLE_EQ(scores.gospa.Rms(), 0.0);
  EXPECT_DOUBLE_EQ(scores.position_nees.value(), 0.0);
  EXPECT_EQ(scores.num_standing, 1);
  EXPECT_EQ(scores.num_called_moving, 0);
  EXPECT_EQ(scores.speed_error_mps.count(), 20U);  // of 50 scans those from 3 s on
  EXPECT_DOUBLE_EQ(scores.course_error_deg.Max(), 0.0);
  EXPECT_DOUBLE_EQ(scores.confirmed_s[0].Max(), 0.0);
}

TEST(TrackMetrics, NobodyThereIsNoScore) {
  Case run;
  run.Add({}, {TrackAt(1, {0.0, 0.0})});
  const auto scores = run.Score();
  EXPECT_TRUE(std::isnan(scores.Mota()));
  EXPECT_TRUE(std::isnan(scores.Idf1()));
  EXPECT_EQ(scores.num_false_tracks, 1);
}

// Numbers worked out by hand: 50 scans with one thing; 5 without its track, and 45 in which its id changes once, after 25.
TEST(TrackMetrics, MissesAndASwitchCostWhatTheDefinitionsSay) {
  Case run;
  for (int n = 0; n < kNumScans; ++n) {
    std::vector<TrackState> tracks;
    if (n >= 5) tracks.push_back(TrackAt(n < 30 ? 1 : 2, {0.5, 0.0}));
    run.Add({ThingAt(1, {0.0, 0.0})}, tracks);
  }
  const auto scores = run.Score();
  EXPECT_EQ(scores.num_missed, 5);
  EXPECT_EQ(scores.num_false, 0);
  EXPECT_EQ(scores.num_switches, 1);
  EXPECT_EQ(scores.num_runs_without_switch, 0);
  EXPECT_DOUBLE_EQ(scores.Mota(), 1.0 - 6.0 / 50.0);
  ASSERT_EQ(scores.events.size(), 6U);
  EXPECT_EQ(scores.events.front().what, TrackEvent::What::kMissed);
  EXPECT_EQ(scores.events.back().what, TrackEvent::What::kSwitch);
  EXPECT_EQ(scores.events.back().utime_us, 30 * kScanUs);
  EXPECT_EQ(scores.events.back().track, 2);
  EXPECT_DOUBLE_EQ(scores.Idf1(), 2.0 * 25.0 / (50.0 + 45.0));
  EXPECT_DOUBLE_EQ(scores.confirmed_s[0].Median(), 0.5);
  EXPECT_DOUBLE_EQ(scores.position_nees.value(), 0.25 / 2.0);
}

TEST(TrackMetrics, ASecondTrackOfAThingIsFalse) {
  Case run;
  for (int n = 0; n < 10; ++n) run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {0.0, 0.0}), TrackAt(2, {1.0, 0.0})});
  const auto scores = run.Score();
  EXPECT_EQ(scores.num_false, 10);
  EXPECT_EQ(scores.num_false_tracks, 1);
  EXPECT_DOUBLE_EQ(scores.FalseTracksPerHour(), 3600.0);
  EXPECT_DOUBLE_EQ(scores.has_double.value(), 1.0);
  EXPECT_DOUBLE_EQ(scores.Mota(), 0.0);
}

TEST(TrackMetrics, TentativeAndLostTracksDoNotCount) {
  Case run;
  auto tentative = TrackAt(1, {50.0, 0.0});
  tentative.status = TrackStatus::kTentative;
  auto lost = TrackAt(2, {60.0, 0.0});
  lost.status = TrackStatus::kLost;
  run.Add({}, {tentative, lost});
  EXPECT_EQ(run.Score().num_false, 0);
}

TEST(TrackMetrics, WhatNeedNotBeTrackedCountsNeitherWay) {
  Case run;
  auto dock = ThingAt(2, {20.0, 0.0});
  dock.is_in_water = false;
  auto shore = ThingAt(3, {40.0, 0.0});
  shore.is_in_water = false;
  shore.is_land = true;
  // A buoy of 2 returns, a dock with two tracks, a shore with one; and another dock of which there is none.
  auto other_dock = ThingAt(4, {60.0, 0.0});
  other_dock.is_in_water = false;
  run.Add({ThingAt(1, {0.0, 0.0}, 2), dock, shore, other_dock},
          {TrackAt(1, {0.0, 0.0}), TrackAt(2, {20.0, 0.5}), TrackAt(3, {20.0, -0.5}), TrackAt(4, {42.5, 0.0})});
  const auto scores = run.Score();
  EXPECT_EQ(scores.num_expected, 0);
  EXPECT_EQ(scores.num_false, 0);
  EXPECT_EQ(scores.num_id_tracked, 0);
  EXPECT_EQ(scores.num_false_tracks, 0);
}

TEST(TrackMetrics, TheTrackOfADockIsNoHitOfTheBoatBesideIt) {
  Case run;
  auto dock = ThingAt(2, {0.0, 0.0});
  dock.is_in_water = false;
  run.Add({ThingAt(1, {3.0, 0.0}), dock}, {TrackAt(1, {0.0, 0.0})});  // 1 m from the boat
  EXPECT_EQ(run.Score().num_missed, 1);
}

TEST(TrackMetrics, TheGateIsBetweenHulls) {
  for (const double gap_m : {1.9, 2.1}) {
    Case run;
    run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {2.0 + gap_m, 0.0})});
    EXPECT_EQ(run.Score().num_missed, gap_m < kTrackGateM ? 0 : 1) << gap_m;
    EXPECT_EQ(run.Score().num_false, gap_m < kTrackGateM ? 0 : 1) << gap_m;
  }
}

// CLEAR MOT: a pair stays while it may, though another is nearer now.
TEST(TrackMetrics, APairStaysWithinTheGate) {
  Case run;
  run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {0.0, 0.0})});
  run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {3.0, 0.0}), TrackAt(2, {0.0, 0.0})});
  run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {9.0, 0.0}), TrackAt(2, {0.0, 0.0})});
  EXPECT_EQ(run.Score().num_switches, 1);
}

TEST(TrackMetrics, WhoIsWhoIsOptimalAndNotGreedy) {
  Case run;
  // The nearest pair of all is track 1 and thing 2; then thing 1 would be left with nobody.
  run.Add({ThingAt(1, {0.0, 0.0}), ThingAt(2, {6.0, 0.0})}, {TrackAt(1, {3.1, 0.0}), TrackAt(2, {9.5, 0.0})});
  EXPECT_EQ(run.Score().num_missed, 0);
}

TEST(TrackMetrics, ConfirmationCountsFromTheFirstReturnAndByHowMuchIsSeen) {
  Case run;
  for (int n = 0; n < kNumScans; ++n) {
    std::vector<TrackState> tracks;
    if (n >= 8) tracks.push_back(TrackAt(1, {0.0, 0.0}));
    if (n >= 25) tracks.push_back(TrackAt(2, {20.0, 0.0}));
    run.Add({ThingAt(1, {0.0, 0.0}, n < 3 ? 0 : 9), ThingAt(2, {20.0, 0.0}, 1), ThingAt(3, {40.0, 0.0}, 2), ThingAt(4, {60.0, 0.0}, 0)}, tracks);
  }
  const auto scores = run.Score();
  ASSERT_EQ(scores.confirmed_s[0].count(), 1U);
  EXPECT_DOUBLE_EQ(scores.confirmed_s[0].Max(), 0.5);
  ASSERT_EQ(scores.confirmed_s[1].count(), 2U);
  EXPECT_DOUBLE_EQ(scores.confirmed_s[1].Median(), 2.5);
  EXPECT_TRUE(std::isinf(scores.confirmed_s[1].Max()));  // never
}

TEST(TrackMetrics, FoundAgainWithTheSameIdOrNot) {
  for (const bool is_same : {true, false}) {
    Case run;
    for (int n = 0; n < kNumScans; ++n) {
      const bool is_hidden = n >= 10 && n < 30;
      std::vector<TrackState> tracks;
      if (!is_hidden) tracks.push_back(TrackAt(n < 30 || is_same ? 1 : 2, {0.0, 0.0}));
      run.Add({ThingAt(1, {0.0, 0.0}, is_hidden ? 0 : 20)}, tracks);
    }
    const auto scores = run.Score();
    EXPECT_EQ(scores.num_hidden, 1);
    EXPECT_EQ(scores.num_found_again, is_same ? 1 : 0);
    EXPECT_EQ(scores.num_switches, is_same ? 0 : 1);
    EXPECT_EQ(scores.num_missed, 0);  // what is hidden need not be tracked
  }
}

TEST(TrackMetrics, StandingThingsAndWhatIsSaidOfThem) {
  Case run;
  for (int n = 0; n < 10; ++n)
    run.Add({ThingAt(1, {0.0, 0.0}), ThingAt(2, {9.0, 0.0})}, {TrackAt(1, {0.0, 0.0}, {0.3, 0.4}), TrackAt(2, {9.0, 0.0})});
  const auto scores = run.Score();
  EXPECT_DOUBLE_EQ(scores.standing_speed_mps.value(), 0.25);
  EXPECT_EQ(scores.num_standing, 2);
  EXPECT_EQ(scores.num_called_moving, 1);
  ASSERT_EQ(scores.events.size(), 10U);
  EXPECT_EQ(scores.events.front().what, TrackEvent::What::kMoving);
  EXPECT_DOUBLE_EQ(scores.events.front().speed_mps, 0.5);
}

TEST(TrackMetrics, ErrorsOfSpeedCourseAndCentreAfterThreeSeconds) {
  Case run;
  for (int n = 0; n < kNumScans; ++n) {
    const Vector2d center_m(0.0, 0.2 * n);
    auto boat = ThingAt(1, center_m, 20, {0.0, 2.0});
    boat.outline_m = SquareAt(center_m, 4.0);
    const Vector2d stated_mps = n < 30 ? Vector2d(9.0, 9.0) : Vector2d(2.5 * std::sin(0.1), 2.5 * std::cos(0.1));
    run.Add({boat}, {TrackAt(1, center_m + Vector2d(0.0, 0.3), stated_mps)});
  }
  const auto scores = run.Score();
  EXPECT_NEAR(scores.speed_error_mps.Max(), 0.5, 1e-9);
  EXPECT_NEAR(scores.course_error_deg.Max(), 0.1 * 180.0 / 3.14159265, 1e-6);
  EXPECT_NEAR(scores.center_error_m.Max(), 0.3, 1e-9);
  EXPECT_DOUBLE_EQ(scores.called_standing.value(), 0.0);
}

TEST(TrackMetrics, ApproachIsComparedTenSecondsBefore) {
  Case run;
  for (int n = 0; n < 30; ++n) {
    // The boat comes from the east at 4 m/s, 20 m north of the own one; gaps of hulls: 18 m, and it is abeam when centres are.
    const Vector2d center_m(48.0 - 0.4 * n, 20.0);
    run.Add({ThingAt(1, center_m, 20, {-4.0, 0.0})}, {TrackAt(1, center_m, {-4.0, 0.4})});
    run.truth.back().own = TrueBoat{SquareAt({0.0, 0.0}), {0.0, 0.0}};
  }
  const auto scores = run.Score();
  EXPECT_EQ(scores.num_crossings, 1);
  EXPECT_EQ(scores.num_crossings_untracked, 0);
  // The stated path leads 0.4 m/s x 10 s farther off at the corner that passes.
  EXPECT_GT(scores.cpa_error_m.value(), 3.0);
  EXPECT_LT(scores.cpa_error_m.value(), 4.5);
  EXPECT_LT(scores.tcpa_error_s.value(), 1.0);
}

TEST(TrackMetrics, WhereEitherTurnsThereIsNoTrueApproach) {
  for (const bool own_turns : {true, false}) {
    SCOPED_TRACE(own_turns ? "own boat" : "the other");
    Case run;
    for (int n = 0; n < 30; ++n) {
      // By 3 deg/s.
      const double turned_rad = 0.1 * n * 3.0 / 57.3;
      const Vector2d turned(std::sin(turned_rad), std::cos(turned_rad));
      const Vector2d center_m(48.0 - 0.4 * n, 20.0);
      const Vector2d velocity_mps = own_turns ? Vector2d(-4.0, 0.0) : Vector2d(-4.0 * turned.y(), 4.0 * turned.x());
      run.Add({ThingAt(1, center_m, 20, velocity_mps)}, {TrackAt(1, center_m, velocity_mps)});
      run.truth.back().own = TrueBoat{SquareAt({0.0, 0.0}), own_turns ? Vector2d(0.1 * turned) : Vector2d(0.0, 0.0)};
    }
    const auto scores = run.Score();
    EXPECT_EQ(scores.num_crossings, 0);
    EXPECT_EQ(scores.num_crossings_turning, 1);
    EXPECT_EQ(scores.cpa_error_m.count, 0);
  }
}

TEST(TrackMetrics, StatedApproachCounts) {
  Case run;
  for (int n = 0; n < 30; ++n) {
    const Vector2d center_m(48.0 - 0.4 * n, 20.0);
    auto track = TrackAt(1, center_m, {-4.0, 0.0});
    track.cpa_m = 16.0;
    track.tcpa_s = 8.0;
    run.Add({ThingAt(1, center_m, 20, {-4.0, 0.0})}, {track});
    run.truth.back().own = TrueBoat{SquareAt({0.0, 0.0}), {0.0, 0.0}};
  }
  EXPECT_NEAR(run.Score().cpa_error_m.value(), 2.0, 1e-3);
}

TEST(TrackMetrics, WhatIsNoCovarianceIsCounted) {
  Case run;
  auto track = TrackAt(1, {0.0, 0.0});
  track.covariance.setZero();
  run.Add({ThingAt(1, {0.0, 0.0})}, {track});
  const auto scores = run.Score();
  EXPECT_EQ(scores.num_bad_covariances, 1);
  EXPECT_EQ(scores.position_nees.count, 0);
}

TEST(TrackMetrics, AFalseTrackIsOneOnNothingOrADouble) {
  Case run;
  for (int n = 0; n < 10; ++n) run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {0.0, 0.0}), TrackAt(2, {1.0, 0.0}), TrackAt(3, {30.0, 0.0})});
  const auto scores = run.Score();
  EXPECT_EQ(scores.num_false_tracks, 2);
  EXPECT_EQ(scores.num_double_tracks, 1);
  ASSERT_EQ(scores.events.size(), 20U);
  EXPECT_EQ(scores.events[1].nearest, 1);
  EXPECT_DOUBLE_EQ(scores.events[1].nearest_gap_m, 28.0);
}

TEST(TrackMetrics, DoublesAreCountedByScans) {
  Case run;
  for (int n = 0; n < 10; ++n) {
    std::vector<TrackState> tracks{TrackAt(1, {0.0, 0.0})};
    if (n < 3) tracks.push_back(TrackAt(2, {1.0, 0.0}));
    if (n < 5) tracks.push_back(TrackAt(3, {30.0, 0.0}));  // false, and no double
    run.Add({ThingAt(1, {0.0, 0.0})}, tracks);
  }
  EXPECT_DOUBLE_EQ(run.Score().has_double.value(), 0.3);
}

TEST(TrackMetrics, NumbersThatNobodySawAreWasted) {
  Case run;
  auto tentative = TrackAt(11, {50.0, 0.0});
  tentative.status = TrackStatus::kTentative;
  run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(2, {0.0, 0.0}), TrackAt(6, {30.0, 0.0}), tentative});
  EXPECT_DOUBLE_EQ(run.Score().IdsPerTrack(), 3.0);
  auto both = run.Score();
  Case other;
  other.Add({}, {TrackAt(2, {0.0, 0.0}), TrackAt(1, {30.0, 0.0})});
  both.Add(other.Score());
  EXPECT_DOUBLE_EQ(both.IdsPerTrack(), 2.0);
  EXPECT_TRUE(std::isnan(Case{}.Score().IdsPerTrack()));
}

TEST(TrackMetrics, TrajectoriesAreThoseOfTheThingsThatMustBeTracked) {
  Case run;
  for (int n = 0; n < 10; ++n) {
    run.Add({ThingAt(1, {0.0, 0.0}), ThingAt(2, {50.0, 0.0}, 2)}, {TrackAt(n < 5 ? 1 : 2, {0.6, 0.8}), TrackAt(3, {50.0, 0.0})});
  }
  const auto scores = run.Score();
  EXPECT_DOUBLE_EQ(scores.trajectory_gospa.num_switches, 1.0);
  EXPECT_EQ(scores.trajectory_gospa.scans.num_false, 0);
  EXPECT_DOUBLE_EQ(scores.trajectory_gospa.scans.LocalisationRms(), 1.0);
}

// A buoy that the boat comes near to at 2 m/s: it is within 25 m from scan 15 on (its outline reaches 1 m towards the boat).
TrackScores ScoreOfBuoy(int tracked_from, int num_returns, int num_scans = kNumScans) {
  Case run;
  for (int n = 0; n < num_scans; ++n) {
    auto buoy = ThingAt(1, {29.0 - 0.2 * n, 0.0}, num_returns);
    buoy.is_buoy = true;
    std::vector<TrackState> tracks;
    if (n >= tracked_from) tracks.push_back(TrackAt(1, buoy.position_m));
    run.Add({buoy}, tracks);
    run.truth.back().own = TrueBoat{SquareAt({0.0, 0.0}), {0.0, 0.0}};
  }
  return run.Score();
}

TEST(TrackMetrics, ABuoyThatComesNearIsTrackedInTimeOrNot) {
  EXPECT_DOUBLE_EQ(ScoreOfBuoy(0, 2).near_buoy_tracked.value(), 1.0);
  EXPECT_DOUBLE_EQ(ScoreOfBuoy(35, 2).near_buoy_tracked.value(), 1.0);
  EXPECT_DOUBLE_EQ(ScoreOfBuoy(37, 2).near_buoy_tracked.value(), 0.0);
  EXPECT_EQ(ScoreOfBuoy(kNumScans, 0).near_buoy_tracked.count, 0) << "not a return in that time";
  EXPECT_EQ(ScoreOfBuoy(kNumScans, 2, 30).near_buoy_tracked.count, 0) << "the run ends before";
  EXPECT_EQ(ScoreOfBuoy(kNumScans, 2, 10).near_buoy_tracked.count, 0) << "it never comes near";
}

// The own boat passes a moored one of 8 m x 2 m: one side of it, then its end, then the other side.
TEST(TrackMetrics, TheCentreCountsWhileNoMoreThanHalfWasSeen) {
  Case run;
  auto boat = ThingAt(1, {0.0, 0.0});
  boat.outline_m = {{-4.0, -1.0}, {4.0, -1.0}, {4.0, 1.0}, {-4.0, 1.0}};
  for (int n = 0; n < 100; ++n) {
    run.Add({boat}, {TrackAt(1, {n < 60 ? 0.3 : 0.1, 0.0})});
    const Vector2d own_m = n < 50 ? Vector2d(0.0, -20.0) : n < 80 ? Vector2d(20.0, -10.0) : Vector2d(20.0, 10.0);
    run.truth.back().own = TrueBoat{SquareAt(own_m), {0.0, 0.0}};
  }
  const auto scores = run.Score();
  EXPECT_EQ(scores.center_error_m.count(), 50U);  // from 3 s on, until the third side shows
  EXPECT_DOUBLE_EQ(scores.center_error_m.Median(), 0.3);
}

TEST(Calibration, IsTheDifferenceOfWhatWasStatedAndWhatCame) {
  Calibration calibration;
  EXPECT_TRUE(std::isnan(calibration.Error()));
  for (int n = 0; n < 10; ++n) calibration.Add(0.45, n < 4);
  for (int n = 0; n < 10; ++n) calibration.Add(1.0, n < 9);
  EXPECT_NEAR(calibration.Error(), (0.05 + 0.1) / 2.0, 1e-12);
  Calibration twice = calibration;
  twice.Add(calibration);
  EXPECT_EQ(twice.count(), 40);
  EXPECT_NEAR(twice.Error(), calibration.Error(), 1e-12);
}

// A boat comes from the east at 4 m/s and passes 2 m north of the own one after 15 s; the alert holds from `from` to `to`.
TrackScores ScoreOfPass(double from_s, double to_s) {
  Case run;
  std::vector<std::vector<StatedAlert>> alerts;
  for (int n = 0; n < 250; ++n) {
    const double time_s = 0.1 * n;
    const Vector2d center_m(60.0 - 4.0 * time_s, 4.0);
    auto track = TrackAt(7, center_m, {-4.0, 0.0});
    track.cpa_probability = 1.0;
    run.Add({ThingAt(1, center_m, 20, {-4.0, 0.0})}, {track});
    run.truth.back().own = TrueBoat{SquareAt({0.0, 0.0}), {0.0, 0.0}};
    alerts.emplace_back();
    if (time_s >= from_s && time_s < to_s) alerts.back().push_back({1, 7, true, true});
  }
  return ScoreTracks(run.truth, run.tracks, alerts);
}

TEST(TrackMetrics, WarningsAreTimedByThePass) {
  const auto scores = ScoreOfPass(5.0, 18.0);
  EXPECT_EQ(scores.num_alerts, 1);
  ASSERT_EQ(scores.warned_ahead_s.count(), 1U);
  // Nearest as soon as the hulls are abreast, half a second before the centres are.
  EXPECT_NEAR(scores.warned_ahead_s.Max(), 9.5, 0.11);
  // Farther than 5 m when the hulls are sqrt(25 - 4) m apart along the course: 1.65 s after the centres were abreast.
  EXPECT_NEAR(scores.warned_after_s.Max(), 18.0 - 16.65, 0.21);
  EXPECT_NEAR(static_cast<double>(scores.calibration.count()), 115.0, 1.0);  // 3 s after the first track until they are abreast
  EXPECT_EQ(scores.alerts_of_pass.Max(), 1.0);
  EXPECT_TRUE(std::isinf(ScoreOfPass(30.0, 31.0).warned_ahead_s.Max()));
  EXPECT_EQ(ScoreOfPass(30.0, 31.0).alerts_of_pass.Max(), 0.0);
  EXPECT_DOUBLE_EQ(ScoreOfPass(30.0, 31.0).warned_after_s.Max(), 0.0);
}

TEST(TrackMetrics, RunsAddUp) {
  Case run;
  for (int n = 0; n < 10; ++n) run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {0.0, 0.0}), TrackAt(2, {30.0, 0.0})});
  auto twice = run.Score();
  twice.Add(run.Score());
  EXPECT_DOUBLE_EQ(twice.Mota(), run.Score().Mota());
  EXPECT_DOUBLE_EQ(twice.Idf1(), run.Score().Idf1());
  EXPECT_DOUBLE_EQ(twice.gospa.Rms(), run.Score().gospa.Rms());
  EXPECT_DOUBLE_EQ(twice.FalseTracksPerHour(), run.Score().FalseTracksPerHour());
  EXPECT_DOUBLE_EQ(twice.hota.Value(), run.Score().hota.Value());
  EXPECT_DOUBLE_EQ(twice.trajectory_gospa.Rms(), run.Score().trajectory_gospa.Rms());
  EXPECT_DOUBLE_EQ(twice.IdsPerTrack(), run.Score().IdsPerTrack());
  EXPECT_EQ(twice.num_runs, 2);
}

}  // namespace
}  // namespace lookout::eval
