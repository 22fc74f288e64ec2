#include "common/runtime/health.hpp"

#include <gtest/gtest.h>

#include "common/bus/memory_bus.hpp"
#include "lookout/lidar_nmea_t.hpp"

namespace lookout::runtime {
namespace {

TEST(HealthReporter, TellsTrafficCountersAndTheMachine) {
  bus::MemoryBus bus;
  bus::Subscribe<lidar_nmea_t>(bus, bus::kLidarNmea, [](const lidar_nmea_t&) {});
  for (const int seq : {0, 3}) {
    lidar_nmea_t message{};
    message.seq = seq;
    bus::Publish(bus, bus::kLidarNmea, message);
  }
  while (bus.HandleOnce()) {
  }
  HealthReporter reporter("test");
  const HealthReport report{HealthState::kDegraded, "no lidar", {{"bad_flag", 7}}};
  const auto message = reporter.Make(Utime(std::chrono::microseconds(5)), report, bus);
  EXPECT_EQ(message.utime_us, 5);
  EXPECT_EQ(message.process, "test");
  EXPECT_EQ(message.state, health_t::STATE_DEGRADED);
  EXPECT_EQ(message.reason, "no lidar");
  ASSERT_EQ(message.num_counters, 2);  // and messages_not_sent
  EXPECT_EQ(message.counters[0].name, "bad_flag");
  EXPECT_EQ(message.counters[0].count, 7);
  ASSERT_EQ(message.num_channels, 2);  // in and out
  EXPECT_TRUE(message.channels[0].is_input);
  EXPECT_EQ(message.channels[0].num_messages, 2);
  EXPECT_EQ(message.channels[0].num_lost, 2);
  EXPECT_GE(message.channels[0].handling_p99_us, message.channels[0].handling_p50_us);
  EXPECT_GT(message.resident_bytes, 1'000'000);
  EXPECT_EQ(reporter.Make(Utime(), report, bus).seq, 1);
}

}  // namespace
}  // namespace lookout::runtime
