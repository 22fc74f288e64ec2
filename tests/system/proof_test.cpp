// The proof: what ran live computes again to the same bytes. All processes over UDP LCM in a network namespace of their own, the simulator sends
// real datagrams. LOOKOUT_PROOF_SECONDS sets the length of the data (default 4).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/ais_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/live_test.hpp"
#include "tests/support/socket.hpp"
#include "tests/unit/ais/encoder.hpp"
#include "tools/log/watch_alerts.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

// Sources end first, so that what they send at their end still finds its takers.
const std::vector<std::string> kFromSourceToLog{"lidar", "odometer", "navigator", "segmenter", "georeferencer", "tracker", "ais", "recorder"};

int DataSeconds() {
  const char* text = std::getenv("LOOKOUT_PROOF_SECONDS");
  return text != nullptr ? std::max(1, std::atoi(text)) : 4;
}

std::int64_t Count(const Payloads& log, const std::string& channel) {
  const auto found = log.find(channel);
  return found == log.end() ? 0 : static_cast<std::int64_t>(found->second.size());
}

// Every message that every process says it lost, did not understand or could not send; and each process that says nothing.
std::vector<std::string> LossesIn(const Payloads& log) {
  std::map<std::string, health_t> last;
  if (const auto found = log.find("HEALTH"); found != log.end()) {
    for (const auto& bytes : found->second) {
      if (const auto message = bus::Decode<health_t>(bytes)) last[message->process] = *message;
    }
  }
  std::vector<std::string> losses;
  for (const auto& process : kFromSourceToLog) {
    if (!last.contains(process)) losses.push_back(process + " sent no HEALTH");
  }
  // scans_flushed of the tracker: lidar time went back. A lidar that starts again stamps its first scan by the host, and where packets come late that
  // is behind the next, which has the sensor's time.
  const std::set<std::string> counters{"messages_not_sent",     "data_lost",        "data_kernel_drops",
                                       "position_kernel_drops", "udp_kernel_drops", "scans_flushed"};
  for (const auto& [process, health] : last) {
    for (const auto& channel : health.channels) {
      if (channel.num_lost + channel.num_undecodable > 0) losses.push_back(process + " lost " + channel.channel);
    }
    for (const auto& counter : health.counters) {
      if (counters.contains(counter.name) && counter.count > 0) losses.push_back(process + " " + counter.name);
    }
  }
  return losses;
}

// A run without the ALERTS that went out because no scan came, as after the end of the simulation: those come by the host's clock.
Payloads WithoutWatchAlerts(Payloads log) {
  std::erase_if(log["ALERTS"], [](const auto& bytes) { return log::IsWatchAlert("ALERTS", bytes); });
  return log;
}

// Every data message, byte for byte.
// @param silent  channels on which nothing comes
void ExpectSameMessages(const Payloads& one, const Payloads& other, const std::set<std::string>& silent = {}) {
  for (const auto& channel : bus::kChannels) {
    // Nobody was there to acknowledge, and the boat has one lidar.
    if (!channel.is_replayed || bus::HasSeveralPublishers(channel) || bus::IsOfSecondLidar(channel)) continue;
    const std::string name(channel.name);
    // Where no AIS was heard, nothing is said of it.
    if (silent.contains(name) || (name == "AIS" && Count(one, name) == 0)) {
      EXPECT_EQ(Count(one, name) + Count(other, name), 0) << name;
      continue;
    }
    ASSERT_GT(Count(one, name), 0) << name;
    EXPECT_EQ(Count(one, name), Count(other, name)) << name;
    EXPECT_TRUE(other.contains(name) && one.at(name) == other.at(name)) << name << " differs";
  }
}

