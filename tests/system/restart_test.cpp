// Every process of lookout-up killed with SIGKILL in turn: it comes back, data flows again, the others go on, and the logs tell the story.
// LOOKOUT_KILL_ROUNDS=5 kills each of them five times; without it once, as in CI.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/services.hpp"
#include "lookout/health_t.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/live_test.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

// In the order in which they are killed.
const std::vector<std::string> kVictims = bus::StartOrder();
// The promise is 2 s on a boat's computer that has nothing else to do; tests run on busy ones.
constexpr milliseconds kMostUntilDataFlows(2000);
constexpr int kBusyComputer = 5;

int NumRounds() {
  const char* text = std::getenv("LOOKOUT_KILL_ROUNDS");
  return text == nullptr ? 1 : std::max(1, std::atoi(text));
}

// What the bus says of all processes.
class Watch {
 public:
  Watch() : bus_(bus::DefaultLcmUrl()) {
    bus_.SubscribeRaw(bus::kHealth, [this](std::string_view, Bytes bytes) {
      if (const auto message = bus::Decode<health_t>(bytes)) {
        health_[message->process] = *message;
        pids_[message->process].insert(message->pid);
      }
    });
    for (const auto* channel : {&bus::kLidarScan, &bus::kSegments, &bus::kLidarOdometry, &bus::kPose, &bus::kObstacles, &bus::kAlerts}) {
      bus_.SubscribeRaw(*channel, [](std::string_view, Bytes) {});
    }
  }

  /// Handles messages until `is_reached`, at most so long.
  template <typename Condition>
  bool Until(const Condition& is_reached, milliseconds most) {
    return HandleUntil(bus_, is_reached, most);
  }

  std::int64_t Count(const bus::Channel& channel) { return bus_.input_traffic()[std::string(channel.name)].num_messages; }
  const health_t& Health(const std::string& process) { return health_[process]; }
  std::size_t NumPids(const std::string& process) { return pids_[process].size(); }

 private:
  bus::LcmBus bus_;
  std::map<std::string, health_t> health_;
  std::map<std::string, std::set<std::int32_t>> pids_;
};

// The channel by which a process shows that it works again; the recorder shows it by a log, page and plotter by their HEALTH alone.
const bus::Channel& OutputOf(const std::string& process) {
  static const std::map<std::string, const bus::Channel*> kOutputs{{"recorder", &bus::kObstacles}, {"page", &bus::kHealth},
                                                                   {"plotter", &bus::kHealth},     {"ais", &bus::kHealth},
                                                                   {"tracker", &bus::kAlerts},     {"georeferencer", &bus::kObstacles},
                                                                   {"segmenter", &bus::kSegments}, {"odometer", &bus::kLidarOdometry},
                                                                   {"navigator", &bus::kPose},     {"lidar", &bus::kLidarScan}};
  return *kOutputs.at(process);
}

// Logs that hold more than what a recorder writes at its start.
std::size_t NumLogsWithData(const fs::path& folder) {
  constexpr std::uintmax_t kMoreThanRunInfo = 100'000;
  std::size_t number = 0;
  for (const auto& entry : fs::directory_iterator(folder)) number += fs::file_size(entry.path()) > kMoreThanRunInfo ? 1 : 0;
  return number;
}

class Restart : public LiveTest {
 protected:
  std::size_t num_logs_ = 1;
};

