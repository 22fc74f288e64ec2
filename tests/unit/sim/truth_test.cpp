#include "lab/sim/truth.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "lab/sim/simulation.hpp"
#include "lookout/sim_truth_t.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/sim/scenes.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

constexpr int kSlotsPerPacket = 384;

class TruthLogTest : public testing::Test {
 protected:
  // One second of a scene. @return messages of its truth.lcmlog
  std::vector<sim_truth_t> Run(const std::string& scene_name, config::Scene::ReturnMode mode) {
    auto scene = MakeScene(scene_name, 3);
    scene.effects.set_return_mode(mode);
    SimulationParams params;
    params.start = Utime(1'781'532'600s);
    params.duration = 1s;
    params.seed = 3;
    TruthWriter truth(folder_, scene, SmallBoat(), params.start, {.force = true});
    Simulation simulation(scene, SmallBoat(), params, &truth);
    while (simulation.Next()) {
    }
    io::CommitAll(truth.Finish());
    return Messages();
  }

  std::vector<sim_truth_t> Messages() const {
    std::vector<sim_truth_t> messages;
    bus::LogReader reader(folder_ / "truth.lcmlog");
    while (const auto event = reader.Next()) {
      EXPECT_EQ(event->channel, bus::kSimTruth.name);
      EXPECT_LE(event->bytes.size(), static_cast<std::size_t>(bus::kMaxMessageBytes));
      const auto message = bus::Decode<sim_truth_t>(event->bytes);
      EXPECT_TRUE(message);
      if (!message) continue;
      EXPECT_EQ(message->seq, static_cast<std::int64_t>(messages.size()));
      EXPECT_EQ(message->utime_us, ToUtimeUs(event->time));
      messages.push_back(*message);
    }
    EXPECT_EQ(reader.num_damaged(), 0);
    return messages;
  }

  std::vector<std::vector<std::string>> Rows(const std::string& file) const {
    std::ifstream in(folder_ / file);
    std::vector<std::vector<std::string>> rows;
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
      rows.emplace_back();
      std::istringstream text(line);
      for (std::string cell; std::getline(text, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
  }

  support::TempDir folder_;
};

TEST_F(TruthLogTest, HasTheReturnsOfTheCsvFile) {
  for (const auto mode : {config::Scene::STRONGEST, config::Scene::DUAL}) {
    std::vector<std::tuple<int, std::string>> from_log;
    std::int64_t num_packets = 0;
    for (const auto& message : Run("rain", mode)) {
      if (message.num_packets == 0) continue;
      EXPECT_EQ(message.num_objects, 0);
      EXPECT_EQ(message.first_packet, num_packets);
      num_packets += message.num_packets;
      ASSERT_EQ(message.num_slots, message.num_packets * kSlotsPerPacket);
      EXPECT_EQ(message.utime_us, message.packet_utime_us.front());
      for (int packet = 0; packet < message.num_packets; ++packet) {
        // The CSV file has the order of the shots: in dual return the pair of a shot lies in two blocks.
        const int blocks_per_shot = mode == config::Scene::DUAL ? 2 : 1;
        for (int block = 0; block < 12; block += blocks_per_shot) {
          for (int k = 0; k < 32; ++k) {
            for (int i = 0; i < blocks_per_shot; ++i) {
              const auto slot = static_cast<std::size_t>(packet * kSlotsPerPacket + (block + i) * 32 + k);
              if (message.reason[slot] == sim_truth_t::REASON_NONE) {
                EXPECT_EQ(message.object_id[slot], 0);
                continue;
              }
              from_log.emplace_back(message.object_id[slot], NameOf(static_cast<ReturnReason>(message.reason[slot])));
            }
          }
        }
      }
    }
    std::vector<std::tuple<int, std::string>> from_csv;
    for (const auto& row : Rows("returns.csv")) from_csv.emplace_back(std::stoi(row.at(3)), row.at(4));
    EXPECT_GT(from_csv.size(), 20'000U);
    EXPECT_EQ(from_log, from_csv);
  }
}

TEST_F(TruthLogTest, HasEveryObjectEachTenthOfASecondWithItsOutline) {
  const auto messages = Run("dense", config::Scene::STRONGEST);
  const auto scene = MakeScene("dense", 3);
  std::int64_t next_utime_us = 1'781'532'600'000'000;
  for (const auto& message : messages) {
    if (message.num_objects == 0) continue;
    EXPECT_EQ(message.num_packets, 0);
    EXPECT_EQ(message.utime_us, next_utime_us);
    next_utime_us += 100'000;
    ASSERT_EQ(message.objects.size(), scene.objects.size() + 1);
    EXPECT_EQ(message.objects[0].id, kOwnVessel);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const auto& told = message.objects[i + 1];
      EXPECT_EQ(told.id, scene.objects[i].id);
      EXPECT_EQ(told.name, scene.objects[i].name);
      EXPECT_EQ(told.is_in_water != 0, scene.objects[i].is_in_water);
      EXPECT_EQ(static_cast<std::size_t>(told.num_outline), scene.objects[i].outline_m.size());
      const auto placement = scene.objects[i].track.At(static_cast<double>(message.utime_us - 1'781'532'600'000'000) * 1e-6);
      EXPECT_NEAR(told.east_m, placement.position_map_m.x(), 1e-6);
      EXPECT_NEAR(WrapToPi(told.heading_rad - placement.heading_rad), 0.0, 1e-6);
    }
  }
  EXPECT_GE(next_utime_us, 1'781'532'600'000'000 + 1'000'000) << "to the last return and beyond";
  // Outlines of what moves stand in the CSV file at the same times.
  std::map<std::tuple<int, std::int64_t, int>, std::pair<double, double>> from_csv;
  for (const auto& row : Rows("outlines.csv")) {
    from_csv[{std::stoi(row[0]), std::stoll(row[1]), std::stoi(row[2])}] = {std::stod(row[5]), std::stod(row[6])};
  }
  int num_compared = 0;
  for (const auto& message : messages) {
    for (const auto& object : message.objects) {
      for (int vertex = 0; vertex < object.num_outline; ++vertex) {
        const auto found = from_csv.find({object.id, message.utime_us, vertex});
        if (found == from_csv.end()) continue;
        EXPECT_NEAR(object.outline_east_m[static_cast<std::size_t>(vertex)], found->second.first, 1e-3);
        EXPECT_NEAR(object.outline_north_m[static_cast<std::size_t>(vertex)], found->second.second, 1e-3);
        ++num_compared;
      }
    }
  }
  EXPECT_GT(num_compared, 50);
}

TEST_F(TruthLogTest, OwnBoatHasThePoseOfThePoseFile) {
  const auto messages = Run("waves", config::Scene::STRONGEST);
  std::map<std::int64_t, std::vector<double>> poses;
  for (const auto& row : Rows("pose.csv")) {
    for (const auto& cell : row) poses[std::stoll(row[0])].push_back(std::stod(cell));
  }
  int num_compared = 0;
  for (const auto& message : messages) {
    if (message.num_objects == 0 || !poses.contains(message.utime_us)) continue;
    const auto& pose = poses.at(message.utime_us);
    const auto& own = message.objects[0];
    EXPECT_NEAR(RadToDeg(own.heading_rad), pose[3], 1e-3);
    EXPECT_NEAR(RadToDeg(own.roll_rad), pose[4], 1e-3);
    EXPECT_NEAR(RadToDeg(own.pitch_rad), pose[5], 1e-3);
    EXPECT_NEAR(own.up_m, SmallBoat().reference_point_above_water_m + pose[8], 1e-3);
    ++num_compared;
  }
  EXPECT_GE(num_compared, 10);
}

TEST_F(TruthLogTest, LargestScenesStayBelowTheLimitOfAMessage) {
  for (const auto& name : SceneNames()) {
    const auto scene = MakeScene(name, 1);
    TruthWriter truth(folder_, scene, SmallBoat(), Utime(1'781'532'600s), {.force = true});
    truth.AdvanceTo(Utime(1'781'532'600s));
    io::CommitAll(truth.Finish());
    EXPECT_FALSE(Messages().empty()) << name;
  }
}

}  // namespace
}  // namespace lookout::sim
