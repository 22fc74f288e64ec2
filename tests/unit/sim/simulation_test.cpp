#include "lab/sim/simulation.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>

#include "tests/support/files.hpp"
#include "tests/unit/sim/scenes.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

SimulationParams Params(std::uint64_t seed, std::chrono::microseconds duration) {
  SimulationParams params;
  params.start = Utime(1'781'532'600s);
  params.duration = duration;
  params.seed = seed;
  return params;
}

std::vector<Datagram> RunAll(const std::string& scene_name, const SimulationParams& params) {
  const auto scene = MakeScene(scene_name, params.seed);
  Simulation simulation(scene, SmallBoat(), params, nullptr);
  std::vector<Datagram> datagrams;
  while (auto datagram = simulation.Next()) datagrams.push_back(std::move(*datagram));
  return datagrams;
}

bool AreEqual(const std::vector<Datagram>& a, const std::vector<Datagram>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Datagram& x, const Datagram& y) {
           return x.time == y.time && x.port == y.port && x.payload == y.payload;
         });
}

TEST(Simulation, GivesTheSameBytesForTheSameSeedOnly) {
  for (const auto& name : SceneNames()) {
    const auto first = RunAll(std::string(name), Params(5, 300ms));
    EXPECT_TRUE(AreEqual(first, RunAll(std::string(name), Params(5, 300ms)))) << name;
    EXPECT_FALSE(AreEqual(first, RunAll(std::string(name), Params(6, 300ms)))) << name;
  }
}

TEST(Simulation, SendsInOrderOfTimeAtTheRatesOfTheSensors) {
  const auto datagrams = RunAll("open_water", Params(1, 2s));
  std::map<std::string, int> counts;
  Utime last{};
  for (const auto& datagram : datagrams) {
    EXPECT_GE(datagram.time, last);
    last = datagram.time;
    if (datagram.port == 10110) {
      const std::string line(datagram.payload.begin(), datagram.payload.end());
      ++counts[line.substr(1, line.find(',') - 1)];
    } else {
      ++counts[std::to_string(datagram.port) + "/" + std::to_string(datagram.payload.size())];
    }
  }
  EXPECT_NEAR(counts["2368/1206"], 2.0 / 1327.104e-6, 2.0);
  EXPECT_NEAR(counts["8308/512"], 2.0 / 7.1e-3, 1.0);
  for (const auto* type : {"GPRMC", "GPGGA", "GPVTG", "GPGST"}) EXPECT_EQ(counts[type], 10) << type;
  EXPECT_EQ(counts["GPZDA"], 2);
  for (const auto* type : {"GPHDT", "GPROT"}) EXPECT_EQ(counts[type], 40) << type;
  EXPECT_EQ(counts["PASHR"], 100);
  EXPECT_EQ(counts["VNIMU"], 198) << "from 20 ms on";
  EXPECT_EQ(counts.size(), 11U);
}

TEST(Simulation, EverySentenceHasARightChecksum) {
  int num_checked = 0;
  for (const auto& datagram : RunAll("open_water", Params(1, 1s))) {
    std::string text;
    if (datagram.port == 10110) text.assign(datagram.payload.begin(), datagram.payload.end());
    if (datagram.port == 8308) text.assign(datagram.payload.begin() + 206, std::find(datagram.payload.begin() + 206, datagram.payload.end(), 0));
    if (text.empty()) continue;
    ASSERT_EQ(text.substr(text.size() - 2), "\r\n");
    const auto star = text.find('*');
    ASSERT_NE(star, std::string::npos);
    unsigned checksum = 0;
    for (const char character : text.substr(1, star - 1)) checksum ^= static_cast<unsigned char>(character);
    EXPECT_EQ(std::stoul(text.substr(star + 1, 2), nullptr, 16), checksum) << text;
    ++num_checked;
  }
  EXPECT_GT(num_checked, 150);
}