// A receiver of AIS beside the boat's other sensors: the own transponder, and ships on the lake of the simulator.
class AisReceiver {
 private:
  static void Send(const std::stop_token& is_over) {
    const Socket socket(SOCK_DGRAM);
    const auto navigator = Ipv4("127.0.0.1", 10110);
    const auto send = [&](const std::vector<std::string>& lines) {
      for (const auto& line : lines) {
        const auto text = line + "\r\n";
        EXPECT_TRUE(socket.SendTo(navigator, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
      }
    };
    for (int i = 0; !is_over.stop_requested(); ++i) {
      const auto now = std::chrono::floor<seconds>(std::chrono::system_clock::now()).time_since_epoch().count();
      ais::test::Position position{
          .latitude_deg = 43.6333, .longitude_deg = -72.15, .speed_kn = 0.0, .course_deg = 90.0, .second = static_cast<int>(now % 60)};
      send(ais::test::Lines(ais::test::ClassB(211000000, position), "AIVDO"));
      for (std::uint32_t ship = 1; ship <= 5; ++ship) {
        position.latitude_deg += 0.0001;
        send(ais::test::Lines(ais::test::ClassA(211000000 + ship, position)));
        send(ais::test::Lines(ais::test::StaticA(211000000 + ship, "PROOF " + std::to_string(ship), "CALL", 70, {5, 5, 2, 2}), "AIVDM", i % 10));
      }
      std::this_thread::sleep_for(milliseconds(210));
    }
  }

  std::jthread thread_{Send};
};

class Proof : public LiveTest {
 protected:
  std::set<std::string> heard_;                 // processes of which HEALTH came
  std::map<std::string, std::int64_t> counts_;  // of ALERTS those of a scan
  std::unique_ptr<bus::LcmBus> lcm_;

  // A folder for the run, with a config; the recorder's logs/ is made in it.
  void EnterRun(const std::string& run, bool is_played) {
    fs::create_directories(folder_ / run);
    fs::copy(kDemoConfig, folder_ / run / "config");
    fs::current_path(folder_ / run);
    if (is_played) {
      ReplaceIn("config/lidar.txtpb", "source: UDP", "source: LOG");
      ReplaceIn("config/navigator.txtpb", "source: LIVE", "source: LOG");
    }
    heard_.clear();
    counts_.clear();
    lcm_ = std::make_unique<bus::LcmBus>(bus::DefaultLcmUrl());
    bus::Subscribe<health_t>(*lcm_, bus::kHealth, [this](const health_t& message) { heard_.insert(message.process); });
    for (const auto* channel : {&bus::kObstacles, &bus::kAlerts, &bus::kPose}) {
      lcm_->SubscribeRaw(*channel, [this](std::string_view name, Bytes bytes) {
        if (!log::IsWatchAlert(name, bytes)) ++counts_[std::string(name)];
      });
    }
  }

  // Ends when each has said how it is: then it also hears.
  void Start(const std::vector<std::string>& services) {
    for (const auto& service : services) {
      children_[service] = std::make_unique<Child>(std::vector<std::string>{Bin(service), "--config", "config"}, service + ".out");
    }
    const auto is_there = [this](const std::string& service) { return heard_.contains(service); };
    ASSERT_TRUE(HandleUntil([&] { return std::ranges::all_of(services, is_there); })) << "a process does not report";
  }

  bool HandleUntil(const std::function<bool()>& is_done, seconds timeout = seconds(30)) { return support::HandleUntil(*lcm_, is_done, timeout); }

  // Ends each process once the bus has been silent (but for HEALTH) for a while: what it waits for is then with it.
  Payloads StopAndRead() {
    for (const auto& service : kFromSourceToLog) {
      for (int num_silent = 0; num_silent < 4;) {
        const auto before = counts_;
        const auto until = std::chrono::steady_clock::now() + milliseconds(50);
        while (std::chrono::steady_clock::now() < until) lcm_->HandleOnce(milliseconds(10));
        // The live navigator never ends: it ticks.
        num_silent = service == "lidar" || service == "odometer" || service == "navigator" || before == counts_ ? num_silent + 1 : 0;
      }
      EXPECT_EQ(children_[service]->Terminate().value_or(-1), 0) << service << ": " << children_[service]->Output();
    }
    children_.clear();
    log_ = fs::absolute(FirstLogIn("logs"));
    return WithoutWatchAlerts(ReadLog(log_));
  }

  fs::path log_;  // of the latest run

  // @param has_navigation  false: the lidar alone is heard
  Payloads RunLive(const std::string& run, bool has_navigation = true) {
    EnterRun(run, false);
    const std::string sensors = has_navigation ? "config" : kDemoConfig.string();
    if (!has_navigation) {
      ReplaceIn("config/navigator.txtpb", "use_lidar_nmea: true", "use_lidar_nmea: false");
      WriteFile("config/navigator.txtpb", ReadFile("config/navigator.txtpb") + "nmea_port: 10111\n");
    }
    Start({"recorder", "ais", "tracker", "georeferencer", "segmenter"});
    Start({"navigator", "odometer", "lidar"});  // nobody misses their start marks
    std::optional<AisReceiver> receiver;
    if (has_navigation) receiver.emplace();
    const auto sim = RunProgram(
        {Bin("sim"), "--config", sensors, "--scene", "lake", "--seed", "3", "--seconds", std::to_string(DataSeconds()), "--udp", "127.0.0.1"},
        "sim.out");
    EXPECT_EQ(sim.exit_code, 0) << sim.output;
    receiver.reset();
    return StopAndRead();
  }

  // A process is ended by a signal in mid-run, and started again. Nobody gives up a wait for it: what does lies outside of the promise.
  Payloads RunWithARestart(const std::string& run, const std::string& victim, int signal) {
    EnterRun(run, false);
    WriteFile("config/tracker.txtpb", ReadFile("config/tracker.txtpb") + "wait_timeout_s: 20\n");
    ReplaceIn("config/georeferencer.txtpb", "pose_timeout_s: 0.5", "pose_timeout_s: 20");
    Start({"recorder", "ais", "tracker", "georeferencer", "segmenter"});
    Start({"navigator", "odometer", "lidar"});
    Child sim(
        {Bin("sim"), "--config", "config", "--scene", "lake", "--seed", "3", "--seconds", std::to_string(DataSeconds() + 2), "--udp", "127.0.0.1"},
        "sim.out");
    const auto half = 5 * (DataSeconds() + 2);
    const seconds longest(2 * DataSeconds() + 30);
    EXPECT_TRUE(HandleUntil([&] { return counts_["ALERTS"] >= half; }, longest)) << sim.Output();
    children_[victim]->Signal(signal);
    children_[victim]->Wait(seconds(5));
    // What was sent while it still ran waits in the socket: only scans without ALERTS are those at which nobody was there.
    if (victim == "tracker") {
      EXPECT_TRUE(HandleUntil([&] { return counts_["OBSTACLES"] >= counts_["ALERTS"] + 5; }));
    }
    heard_.clear();
    Start({victim});
    EXPECT_TRUE(HandleUntil([&sim] { return !sim.IsRunning(); }, longest)) << sim.Output();
    // What waited for the new process is worked through, and its HEALTH, one a second, tells of it.
    const auto until = std::chrono::steady_clock::now() + seconds(3);
    HandleUntil([&until] { return std::chrono::steady_clock::now() >= until; });
    return StopAndRead();
  }

  // Plays the raw channels of a log, and nothing else, into live processes.
  Payloads RunPlayed(const std::string& run, const std::string& speed, const fs::path& log, const Payloads& expected) {
    EnterRun(run, true);
    Start(kFromSourceToLog);
    Child player({"lcm-logplayer", "-s", speed, "-e", "(LIDAR_PACKETS|NAV_RAW)", log.string()}, "logplayer.out");
    EXPECT_TRUE(HandleUntil([&player] { return !player.IsRunning(); }, seconds(2 * DataSeconds() + 30)));
    EXPECT_EQ(player.Wait(milliseconds(0)).value_or(-1), 0) << player.Output();
    HandleUntil([&] { return counts_["ALERTS"] >= Count(expected, "ALERTS") && counts_["POSE"] >= Count(expected, "POSE"); });
    return StopAndRead();
  }
};

// The promise ends at a loss that is counted, and on a computer with more to do than it can, messages are lost. Some attempts, then, to have a run
// without.
constexpr int kMaxAttempts = 3;

template <typename Run>
Payloads WithoutLoss(const Run& run, const std::set<std::string>& but_for = {}) {
  for (int attempt = 1;; ++attempt) {
    auto log = run(std::to_string(attempt));
    auto losses = LossesIn(log);
    std::erase_if(losses, [&but_for](const auto& loss) { return but_for.contains(loss); });
    if (losses.empty() || attempt == kMaxAttempts || ::testing::Test::HasFailure()) {
      EXPECT_EQ(losses, std::vector<std::string>());
      return log;
    }
    std::printf("attempt %d: %s\n", attempt, ::testing::PrintToString(losses).c_str());
  }
}

TEST_F(Proof, WhatRanLiveComputesAgainToTheSameBytes) {
  const auto live = WithoutLoss([this](const std::string& attempt) { return RunLive("live-" + attempt); });
  const auto log = log_;
  ASSERT_FALSE(HasFailure());
  EXPECT_GE(Count(live, "LIDAR_SCAN"), 10 * DataSeconds() - 2);
  EXPECT_GE(Count(live, "RUN_INFO"), 1);
  ASSERT_GT(Count(live, "AIS"), 10);
  const auto ships = bus::Decode<ais_t>(live.at("AIS").back()).value();
  EXPECT_EQ(ships.status, std::int32_t{ais_t::STATUS_OK});
  EXPECT_EQ(ships.num_ships, 5);
  EXPECT_EQ(ships.own_mmsi, 211000000);

  const auto replay = RunProgram({Bin("replay"), "--config", "config", "--in", log.string(), "--out", "again"}, "replay.out");
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  {
    SCOPED_TRACE("lookout-replay");
    ExpectSameMessages(live, ReadLog("again"));
  }
  // From the middle of the chain: the same obstacles.
  const auto part =
      RunProgram({Bin("replay"), "--config", "config", "--in", log.string(), "--out", "part", "--from", "SEGMENTS", "--from", "POSE"}, "part.out");
  ASSERT_EQ(part.exit_code, 0) << part.output;
  for (const auto* name : {"OBSTACLES", "TRACKS", "ALERTS", "AIS"}) EXPECT_TRUE(ReadLog("part").at(name) == live.at(name)) << name;

  for (const std::string speed : {"1", "10"}) {
    SCOPED_TRACE("lcm-logplayer at x" + speed);
    const auto played = WithoutLoss([&](const std::string& attempt) { return RunPlayed("x" + speed + "-" + attempt, speed, log, live); });
    ExpectSameMessages(live, played);
  }
}

// A boat with a lidar and nothing else: tracks and alerts come, in a frame that began where the boat was.
TEST_F(Proof, ALidarAloneGivesTracksAndComputesAgainToTheSameBytes) {
  const auto live = WithoutLoss([this](const std::string& attempt) { return RunLive("alone-" + attempt, false); });
  const auto log = log_;
  ASSERT_FALSE(HasFailure());
  std::size_t num_relative = 0;
  for (const auto& bytes : live.at("POSE")) num_relative += bus::Decode<pose_t>(bytes).value().status == pose_t::STATUS_RELATIVE ? 1 : 0;
  EXPECT_GT(num_relative, live.at("POSE").size() / 2);
  const auto last = bus::Decode<tracks_t>(live.at("TRACKS").back()).value();
  EXPECT_TRUE(std::ranges::any_of(last.tracks, [](const track_t& track) { return track.status == track_t::STATUS_CONFIRMED; }));
  EXPECT_TRUE(std::isnan(last.datum_latitude_deg));
  EXPECT_GT(last.datum_ellipsoid_height_m, 1.5e12) << "when it began, ms since 1970";

  const auto replay = RunProgram({Bin("replay"), "--config", "config", "--in", log.string(), "--out", "again"}, "replay.out");
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  EXPECT_NE(replay.output.find("in a frame that began where the boat was"), std::string::npos) << replay.output;
  ExpectSameMessages(live, ReadLog("again"), {"GNSS_FIX", "ATTITUDE"});
}

// At how many scans a process of the tracker began.
std::size_t NumBegins(const Payloads& log) {
  std::set<std::int64_t> begins;
  for (const auto& bytes : log.at("TRACKS")) begins.insert(bus::Decode<tracks_t>(bytes).value().begin_utime_us);
  return begins.size();
}

// The last that the tracker said of a counter.
std::int64_t CounterOfTracker(const Payloads& log, std::string_view name) {
  std::int64_t count = -1;
  for (const auto& bytes : log.at("HEALTH")) {
    const auto message = bus::Decode<health_t>(bytes).value();
    if (message.process != "tracker") continue;
    const auto found = std::ranges::find(message.counters, name, &health_counter_t::name);
    if (found != message.counters.end()) count = found->count;
  }
  return count;
}

// Where its process begins anew the tracker knows nothing of before, and its ids begin anew; the replay does so at the same scan.
class ProofOfARestart : public Proof, public ::testing::WithParamInterface<std::pair<std::string, int>> {};

// Whether a process was killed after it had sent what it took in and before it had sent its answer: the replay has the answer. Outside of the
// promise.
bool WasKilledBeforeAnAnswer(const std::string& victim, const Payloads& live, const Payloads& again) {
  const std::map<std::string, std::vector<std::string>> answers{
      {"tracker", {}}, {"lidar", {"LIDAR_SCAN", "LIDAR_CLOCK"}}, {"navigator", {"GNSS_FIX", "ATTITUDE", "POSE"}}};
  return std::ranges::any_of(answers.at(victim), [&](const auto& channel) { return Count(again, channel) == Count(live, channel) + 1; });
}

TEST_P(ProofOfARestart, IsReplayedSo) {
  const auto& [victim, signal] = GetParam();
  Payloads live;
  Payloads again;
  for (int attempt = 1; attempt <= kMaxAttempts; ++attempt) {
    const auto name = std::to_string(attempt);
    live = WithoutLoss([&, &who = victim, by = signal](const std::string& run) { return RunWithARestart(name + "-" + run, who, by); },
                       {"recorder lost TRACKS", "recorder lost ALERTS", "ais lost TRACKS"});  // that nobody sent
    ASSERT_FALSE(HasFailure());
    const auto replay = RunProgram({Bin("replay"), "--config", "config", "--in", log_.string(), "--out", "again"}, "replay.out");
    ASSERT_EQ(replay.exit_code, 0) << replay.output;
    again = ReadLog("again");
    if (!WasKilledBeforeAnAnswer(victim, live, again)) break;
    std::printf("attempt %d: the replay has an answer that the %s did not live to send\n", attempt, victim.c_str());
  }
  if (victim == "tracker") {
    EXPECT_EQ(NumBegins(live), 2U);
    EXPECT_LT(Count(live, "ALERTS"), Count(live, "LIDAR_CLOCK") - 3) << "nobody was there for some scans";
  } else {
    EXPECT_EQ(NumBegins(live), 1U);
    EXPECT_EQ(CounterOfTracker(live, "runs_begun"), 1);
  }
  ExpectSameMessages(live, again);
}

INSTANTIATE_TEST_SUITE_P(Tracker, ProofOfARestart,
                         ::testing::Values(std::pair("tracker", SIGKILL), std::pair("tracker", SIGTERM), std::pair("lidar", SIGKILL),
                                           std::pair("navigator", SIGKILL)),
                         [](const auto& test) { return test.param.first + (test.param.second == SIGKILL ? "Killed" : "Terminated"); });

}  // namespace
}  // namespace lookout::system_test
