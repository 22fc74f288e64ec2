#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>

#include "lab/eval/tracks/track_autoferry.hpp"
#include "lab/eval/tracks/track_command.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval {
namespace {

using importer::FerryScan;
using importer::FerryTruth;

constexpr int kNumScans = 20;

// The ferry stands; a boat passes it, and another is 90 m off.
struct Passing {
  Passing() {
    for (int n = 0; n < kNumScans; ++n) {
      const std::int64_t utime_us = 1'000'000'000 + 500'000 * n;
      const Eigen::Vector2d near_m(20.0, 1.0 * n);
      scans.push_back({utime_us, {0.0, 0.0}, {near_m, {90.0, 0.0}}});
      // Truth is of other moments than scans.
      truth[1][utime_us + 100'000] = {20.0, 1.0 * n + 0.2};
      truth[2][utime_us - 100'000] = {90.0, 0.0};
      TrackState track;
      track.id = n < 10 ? 1 : 2;
      track.status = TrackStatus::kConfirmed;
      track.position_m = near_m + Eigen::Vector2d(3.0, 0.0);
      tracks.push_back({track});
    }
  }
  std::vector<FerryScan> scans;
  FerryTruth truth;
  std::vector<std::vector<TrackState>> tracks;
};

TEST(ScoreFerry, RangesAndSwitchesAreAsWorkedOutByHand) {
  const Passing passing;
  const auto scores = ScoreFerry(passing.scans, passing.truth, passing.tracks);
  // Within 50 m one truth, 3 m off; the first scan lies before the first place of its truth, by 0.2 m.
  EXPECT_NEAR(scores.gospa[0].Rms(), 3.0, 0.01);
  EXPECT_EQ(scores.gospa[0].num_missed, 0);
  EXPECT_EQ(scores.gospa[2].num_missed, kNumScans);  // the one at 90 m
  EXPECT_NEAR(scores.gospa[2].Rms(), std::sqrt(9.0 + 200.0), 0.01);
  EXPECT_EQ(scores.num_switches, 1);
  EXPECT_EQ(scores.with_boat[0].num_scans, kNumScans);
}

TEST(ScoreFerry, ScansWithoutABoatWithinTheRangeCountApart) {
  Passing passing;
  for (auto& [utime_us, place_m] : passing.truth[1]) {
    if (utime_us > 1'005'000'000) place_m = {60.0, 0.0};
  }
  for (auto& tracks : passing.tracks) tracks.clear();
  const auto scores = ScoreFerry(passing.scans, passing.truth, passing.tracks);
  EXPECT_GT(scores.with_boat[0].num_scans, 5);
  EXPECT_LT(scores.with_boat[0].num_scans, 15);
  EXPECT_EQ(scores.gospa[0].num_scans, kNumScans);
  EXPECT_NEAR(scores.with_boat[0].Rms(), std::sqrt(200.0), 1e-9);
  EXPECT_LT(scores.gospa[0].Rms(), scores.with_boat[0].Rms());
}

TEST(ScoreFerry, TentativeTracksDoNotCount) {
  Passing passing;
  for (auto& tracks : passing.tracks) tracks.front().status = TrackStatus::kTentative;
  EXPECT_EQ(ScoreFerry(passing.scans, passing.truth, passing.tracks).gospa[0].num_missed, kNumScans);
}

TEST(TrackFerry, APlainTrackerFollowsWhatPasses) {
  const Passing passing;
  const auto said = TrackFerry(support::kCatabotConfig, passing.scans, MakeTrackers());
  const auto plain = std::ranges::find(said, "nearest neighbour", &FerryTracks::tracker);
  ASSERT_NE(plain, said.end());
  const auto scores = ScoreFerry(passing.scans, passing.truth, plain->tracks);
  EXPECT_EQ(scores.num_switches, 0);
  EXPECT_EQ(scores.gospa[2].num_missed, 4);  // both, until they were seen three times
  EXPECT_EQ(scores.gospa[2].num_false, 0);
}

// Real detections. The bound is what a tracker with existence and optimal assignment, tuned by hand, has within 50 m, and half as much again.
TEST(TrackFerry, RealDetectionsOfOpenWater) {
  const auto folder = support::kRecordings / "autoferry";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  FerryScores sum;
  for (const int scenario : {2, 3, 4}) {
    const auto name = (folder / ("scenario" + std::to_string(scenario))).string();
    const auto scans = importer::ReadFerryScans(name + "_lidar_detections.json");
    const auto truth = importer::ReadFerryTruth(name + "_ground_truth.json");
    for (const auto& said : TrackFerry(support::kCatabotConfig, scans, MakeTrackers())) {
      if (said.tracker == "nearest neighbour") sum.Add(ScoreFerry(scans, truth, said.tracks));
    }
  }
  EXPECT_LT(sum.with_boat[0].Rms(), 1.5 * 7.4);
  EXPECT_GT(sum.gospa[0].Rms(), 1.0);
}

}  // namespace
}  // namespace lookout::eval