TEST(Simulation, PositionPacketsAreLockedAndHoldTheRmcOfAWholeSecondBefore) {
  std::string last_time;
  for (const auto& datagram : RunAll("open_water", Params(1, 2s))) {
    if (datagram.port != 8308) continue;
    EXPECT_EQ(datagram.payload[202], 2);
    const auto past_hour = std::chrono::microseconds(ReadU32LittleEndian(datagram.payload, 198));
    EXPECT_LT(datagram.time - (Utime(1'781'532'000s) + past_hour), 1ms);
    const std::string text(datagram.payload.begin() + 206, datagram.payload.begin() + 206 + 17);
    EXPECT_EQ(text.substr(0, 7), "$GPRMC,");
    EXPECT_EQ(text.substr(13, 4), ".000");
    last_time = text.substr(7, 6);
  }
  EXPECT_EQ(last_time, "141001");
}

TEST(Simulation, BoatWithoutHeadingSendsWhatAReceiverSendsAlone) {
  auto params = Params(1, 1s);
  params.navigation.has_heading = false;
  std::map<std::string, int> counts;
  for (const auto& datagram : RunAll("open_water", params)) {
    if (datagram.port == 10110) ++counts[std::string(datagram.payload.begin() + 1, datagram.payload.begin() + 6)];
  }
  EXPECT_EQ(counts, (std::map<std::string, int>{{"GPRMC", 5}, {"GPGGA", 5}, {"GPVTG", 5}, {"GPGST", 5}, {"GPZDA", 1}}));
}

TEST(Simulation, ALidarWithoutPowerSendsNothingAndItsTruthHoldsNothing) {
  auto params = Params(1, 1s);
  params.faults = {ParseTimedFault("sensor_restart:0.3:0.6:0.2")};
  const support::TempDir folder;
  const auto scene = MakeScene("lake", 1);
  std::vector<std::pair<Utime, std::uint32_t>> stamps;
  {
    TruthWriter truth(folder, scene, SmallBoat(), params.start);
    Simulation simulation(scene, SmallBoat(), params, &truth);
    while (const auto datagram = simulation.Next()) {
      if (datagram->port == 10110) continue;
      stamps.emplace_back(datagram->time, ReadU32LittleEndian(datagram->payload, datagram->port == 2368 ? 1200 : 198));
    }
    io::CommitAll(truth.Finish());
  }
  const std::uint32_t start_us = 600'000'000;  // ten minutes past the hour
  for (const auto& [time, stamp_us] : stamps) {
    const auto since_start = time - params.start;
    EXPECT_TRUE(since_start < 301ms || since_start >= 600ms);
    const bool is_own_clock = since_start >= 600ms && stamp_us < start_us;
    const auto expected_us = since_start.count() - (is_own_clock ? 600'000 : -std::int64_t{start_us});
    EXPECT_NEAR(static_cast<double>(stamp_us), static_cast<double>(expected_us), 2000.0) << "a packet takes 1.33 ms, and its way";
    EXPECT_TRUE(is_own_clock || since_start < 602ms || since_start >= 800ms) << since_start.count();
    EXPECT_TRUE(!is_own_clock || since_start < 802ms) << since_start.count();
  }
  std::ifstream returns(folder / "returns.csv");
  std::string line;
  std::getline(returns, line);
  int num_returns = 0;
  for (; std::getline(returns, line); ++num_returns) {
    const auto since_start = Utime(std::chrono::microseconds(std::stoll(line))) - params.start;
    EXPECT_TRUE(since_start < 300ms || since_start >= 600ms) << line;
  }
  EXPECT_GT(num_returns, 1000);
}

TEST(Simulation, FaultsOfAnotherSensorLeaveThePacketsOfTheLidarAlone) {
  const auto data_packets = [](const std::vector<std::string>& faults) {
    auto params = Params(3, 500ms);
    for (const auto& fault : faults) params.faults.push_back(ParseTimedFault(fault));
    std::vector<Datagram> found;
    for (auto& datagram : RunAll("lake", params)) {
      if (datagram.port == 2368) found.push_back(std::move(datagram));
    }
    return found;
  };
  EXPECT_TRUE(AreEqual(data_packets({}), data_packets({"gnss_gap:0.1:0.3", "imu_stop:0:1", "frozen_heading:0:1", "wrong_hour:0:1", "late_rmc:0:1"})));
  EXPECT_FALSE(AreEqual(data_packets({}), data_packets({"wrong_stamp:0.1:0.3"})));
}

std::vector<std::string> Lines(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(TruthWriter, WritesObjectsOutlinesPosesReturnsAndFaults) {
  const support::TempDir folder;
  const auto params = Params(1, 500ms);
  const auto scene = MakeScene("lake", 1);
  std::size_t num_returns = 0;
  {
    TruthWriter truth(folder, scene, SmallBoat(), params.start);
    Simulation simulation(scene, SmallBoat(), params, &truth);
    truth.AddFault(ParseTimedFault("gnss_gap:0.1:0.3"));
    truth.AddFault(ParseTimedFault("gnss_jump:0.25:60:2.5"));
    truth.AddFault(Fault{FaultKind::kDoubled, params.start + 40ms, 29});
    while (const auto datagram = simulation.Next()) {
      if (datagram->port != 2368) continue;
      for (std::size_t block = 0; block < 12; ++block) {
        for (std::size_t k = 0; k < 32; ++k) num_returns += ReadU16LittleEndian(datagram->payload, block * 100 + 4 + k * 3) != 0 ? 1U : 0U;
      }
    }
    io::CommitAll(truth.Finish());
  }
  EXPECT_EQ(Lines(folder / "objects.csv").size(), scene.objects.size() + 3);
  EXPECT_EQ(Lines(folder / "returns.csv").size(), num_returns + 1);
  EXPECT_EQ(Lines(folder / "returns.csv")[0], "utime_us,ring,return_index,object_id,reason,x_m,y_m,z_m");
  EXPECT_EQ(Lines(folder / "faults.csv"),
            (std::vector<std::string>{"utime_us,kind,packet_index,end_utime_us,value", "1781532600100000,gnss_gap,,1781532600300000,",
                                      "1781532600250000,gnss_jump,,1781532660000000,2.5", "1781532600040000,doubled,29,,"}));
  const auto poses = Lines(folder / "pose.csv");
  EXPECT_EQ(poses.size(), 1U + 25U);  // 0, 20, ... 480 ms; the last packet ends before 500 ms
  EXPECT_EQ(poses[1].rfind("1781532600000000,43.62", 0), 0U);
  // The motor boat moves (9 vertices each 100 ms, one beyond the end), a buoy does not (24 once).
  int num_motor_boat = 0;
  int num_buoy = 0;
  for (const auto& line : Lines(folder / "outlines.csv")) {
    num_motor_boat += line.rfind("3,", 0) == 0 ? 1 : 0;
    num_buoy += line.rfind("7,", 0) == 0 ? 1 : 0;
  }
  EXPECT_EQ(num_motor_boat, 9 * 6);
  EXPECT_EQ(num_buoy, 24);
  // All objects and the own boat each 100 ms.
  const auto object_poses = Lines(folder / "object_poses.csv");
  EXPECT_EQ(object_poses.size(), 1U + 6U * (scene.objects.size() + 1));
  EXPECT_EQ(object_poses[0], "object_id,utime_us,latitude_deg,longitude_deg,east_m,north_m,up_m,heading_deg,roll_deg,pitch_deg");
}

}  // namespace
}  // namespace lookout::sim