TEST_F(Restart, AProcessThatIsKilledComesBackAndTheOthersGoOn) {
  Watch watch;
  Child up({Bin("up"), "--config", (folder_ / "config").string()}, Output("up"));
  const auto all_report = [&] { return std::ranges::all_of(kVictims, [&](const auto& name) { return watch.NumPids(name) > 0; }); };
  ASSERT_TRUE(watch.Until(all_report, seconds(30))) << up.Output();
  // Longer than is needed; ended with the test.
  Child sim({Bin("sim"), "--config", (folder_ / "config").string(), "--scene", "lake", "--seed", "3", "--seconds", "600", "--udp", "127.0.0.1"},
            Output("sim"));
  ASSERT_TRUE(watch.Until([&] { return watch.Count(bus::kObstacles) > 5; }, seconds(30))) << up.Output() << sim.Output();

  for (int round = 0; round < NumRounds(); ++round) {
    for (const auto& victim : kVictims) {
      std::map<std::string, std::int32_t> pids;
      for (const auto& name : kVictims) pids[name] = watch.Health(name).pid;
      const auto& output = OutputOf(victim);
      // Else this round would take the log of the round before for the new one.
      ASSERT_TRUE(watch.Until([&] { return NumLogsWithData("logs") == num_logs_; }, seconds(20)));
      if (victim == "recorder") ++num_logs_;
      const auto killed = Clock::now();
      ASSERT_EQ(kill(pids[victim], SIGKILL), 0) << victim;
      // What it had still sent is not counted: the kernel delivers that at once.
      watch.Until([] { return false; }, milliseconds(50));
      const auto own = watch.Count(output);
      const auto obstacles = watch.Count(bus::kObstacles);
      const auto flows = [&] {
        return watch.Count(output) > own && watch.Count(bus::kObstacles) > obstacles && NumLogsWithData("logs") == num_logs_;
      };
      ASSERT_TRUE(watch.Until(flows, kBusyComputer * kMostUntilDataFlows)) << victim << " does not come back: " << up.Output();
      const auto took = std::chrono::duration_cast<milliseconds>(Clock::now() - killed);
      std::printf("%-14s killed: data flows again after %4d ms\n", victim.c_str(), static_cast<int>(took.count()));
      // Its HEALTH is that of another process, which began anew; the others' are the same as before.
      ASSERT_TRUE(watch.Until([&] { return watch.Health(victim).pid != pids[victim]; }, seconds(20))) << victim;
      EXPECT_LT(watch.Health(victim).uptime_s, 10.0) << victim;
      const auto seq = watch.Health(victim).seq;
      EXPECT_LT(seq, 10) << victim;
      for (const auto& name : kVictims) {
        if (name == victim) continue;
        EXPECT_EQ(watch.Health(name).pid, pids[name]) << name << " did not live through the end of " << victim;
      }
    }
  }
  for (const auto& name : kVictims) EXPECT_EQ(watch.NumPids(name), 1U + static_cast<std::size_t>(NumRounds())) << name;

  // So fast is it that no turn may have been lost. Killed again as soon as it is up, it waits longer: turns that nobody segments are counted.
  const auto num_lost_segments = [&] {
    std::int64_t num_lost = 0;
    for (const auto& channel : watch.Health("georeferencer").channels) {
      if (channel.is_input != 0 && channel.channel == "SEGMENTS") num_lost = channel.num_lost;
    }
    return num_lost;
  };
  constexpr int kMostKills = 10;
  for (int i = 0; i < kMostKills && num_lost_segments() == 0; ++i) {
    const auto pid = watch.Health("segmenter").pid;
    ASSERT_EQ(kill(pid, SIGKILL), 0);
    ASSERT_TRUE(watch.Until([&] { return watch.Health("segmenter").pid != pid; }, seconds(30)));
    const auto seq = watch.Health("georeferencer").seq;
    ASSERT_TRUE(watch.Until([&] { return watch.Health("georeferencer").seq > seq; }, seconds(20)));
  }
  EXPECT_GT(num_lost_segments(), 0);
  std::printf("turns that no segmenter was there for, as the georeferencer counts: %d\n", static_cast<int>(num_lost_segments()));
  (SIGTERM);
  // As Ctrl-C in a terminal does.
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(seconds(30)).value_or(-1), 0) << up.Output();

  // The logs: one for each life of the recorder. All are readable; of those that were cut off by a kill at most the last event is damaged.
  std::size_t num_logs = 0;
  std::int64_t num_obstacles = 0;
  std::map<std::string, std::set<std::int32_t>> pids_in_logs;
  for (const auto& entry : fs::directory_iterator(folder_ / "logs")) {
    ++num_logs;
    bus::LogReader reader(entry.path());
    std::int64_t num_events = 0;
    while (const auto event = reader.Next()) {
      if (num_events++ == 0) {
        EXPECT_EQ(event->channel, "RUN_INFO") << entry.path();
      }
      if (event->channel == "OBSTACLES") ++num_obstacles;
      if (event->channel != "HEALTH") continue;
      const auto message = bus::Decode<health_t>(event->bytes);
      ASSERT_TRUE(message);
      pids_in_logs[message->process].insert(message->pid);
    }
    EXPECT_LE(reader.num_damaged(), 1) << entry.path();
    EXPECT_GT(num_events, 10) << entry.path();
  }
  EXPECT_EQ(num_logs, 1U + static_cast<std::size_t>(NumRounds()));
  EXPECT_GT(num_obstacles, 10);
  // Each life of each process is told.
  for (const auto& name : kVictims) EXPECT_EQ(pids_in_logs[name].size(), watch.NumPids(name)) << name;
  for (const auto& entry : fs::directory_iterator(fs::temp_directory_path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("lookout-up.")) << entry.path() << " is left behind";
  }
}

}  // namespace
}  // namespace lookout::system_test
