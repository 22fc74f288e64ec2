// Obstacles of the whole chain (lidar, segmenter, navigator, georeferencer) against the centres of what was truly seen of them. Seeds:
// LOOKOUT_OBSTACLE_SEEDS, default 3; the table of services/georeferencer/README.md is printed by
//   LOOKOUT_OBSTACLE_SEEDS=20 build/release/tests/property_georeferencer_obstacles
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/config/boat.hpp"
#include "lab/eval/report/evaluation.hpp"
#include "lab/sim/simulation.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/sim/scenes.hpp"
#include "tools/replay/chain.hpp"

namespace lookout {
namespace {

const std::string kDemo = support::kDemoConfig.string();
constexpr Utime kStart{std::chrono::seconds(1'781'532'600)};
// Filters settle.
constexpr double kSettleS = 2.0;
constexpr double kSecondsPerRun = 12.0;

int NumSeeds() {
  const char* text = std::getenv("LOOKOUT_OBSTACLE_SEEDS");
  return text != nullptr ? std::max(std::atoi(text), 1) : 3;
}

double SecondsSinceStart(std::int64_t utime_us) { return static_cast<double>(utime_us - ToUtimeUs(kStart)) * 1e-6; }

// Messages of the turns of a run, which are held against the truth when that is whole.
struct Recording {
  std::vector<lidar_scan_t> scans;
  std::vector<segments_t> segments;
  std::vector<obstacles_t> obstacles;

  void Take(std::string_view channel, Bytes bytes) {
    if (channel == bus::kLidarScan.name) scans.push_back(bus::Decode<lidar_scan_t>(bytes).value());
    if (channel == bus::kSegments.name) segments.push_back(bus::Decode<segments_t>(bytes).value());
    if (channel == bus::kObstacles.name) obstacles.push_back(bus::Decode<obstacles_t>(bytes).value());
  }
};

// Obstacles of one run, after so many seconds.
std::vector<eval::SeenObstacle> Simulate(const std::string& scene_name, int seed, double seconds, const std::vector<std::string>& faults = {},
                                         double from_s = kSettleS) {
  const auto boat = config::LoadBoat(kDemo);
  const auto scene = sim::MakeScene(scene_name, static_cast<std::uint64_t>(seed));
  const support::TempDir folder;
  Recording recording;
  {
    sim::SimulationParams params;
    params.start = kStart;
    params.duration = std::chrono::microseconds(std::llround(seconds * 1e6));
    params.seed = static_cast<std::uint64_t>(seed);
    for (const auto& fault : faults) params.faults.push_back(sim::ParseTimedFault(fault));
    sim::TruthWriter truth(folder, scene, boat, params.start);
    sim::Simulation simulation(scene, boat, params, &truth);
    replay::Chain chain(kDemo, {}, [&](Utime, std::string_view channel, Bytes bytes) { recording.Take(channel, bytes); });
    while (const auto datagram = simulation.Next()) chain.OnDatagram({datagram->time, datagram->port, datagram->payload});
    chain.Finish();
    io::CommitAll(truth.Finish());
  }
  const eval::Truth truth(folder);
  eval::Evaluation evaluation(&truth, 1);
  evaluation.SetMounting(boat.T_vessel_lidar);
  int num_incomplete = 0;
  messages::ScanCollector collector([](const messages::ScanMessages& scan) { return messages::HasAllParts(scan.obstacles); },
                                    messages::ScanCollector::Order::kOfCompletion, 256,
                                    [&](const messages::ScanMessages& scan) {
                                      if (!messages::HasAllParts(scan.obstacles)) {
                                        num_incomplete += scan.obstacles.empty() ? 0 : 1;
                                      } else if (SecondsSinceStart(scan.utime_us) >= from_s) {
                                        evaluation.Add(scan);
                                      }
                                    });
  for (auto& message : recording.scans) EXPECT_TRUE(collector.Add(std::move(message)));
  for (auto& message : recording.segments) EXPECT_TRUE(collector.Add(std::move(message)));
  for (auto& message : recording.obstacles) EXPECT_TRUE(collector.Add(std::move(message)));
  collector.Finish();
  EXPECT_EQ(num_incomplete, 0);
  return evaluation.seen;
}

// What the promise is about: sure, in the water or on it, to 40 m. Tentative ones are a few returns or scattered ones: their centre is vague, and
// the segmenter says so. The outline of land depends on how far along the shore the lidar sees; its waterline counts.
bool IsMeant(const eval::SeenObstacle& obstacle) { return obstacle.is_sure && !obstacle.is_land && obstacle.range_m <= 40.0; }

void Print(const std::string& name, const eval::SeenSummary& summary) {
  if (summary.distance_m.count() == 0) return;
  std::printf("| %s | %zu | %.3f | %.3f | %.3f | %.3f | %.1f | %.2f |\n", name.c_str(), summary.distance_m.count(), summary.distance_m.Median(),
              summary.distance_m.Percentile(95), summary.distance_m.Max(), summary.stated_sd_m.Median(), 100.0 * summary.in_ellipse.value(),
              summary.nees.value());
}

class ObstaclesOf : public ::testing::TestWithParam<const char*> {};

TEST_P(ObstaclesOf, LieWhereTheyWereSeen) {
  std::vector<eval::SeenObstacle> seen;
  for (int seed = 1; seed <= NumSeeds(); ++seed) {
    const auto run = Simulate(GetParam(), seed, kSecondsPerRun);
    seen.insert(seen.end(), run.begin(), run.end());
  }
  const auto meant = Summarise(seen, IsMeant);
  ASSERT_GT(meant.distance_m.count(), 50U);
  std::printf("| obstacles | count | median m | 95 %% m | greatest m | stated m | in the ellipse %% | NEES |\n");
  Print(GetParam(), meant);
  Print("- fixed", Summarise(seen, [](const auto& obstacle) { return IsMeant(obstacle) && !obstacle.is_moving; }));
  Print("- moving", Summarise(seen, [](const auto& obstacle) { return IsMeant(obstacle) && obstacle.is_moving; }));
  for (const auto& [low_m, high_m] : {std::pair(0.0, 10.0), {10.0, 20.0}, {20.0, 40.0}}) {
    Print("- " + std::to_string(std::lround(low_m)) + " to " + std::to_string(std::lround(high_m)) + " m",
          Summarise(seen, [low = low_m, high = high_m](const auto& obstacle) {
            return IsMeant(obstacle) && obstacle.range_m > low && obstacle.range_m <= high;
          }));
  }
  Print("tentative", Summarise(seen, [](const auto& obstacle) { return !obstacle.is_sure && !obstacle.is_land && obstacle.range_m <= 40.0; }));
  Print("land", Summarise(seen, [](const auto& obstacle) { return obstacle.is_land && obstacle.range_m <= 40.0; }));
  EXPECT_LE(meant.distance_m.Median(), 0.10);
  EXPECT_LE(meant.distance_m.Percentile(95), 0.30);
  EXPECT_GE(meant.in_ellipse.value(), 0.90);
  EXPECT_LE(meant.in_ellipse.value(), 0.99);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ObstaclesOf, ::testing::Values("turning", "waves", "crossing"), [](const auto& scene) { return scene.param; });

// The first fix comes out of the lidar, a second old; obstacles were up to 1.06 m off by it, and said 0.07 m.
TEST(ObstaclesOfTheFirstTurns, AreNotSaidToBeBetterThanAnOldFix) {
  for (int seed = 1; seed <= NumSeeds(); ++seed) {
    const auto seen = Simulate("turning", seed, 1.5, {}, 0.0);
    ASSERT_GT(seen.size(), 20U);
    double worst = 0.0;
    for (const auto& obstacle : seen) {
      if (IsMeant(obstacle)) worst = std::max(worst, obstacle.error_m.norm() / obstacle.sd_m());
    }
    EXPECT_LT(worst, 4.5) << "stated deviations, seed " << seed;
  }
}

TEST(ObstaclesAfterAGnssGap, DoNotJumpByMoreThanWasStated) {
  constexpr double kGapEndS = 20.0;
  // POSE takes the first fix 0.1 s after the gap; 2 s later recovery is over.
  constexpr double kFirstFixS = 0.5;
  constexpr double kRecoveryS = 2.0;
  eval::Summary jumps_m;
  eval::Summary jump_sds;
  eval::Summary later_jump_sds;
  eval::Summary stated_m;
  for (int seed = 1; seed <= NumSeeds(); ++seed) {
    const auto seen = Simulate("crossing", seed, kGapEndS + 3.0, {"gnss_gap:12:20"});
    const auto between = [&](double from_s, double to_s) {
      return Summarise(seen, [from_s, to_s](const auto& obstacle) {
        const double time_s = SecondsSinceStart(obstacle.scan_utime_us) - kGapEndS;
        return IsMeant(obstacle) && time_s > from_s && time_s < to_s;
      });
    };
    const auto back = between(-0.25, kFirstFixS);
    const auto later = between(kFirstFixS - 0.1, kRecoveryS);
    ASSERT_GE(back.jump_m.count(), 2U) << "seed " << seed;
    jumps_m.Add(back.jump_m.Max());
    jump_sds.Add(back.jump_sds.Max());
    later_jump_sds.Add(later.jump_sds.Max());
    stated_m.Add(back.stated_sd_m.Max());
  }
  std::printf(
      "| GNSS gap of 8 s | greatest jump of a run at the first fix: median %.3f m, greatest %.3f m | over what was stated: median %.2f, greatest "
      "%.2f, "
      "later %.2f | stated %.3f m |\n",
      jumps_m.Median(), jumps_m.Max(), jump_sds.Median(), jump_sds.Max(), later_jump_sds.Max(), stated_m.Median());
  EXPECT_LE(jump_sds.Max(), 1.0);
  // What is stated is small again, and the noise of three obstacles or more is all that is left.
  EXPECT_LE(later_jump_sds.Max(), 1.5);
}

}  // namespace
}  // namespace lookout
