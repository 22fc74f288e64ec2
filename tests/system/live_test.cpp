// The boat's processes live on loopback LCM, in a network namespace of their own. Each test takes some seconds of real time.
#include "tests/support/live_test.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <random>
#include <ranges>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/services.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/segments_t.hpp"
#include "tests/support/live_bus.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

const std::vector<std::string> kServices = bus::StartOrder();

class Live : public LiveTest {
 protected:
  // All that `services` names, the lidar last so that nobody misses its start mark.
  void StartAll() {
    for (const auto& service : kServices) {
      if (service == "lidar" || service == "navigator") std::this_thread::sleep_for(milliseconds(700));
      Start(service);
    }
    std::this_thread::sleep_for(milliseconds(700));
    for (const auto& service : kServices) ASSERT_TRUE(children_[service]->IsRunning()) << children_[service]->Output();
  }

  void Simulate(int num_seconds) {
    const auto result = RunProgram({Bin("sim"), "--config", (folder_ / "config").string(), "--scene", "lake", "--seed", "3", "--seconds",
                                    std::to_string(num_seconds), "--udp", "127.0.0.1"},
                                   Output("sim"));
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }

  // Sources end first, so that what they send at their end still finds its takers.
  void StopAll() {
    for (const auto& service : kServices | std::views::reverse) {
      std::this_thread::sleep_for(milliseconds(300));
      EXPECT_EQ(children_[service]->Terminate().value_or(-1), 0) << service << ": " << children_[service]->Output();
    }
  }

  fs::path Log() const { return FirstLogIn(folder_ / "logs"); }

  // The last HEALTH of a process in a log.
  static health_t LastHealth(const Payloads& payloads, const std::string& process) {
    health_t last{};
    const auto found = payloads.find("HEALTH");
    if (found == payloads.end()) return last;
    for (const auto& bytes : found->second) {
      const auto message = bus::Decode<health_t>(bytes);
      if (message && message->process == process) last = *message;
    }
    return last;
  }
};

// Counts messages of a channel until there are so many more, at most for 30 s.
bool WaitFor(bus::LcmBus& bus, const bus::Channel& channel, std::int64_t num_more) {
  const auto count = [&] { return bus.input_traffic()[std::string(channel.name)].num_messages; };
  const auto goal = count() + num_more;
  return HandleUntil(bus, [&] { return count() >= goal; });
}

TEST_F(Live, AKilledSegmenterComesBackAndTheOthersGoOn) {
  StartAll();
  bus::LcmBus lcm(bus::DefaultLcmUrl());
  lcm.SubscribeRaw(bus::kLidarScan, [](std::string_view, Bytes) {});
  lcm.SubscribeRaw(bus::kSegments, [](std::string_view, Bytes) {});
  std::thread simulator([this] { Simulate(8); });
  EXPECT_TRUE(WaitFor(lcm, bus::kSegments, 10));
  children_["segmenter"]->Signal(SIGKILL);
  EXPECT_TRUE(WaitFor(lcm, bus::kLidarScan, 10));  // the lidar process does not mind
  Start("segmenter");
  EXPECT_TRUE(WaitFor(lcm, bus::kSegments, 10));
  simulator.join();
  std::this_thread::sleep_for(milliseconds(300));
  StopAll();
  const auto live = ReadLog(Log());
  EXPECT_GE(live.at("LIDAR_SCAN").size(), 78U);
  EXPECT_LT(live.at("SEGMENTS").size() + 5, live.at("LIDAR_SCAN").size());
  EXPECT_EQ(live.at("SEGMENTS").size(), live.at("OBSTACLES").size());
}

TEST_F(Live, AnUnpluggedLidarDegradesHealthAndRecovers) {
  StartAll();
  Simulate(2);
  std::this_thread::sleep_for(milliseconds(2500));
  Simulate(3);
  StopAll();
  std::vector<int> states;
  const auto live = ReadLog(Log());
  for (const auto& bytes : live.at("HEALTH")) {
    const auto message = bus::Decode<health_t>(bytes);
    if (message && message->process == "lidar" && (states.empty() || states.back() != message->state)) states.push_back(message->state);
  }
  // Fine while packets come, degraded while none do, fine again; on a slow computer degraded before and after as well.
  const std::vector<int> expected{health_t::STATE_OK, health_t::STATE_DEGRADED, health_t::STATE_OK};
  EXPECT_NE(std::ranges::search(states, expected).begin(), states.end()) << ::testing::PrintToString(states);
}

