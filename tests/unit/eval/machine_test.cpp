#include "lab/eval/report/machine.hpp"

#include <gtest/gtest.h>
#include <sstream>

#include "lab/eval/report/report.hpp"

namespace lookout::eval {
namespace {

lidar_clock_t Clock(std::int64_t seq, std::int64_t num_packets, std::int64_t num_lost) {
  lidar_clock_t message{};
  message.seq = seq;
  message.time_source = lidar_clock_t::TIME_SENSOR;
  message.num_packets = num_packets;
  message.num_lost_packets = num_lost;
  return message;
}

health_t Health(std::int64_t num_messages, std::int64_t p50_us, std::int64_t p99_us) {
  health_t message{};
  message.process = "segmenter";
  health_channel_t channel{};
  channel.channel = "LIDAR_SCAN";
  channel.is_input = 1;
  channel.num_messages = num_messages;
  channel.num_lost = 2;
  channel.num_undecodable = 1;
  channel.handling_p50_us = p50_us;
  channel.handling_p99_us = p99_us;
  message.channels.push_back(channel);
  message.num_channels = 1;
  return message;
}

TEST(Machine, PacketCountsGoOnOverAStartMark) {
  Machine machine;
  machine.Add(Clock(0, 75, 0));
  machine.Add(Clock(1, 150, 3));
  machine.Add(Clock(0, 70, 1));
  EXPECT_EQ(machine.packets.num_packets, 220);
  EXPECT_EQ(machine.packets.num_lost, 4);
  EXPECT_EQ(machine.num_scans_by_sensor, 3);
}

TEST(Machine, TimesAreOfReportsInWhichAMessageCame) {
  Machine machine;
  machine.Add(Health(10, 500, 900));
  machine.Add(Health(20, 600, 4000));
  machine.Add(Health(20, -1, -1));
  const auto& traffic = machine.traffic.at({"segmenter", {false, "LIDAR_SCAN"}});
  EXPECT_EQ(traffic.num_messages, 20);
  EXPECT_EQ(traffic.num_lost, 2);
  EXPECT_EQ(traffic.num_undecodable, 1);
  EXPECT_EQ(traffic.p50_us.count(), 2U);
  EXPECT_DOUBLE_EQ(traffic.p99_us.Max(), 4000.0);
  std::ostringstream text;
  PrintMachine(text, machine);
  EXPECT_NE(text.str().find("LIDAR_SCAN"), std::string::npos);
  EXPECT_NE(text.str().find("4.000"), std::string::npos);
}

TEST(Machine, SaysWhenALogHoldsNoHealth) {
  std::ostringstream text;
  PrintMachine(text, Machine{});
  EXPECT_NE(text.str().find("no HEALTH"), std::string::npos);
}

}  // namespace
}  // namespace lookout::eval
