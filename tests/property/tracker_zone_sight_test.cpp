// Whether anybody looks into the guard zone, behind the whole chain: the field of view of the lidar itself, on simulated water; and no word of it
// where a lidar looks all round, in our scenes and in captures of another simulator.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <set>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/config/boat.hpp"
#include "lab/eval/methods/captures.hpp"
#include "lab/eval/tracks/track_sources.hpp"
#include "lab/sim/scene_file.hpp"
#include "lab/sim/simulation.hpp"
#include "lookout/alerts_t.hpp"
#include "tests/support/files.hpp"
#include "tools/replay/chain.hpp"

namespace lookout {
namespace {

constexpr Utime kStart{std::chrono::seconds(1'781'532'600)};
constexpr const char* kAllRound = "guard_zone { range_m: 30 }\n";

// What ALERTS of a run say of the look-out into the zone.
struct Told {
  std::set<std::string> texts;
  std::set<std::int64_t> ids;
  std::int64_t num_messages = 0;

  void Add(std::string_view channel, Bytes bytes) {
    if (channel != bus::kAlerts.name) return;
    ++num_messages;
    const auto message = bus::Decode<alerts_t>(bytes).value();
    for (const auto& alert : message.alerts) {
      if (alert.cause != alert_t::CAUSE_WATCH) continue;
      texts.insert(alert.text);
      ids.insert(alert.id);
    }
  }
  std::string Text() const { return texts.empty() ? "" : *texts.begin(); }
};

Told Simulate(const std::string& scene_name, const std::filesystem::path& config, const Sector& field_of_view, double seconds) {
  const auto boat = config::LoadBoat(config);
  const auto scene = sim::ParseScene(support::ReadFile(support::kSources / "config/scenes" / (scene_name + ".txtpb")), scene_name, 931);
  sim::SimulationParams simulated;
  simulated.lidar.field_of_view = field_of_view;
  simulated.start = kStart;
  simulated.duration = std::chrono::microseconds(std::llround(seconds * 1e6));
  simulated.seed = 931;
  sim::Simulation simulation(scene, boat, simulated, nullptr);
  Told told;
  replay::Chain chain(config, {}, [&told](Utime, std::string_view channel, Bytes bytes) { told.Add(channel, bytes); });
  while (const auto datagram = simulation.Next()) chain.OnDatagram({datagram->time, datagram->port, datagram->payload});
  chain.Finish();
  return told;
}

class ZoneSightOfTheChain : public ::testing::Test {
 protected:
  ZoneSightOfTheChain() { std::filesystem::copy(support::kDemoConfig, config_, std::filesystem::copy_options::recursive); }

  support::TempDir folder_;
  std::filesystem::path config_ = folder_ / "config";
};

// 90 to 270 deg set on the lidar's own page, the zone ahead: ALERTS and HEALTH said nothing.
TEST_F(ZoneSightOfTheChain, SaysWhereTheLidarDoesNotFire) {
  const Sector astern{DegToRad(90.0), DegToRad(180.0)};
  auto told = Simulate("open_water", config_, astern, 5.0);
  EXPECT_EQ(told.Text(), "no look-out in the whole guard zone: 300 to 60 deg (the lidar does not fire there)");
  EXPECT_EQ(told.ids.size(), 1U);
  // Here the lidar is turned by 5 deg to port, and stands 0.5 m before the reference point.
  support::WriteFile(config_ / "tracker.txtpb", kAllRound);
  told = Simulate("open_water", config_, astern, 5.0);
  EXPECT_EQ(told.ids.size(), 1U);
  EXPECT_NE(told.Text().find("part of the guard zone: 266 to 84 deg (the lidar does not fire there)"), std::string::npos) << told.Text();
}

TEST_F(ZoneSightOfTheChain, IsSilentWhereTheLidarLooksAllRound) {
  support::WriteFile(config_ / "tracker.txtpb", kAllRound);
  for (const auto* scene : {"open_water", "lake", "rain", "marina"}) {
    const auto told = Simulate(scene, config_, Sector{}, 5.0);
    EXPECT_GT(told.num_messages, 40) << scene;
    EXPECT_EQ(told.Text(), "") << scene;
  }
}

// With a thin mast 1.3 m behind the lidar, which hides 2 deg.
TEST(ZoneSightOfCaptures, IsSilentInAnotherWorld) {
  const auto folder = support::kRecordings / "second_world";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const eval::ConfigOfCaptures config(folder, support::kCatabotConfig);
  support::WriteFile(config.path() / "tracker.txtpb", kAllRound);
  const auto boat = config::LoadBoat(config.path());
  int num_runs = 0;
  for (const auto& files : eval::ListCaptures(folder)) {
    if (files.seed != 11) continue;
    Told told;
    eval::Truth truth(eval::kCaptureToleranceUs);
    replay::Chain chain(config.path(), {}, [&told](Utime, std::string_view channel, Bytes bytes) { told.Add(channel, bytes); });
    eval::ReadRun(files, boat, truth, [&chain](const replay::Datagram& datagram) { chain.OnDatagram(datagram); });
    chain.Finish();
    EXPECT_GT(told.num_messages, 20) << files.scene;
    EXPECT_EQ(told.Text(), "") << files.scene;
    ++num_runs;
  }
  EXPECT_GT(num_runs, 5);
}

}  // namespace
}  // namespace lookout
