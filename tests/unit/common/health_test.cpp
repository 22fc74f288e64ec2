#include "common/runtime/health.hpp"

#include <gtest/gtest.h>

#include "lookout/lidar_nmea_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "tests/support/memory_bus.hpp"

namespace lookout::runtime {
namespace {

// A process that has failed must not say "degraded" because something else is wrong, too.
TEST(HealthReport, StaysFailedWhateverElseIsWrong) {
  HealthReport report{HealthState::kFailed, "not recording", {}};
  report.Degrade("two publishers");
  EXPECT_EQ(report.state, HealthState::kFailed);
  EXPECT_EQ(report.reason, "not recording; two publishers");
  HealthReport fine;
  fine.Degrade("no POSE for 3 s");
  EXPECT_EQ(fine.state, HealthState::kDegraded);
  EXPECT_EQ(fine.reason, "no POSE for 3 s");
}

TEST(HealthReporter, TellsTrafficCountersAndTheMachine) {
  bus::MemoryBus bus;
  bus::Subscribe<lidar_nmea_t>(bus, bus::kLidarNmea, [](const lidar_nmea_t&) {});
  for (const int seq : {0, 3}) {
    lidar_nmea_t message{};
    message.seq = seq;
    message.utime_us = 1'000'000;
    bus::Publish(bus, bus::kLidarNmea, message);
  }
  support::HandleAll(bus);
  HealthReporter reporter("test");
  const HealthReport report{HealthState::kDegraded, "no lidar", {{"bad_flag", 7}}};
  const auto message = reporter.Make(Utime(std::chrono::microseconds(1'300'000)), report, bus);
  EXPECT_EQ(message.utime_us, 1'300'000);
  EXPECT_EQ(message.process, "test");
  EXPECT_EQ(message.state, health_t::STATE_STARTING);
  EXPECT_EQ(message.reason, "no lidar");
  ASSERT_EQ(message.num_counters, 3);  // and messages_not_sent, second_publisher
  EXPECT_EQ(message.counters[0].name, "bad_flag");
  EXPECT_EQ(message.counters[0].count, 7);
  ASSERT_EQ(message.num_channels, 2);  // in and out
  EXPECT_TRUE(message.channels[0].is_input);
  EXPECT_EQ(message.channels[0].num_messages, 2);
  EXPECT_EQ(message.channels[0].num_lost, 2);
  EXPECT_GE(message.channels[0].handling_p99_us, message.channels[0].handling_p50_us);
  EXPECT_EQ(message.channels[0].latency_p50_us, -1);
  // Sent a moment before the report: up to a second for a machine that is busy.
  EXPECT_LE(message.channels[1].latency_p99_us, 300'000);
  EXPECT_GE(message.channels[1].latency_p50_us, -700'000);
  EXPECT_GT(message.resident_bytes, 1'000'000);
  const auto next = reporter.Make(Utime(), report, bus);
  EXPECT_EQ(next.seq, 1);
  EXPECT_EQ(next.channels[1].latency_p50_us, -1);
}

TEST(HealthReporter, IsStartingUntilItIsOkOnce) {
  bus::MemoryBus bus;
  HealthReporter reporter("test");
  const HealthReport waits{HealthState::kDegraded, "no lidar", {}};
  EXPECT_EQ(reporter.Make(Utime(), waits, bus).state, health_t::STATE_STARTING);
  EXPECT_EQ(reporter.Make(Utime(), {HealthState::kFailed, "disk full", {}}, bus).state, health_t::STATE_FAILED);
  EXPECT_EQ(reporter.Make(Utime(), {}, bus).state, health_t::STATE_OK);
  EXPECT_EQ(reporter.Make(Utime(), waits, bus).state, health_t::STATE_DEGRADED);
}

TEST(HealthReporter, TellsOfASecondPublisherForAMinuteAndKeepsTheCount) {
  bus::MemoryBus bus;
  std::chrono::nanoseconds now{0};
  bus.GuardStreams([&now] { return now; });
  std::int64_t num_taken = 0;
  bus::Subscribe<lidar_nmea_t>(bus, bus::kLidarNmea, [&num_taken](const lidar_nmea_t&) { ++num_taken; });
  const auto publish = [&](std::int64_t seq, std::int64_t utime_us) {
    lidar_nmea_t message{};
    message.seq = seq;
    message.utime_us = utime_us;
    bus::Publish(bus, bus::kLidarNmea, message);
    support::HandleAll(bus);
  };
  const auto pass = [&](int num_tenths) {
    for (int i = 0; i < num_tenths; ++i) {
      now += std::chrono::milliseconds(100);
      bus.ReleaseHeld();
    }
  };
  HealthReporter reporter("test");
  EXPECT_EQ(reporter.Make(Utime(), {}, bus).state, health_t::STATE_OK);
  for (int i = 0; i < 10; ++i) {
    publish(500 + i, 500'000 * i);
    pass(2);
    publish(3 + i, 500'000 * i + 200'000);
    pass(3);
  }
  publish(510, 5'000'000);
  EXPECT_EQ(num_taken, 11);
  auto message = reporter.Make(Utime(), {}, bus);
  EXPECT_EQ(message.state, health_t::STATE_DEGRADED);
  EXPECT_NE(message.reason.find("LIDAR_NMEA has two publishers: 10 messages of the second were refused"), std::string::npos) << message.reason;
  EXPECT_NE(message.reason.find("show every lidar by host and pid"), std::string::npos) << message.reason;
  EXPECT_EQ(reporter.Make(Utime(), {HealthState::kFailed, "disk full", {}}, bus).state, health_t::STATE_FAILED);
  pass(599);
  EXPECT_EQ(reporter.Make(Utime(), {}, bus).state, health_t::STATE_DEGRADED);
  pass(1);
  message = reporter.Make(Utime(), {}, bus);
  EXPECT_EQ(message.state, health_t::STATE_OK) << message.reason;
  ASSERT_EQ(message.counters.back().name, "second_publisher");
  EXPECT_EQ(message.counters.back().count, 10);
}

// The recorder alone said that the bus loses messages, and nobody how many scans that costs.
TEST(HealthReporter, SaysHowManyScansTheBusLost) {
  bus::MemoryBus bus;
  std::chrono::nanoseconds now{0};
  bus.GuardStreams([&now] { return now; });
  bus::Subscribe<lidar_scan_t>(bus, bus::kLidarScan, [](const lidar_scan_t&) {});
  HealthReporter reporter("test");
  EXPECT_EQ(reporter.Make(Utime(), {}, bus).state, health_t::STATE_OK);
  for (std::int64_t seq = 0; seq < 20; ++seq) {
    for (std::int32_t part = 0; part < 2; ++part) {
      if ((seq == 5 && part == 1) || seq == 8) continue;
      lidar_scan_t message{};
      message.seq = seq;
      message.utime_us = 100'000 * seq;
      message.part_index = part;
      message.num_parts = 2;
      bus::Publish(bus, bus::kLidarScan, message);
    }
    now += std::chrono::milliseconds(100);
    bus.ReleaseHeld();
    support::HandleAll(bus);
  }
  const auto message = reporter.Make(Utime(), {}, bus);
  EXPECT_EQ(message.state, health_t::STATE_DEGRADED);
  EXPECT_TRUE(message.reason.starts_with("lost on the bus in the last ")) << message.reason;
  EXPECT_NE(message.reason.find(" s: 2 of 20 scans of LIDAR_SCAN (receive buffers too small"), std::string::npos) << message.reason;
}

// A report between two keeps what was measured over the last second: over some milliseconds a rate says nothing.
TEST(HealthReporter, TellsBetweenTwoReportsWhatIsNewAndKeepsTheRates) {
  bus::MemoryBus bus;
  bus::Subscribe<lidar_nmea_t>(bus, bus::kLidarNmea, [](const lidar_nmea_t&) {});
  HealthReporter reporter("test");
  EXPECT_EQ(reporter.MakeBetween(Utime(), {}).num_channels, 0);
  bus::Publish(bus, bus::kLidarNmea, lidar_nmea_t{});
  support::HandleAll(bus);
  const auto whole = reporter.Make(Utime(std::chrono::microseconds(1'000'000)), {}, bus);
  const HealthReport alarmed{HealthState::kDegraded, "obstacle", {{"alarms", 1}}};
  const auto between = reporter.MakeBetween(Utime(std::chrono::microseconds(1'200'000)), alarmed);
  EXPECT_EQ(between.seq, 2);
  EXPECT_EQ(between.utime_us, 1'200'000);
  EXPECT_EQ(between.state, health_t::STATE_DEGRADED);
  EXPECT_EQ(between.reason, "obstacle");
  ASSERT_EQ(between.num_counters, 3);
  EXPECT_EQ(between.counters[0].name, "alarms");
  EXPECT_EQ(between.interval_s, whole.interval_s);
  EXPECT_EQ(between.cpu_fraction, whole.cpu_fraction);
  ASSERT_EQ(between.num_channels, whole.num_channels);
  EXPECT_EQ(between.channels[0].rate_hz, whole.channels[0].rate_hz);
  const auto next = reporter.Make(Utime(std::chrono::microseconds(2'000'000)), {}, bus);
  EXPECT_EQ(next.seq, 3);
  EXPECT_EQ(next.reason, "");
  EXPECT_GT(next.interval_s, 0.0);
}

}  // namespace
}  // namespace lookout::runtime