// A cable that is pulled takes the route with it: every send fails then. All processes used to end of that.
TEST_F(Live, ALostRouteEndsNoProcess) {
  StartAll();
  ASSERT_EQ(RunProgram({"ip", "route", "del", "239.255.76.0/24", "dev", "lo"}, Output("ip")).exit_code, 0);
  std::this_thread::sleep_for(milliseconds(2500));
  for (const auto& service : kServices) EXPECT_TRUE(children_[service]->IsRunning()) << service << ": " << children_[service]->Output();
  ASSERT_EQ(RunProgram({"ip", "route", "add", "239.255.76.0/24", "dev", "lo"}, Output("ip")).exit_code, 0);
  Simulate(2);
  std::this_thread::sleep_for(milliseconds(1200));
  StopAll();
  const auto live = ReadLog(Log());
  EXPECT_GE(live.at("OBSTACLES").size(), 15U);
  std::int64_t num_unsent = 0;
  for (const auto& counter : LastHealth(live, "navigator").counters) {
    if (counter.name == "messages_not_sent") num_unsent = counter.count;
  }
  EXPECT_GE(num_unsent, 20);  // ticks and HEALTH at least
}

TEST_F(Live, CorruptMessagesOnEveryChannelAreCountedAndNothingDies) {
  StartAll();
  bus::LcmBus lcm(bus::DefaultLcmUrl());
  std::mt19937 random(1);
  // A real message of each channel would have to be known here; its fingerprint is enough to get past the first check.
  for (const auto& channel : bus::kChannels) {
    if (channel.name == "HEALTH") continue;  // the test reads it
    for (int i = 0; i < 20; ++i) {
      std::vector<std::uint8_t> bytes(random() % 400);
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      lcm.Publish(channel, bytes);
      std::this_thread::sleep_for(milliseconds(1));
    }
  }
  // Counts of -1 and of 2^31 - 1 behind a right fingerprint.
  for (const std::uint8_t top : {std::uint8_t{0xFF}, std::uint8_t{0x7F}}) {
    auto bytes = bus::Encode(lidar_scan_t{});
    for (std::size_t i = 8; i < bytes.size(); ++i) bytes[i] = i % 4 == 0 ? top : 0xFF;
    lcm.Publish(bus::kLidarScan, bytes);
    auto segments = bus::Encode(segments_t{});
    for (std::size_t i = 8; i < segments.size(); ++i) segments[i] = i % 4 == 0 ? top : 0xFF;
    lcm.Publish(bus::kSegments, segments);
  }
  Simulate(2);
  for (const auto& service : kServices) EXPECT_TRUE(children_[service]->IsRunning()) << service << ": " << children_[service]->Output();
  std::this_thread::sleep_for(milliseconds(1200));
  StopAll();
  const auto live = ReadLog(Log());
  const auto undecodable = [&](const std::string& process, const std::string& channel) {
    std::int64_t count = -1;
    for (const auto& entry : LastHealth(live, process).channels) {
      if (entry.is_input && entry.channel == channel) count = entry.num_undecodable;
    }
    return count;
  };
  EXPECT_EQ(undecodable("segmenter", "LIDAR_SCAN"), 22);
  EXPECT_EQ(undecodable("georeferencer", "SEGMENTS"), 22);
  EXPECT_EQ(undecodable("georeferencer", "POSE"), 20);
  EXPECT_EQ(undecodable("navigator", "LIDAR_NMEA"), 20);
  EXPECT_EQ(undecodable("tracker", "OBSTACLES"), 20);
  EXPECT_EQ(undecodable("tracker", "ALERT_ACK"), 20);
  EXPECT_GE(live.at("OBSTACLES").size(), 15U);
}

TEST_F(Live, LogplayerOfLidarScanAloneGivesTheSameSegments) {
  const auto config = (folder_ / "config").string();
  ASSERT_EQ(
      RunProgram({Bin("sim"), "--config", config, "--scene", "lake", "--seed", "5", "--seconds", "3", "--pcap", "sim.pcap"}, Output("sim")).exit_code,
      0);
  ASSERT_EQ(RunProgram({Bin("replay"), "--config", config, "--in", "sim.pcap", "--out", "replay.lcmlog"}, Output("replay")).exit_code, 0);
  Start("recorder");
  Start("segmenter");
  std::this_thread::sleep_for(milliseconds(1000));
  const auto player = RunProgram({"lcm-logplayer", "-e", "(LIDAR_SCAN)", "replay.lcmlog"}, Output("logplayer"));
  ASSERT_EQ(player.exit_code, 0) << player.output;
  std::this_thread::sleep_for(milliseconds(500));
  children_["segmenter"]->Terminate();
  EXPECT_EQ(children_["recorder"]->Terminate().value_or(-1), 0);
  const auto replayed = ReadLog("replay.lcmlog");
  const auto live = ReadLog(Log());
  ASSERT_TRUE(live.contains("SEGMENTS"));
  EXPECT_GE(live.at("SEGMENTS").size(), 30U);
  EXPECT_TRUE(live.at("SEGMENTS") == replayed.at("SEGMENTS"));
}

}  // namespace
}  // namespace lookout::system_test
