// HOTA by hand. One thing of 2 m and tracks of 2 m: two centres that are 2 m + g apart have a gap of g.
#include "lab/eval/tracks/hota.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit/eval_tracks/track_cases.hpp"

namespace lookout::eval {
namespace {

constexpr int kNumHotaScans = 10;

Hota HotaOfCase(const Case& run) { return run.Score().hota; }

TEST(Hota, SimilarityFallsToNothingAtTheGate) {
  EXPECT_DOUBLE_EQ(SimilarityOf(0.0), 1.0);
  EXPECT_DOUBLE_EQ(SimilarityOf(0.5), 0.75);
  EXPECT_DOUBLE_EQ(SimilarityOf(kTrackGateM), 0.0);
  EXPECT_DOUBLE_EQ(SimilarityOf(9.0), 0.0);
}

TEST(Hota, OfPerfectTracksIsOne) {
  Case run;
  for (int n = 0; n < kNumHotaScans; ++n)
    run.Add({ThingAt(1, {0.0, 0.0}), ThingAt(2, {20.0, 0.0})}, {TrackAt(7, {0.0, 0.0}), TrackAt(9, {20.0, 0.0})});
  const auto hota = HotaOfCase(run);
  EXPECT_DOUBLE_EQ(hota.Value(), 1.0);
  EXPECT_DOUBLE_EQ(hota.Detection(), 1.0);
  EXPECT_DOUBLE_EQ(hota.Association(), 1.0);
}

TEST(Hota, OfNobodyIsNone) {
  Case run;
  run.Add({}, {});
  EXPECT_TRUE(std::isnan(HotaOfCase(run).Value()));
}

// All 10 scans are found, in halves by two tracks: each pair is together in 5 of the 10 scans in which one of the two is there.
TEST(Hota, ASwitchInTheMiddleHalvesTheAssociation) {
  Case run;
  for (int n = 0; n < kNumHotaScans; ++n) run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(n < 5 ? 1 : 2, {0.0, 0.0})});
  const auto hota = HotaOfCase(run);
  EXPECT_DOUBLE_EQ(hota.Detection(), 1.0);
  EXPECT_DOUBLE_EQ(hota.Association(), 0.5);
  EXPECT_DOUBLE_EQ(hota.Value(), std::sqrt(0.5));
}

// Found in 5 of 10 scans, with a false track in 2: 5 pairs of 5 + 5 missed + 2 false; the pair is together in 5 of 10.
TEST(Hota, MissesCostDetectionAndAssociation) {
  Case run;
  for (int n = 0; n < kNumHotaScans; ++n) {
    std::vector<TrackState> tracks;
    if (n < 5) tracks.push_back(TrackAt(1, {0.0, 0.0}));
    if (n >= 8) tracks.push_back(TrackAt(2, {50.0, 0.0}));
    run.Add({ThingAt(1, {0.0, 0.0})}, tracks);
  }
  const auto hota = HotaOfCase(run);
  EXPECT_DOUBLE_EQ(hota.Detection(), 5.0 / 12.0);
  EXPECT_DOUBLE_EQ(hota.Association(), 0.5);
}

// A gap of 1 m is a similarity of 0.5: a pair at 10 of the 19 thresholds.
TEST(Hota, AGapCostsTheThresholdsAboveIt) {
  Case run;
  for (int n = 0; n < kNumHotaScans; ++n) run.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {3.0, 0.0})});
  const auto hota = HotaOfCase(run);
  EXPECT_DOUBLE_EQ(hota.Value(), 10.0 / 19.0);
  EXPECT_EQ(hota.at[9].num_pairs, kNumHotaScans);
  EXPECT_EQ(hota.at[10].num_pairs, 0);
}

// A double in one scan takes the thing from nobody: the track that has it for long keeps it, although the other is first in the list.
TEST(Hota, PairsThatAreTogetherForLongArePreferred) {
  Case run;
  for (int n = 0; n < kNumHotaScans; ++n) {
    std::vector<TrackState> tracks;
    if (n == 4) tracks.push_back(TrackAt(1, {0.0, 0.0}));
    tracks.push_back(TrackAt(2, {0.5, 0.0}));
    run.Add({ThingAt(1, {0.0, 0.0})}, tracks);
  }
  const auto hota = HotaOfCase(run);
  EXPECT_DOUBLE_EQ(hota.Association(), 1.0);
  EXPECT_DOUBLE_EQ(hota.Detection(), 10.0 / 11.0);
}

TEST(Hota, WhatNeedNotBeTrackedCountsNeitherWay) {
  Case run;
  auto dock = ThingAt(2, {20.0, 0.0});
  dock.is_in_water = false;
  run.Add({ThingAt(1, {0.0, 0.0}, 2), dock}, {TrackAt(1, {0.0, 0.0}), TrackAt(2, {20.0, 0.5}), TrackAt(3, {20.0, -0.5})});
  const auto hota = HotaOfCase(run);
  EXPECT_EQ(hota.num_true, 0);
  EXPECT_EQ(hota.num_tracked, 0);
}

TEST(Hota, RunsAddUpInCounts) {
  Case found;
  Case missed;
  for (int n = 0; n < kNumHotaScans; ++n) {
    found.Add({ThingAt(1, {0.0, 0.0})}, {TrackAt(1, {0.0, 0.0})});
    missed.Add({ThingAt(1, {0.0, 0.0})}, {});
  }
  auto sum = HotaOfCase(found);
  sum.Add(HotaOfCase(missed));
  EXPECT_DOUBLE_EQ(sum.Detection(), 0.5);
  EXPECT_DOUBLE_EQ(sum.Association(), 1.0);
  EXPECT_DOUBLE_EQ(sum.Value(), std::sqrt(0.5));
}

}  // namespace
}  // namespace lookout::eval
