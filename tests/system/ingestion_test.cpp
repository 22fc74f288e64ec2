// lookout-lidar live on loopback, in a network namespace of its own: it counts exactly what happened to the datagrams.
#include "tests/system/ingestion.hpp"

#include <gtest/gtest.h>
#include <regex>

#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {
namespace {

using namespace support;

class Ingestion : public ::testing::Test {
 protected:
  TempDir folder_;
};

TEST_F(Ingestion, TakesEveryPacketOfALidarOnce) {
  LiveVlp16 vlp16(folder_);
  ASSERT_TRUE(vlp16.NextHealth()) << vlp16.process().Output();
  const auto sent = SendDataPackets(754.0, 5.0, [&vlp16] { vlp16.Poll(); });
  EXPECT_EQ(sent.num_sent, 3770);
  const auto health = vlp16.HealthAtRest();
  ASSERT_TRUE(health);
  for (const auto& [name, expected] : CountersOfACleanRun(sent.num_sent)) EXPECT_EQ(support::CountOf(*health, name), expected) << name;
}

TEST_F(Ingestion, CountsWhatTheNetworkDid) {
  LiveVlp16 vlp16(folder_);
  ASSERT_TRUE(vlp16.NextHealth()) << vlp16.process().Output();
  const auto result = RunProgram({Bin("sim"), "--config", vlp16.config_folder().string(), "--scene", "open_water", "--seed", "7", "--seconds", "6",
                                  "--udp", "127.0.0.1", "--drop", "0.05", "--double", "0.02", "--swap", "0.02"},
                                 (folder_ / "sim.out").string());
  ASSERT_EQ(result.exit_code, 0) << result.output;
  std::smatch totals;
  ASSERT_TRUE(
      std::regex_search(result.output, totals, std::regex("data packets made (\\d+), sent (\\d+), dropped (\\d+), doubled (\\d+), swapped (\\d+)")))
      << result.output;
  const auto health = vlp16.HealthAtRest();
  ASSERT_TRUE(health);
  const auto total = [&totals](std::size_t i) { return std::stoll(totals[i]); };
  EXPECT_GT(total(3), 100);
  EXPECT_GT(total(4), 40);
  EXPECT_GT(total(5), 40);
  EXPECT_EQ(support::CountOf(*health, "data_kernel_drops"), 0);
  EXPECT_EQ(support::CountOf(*health, "data_packets_whole"), total(2));
  EXPECT_EQ(support::CountOf(*health, "data_lost"), total(3));
  EXPECT_EQ(support::CountOf(*health, "data_duplicate"), total(4));
  EXPECT_EQ(support::CountOf(*health, "data_reordered"), total(5));
  for (const auto* name : {"data_late", "data_overlapping", "data_azimuth_disagrees", "sensor_restarts", "sensor_clock_steps"}) {
    EXPECT_EQ(support::CountOf(*health, name), 0) << name;
  }
}

}  // namespace
}  // namespace lookout::system_test
