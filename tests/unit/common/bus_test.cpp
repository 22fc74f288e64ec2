#include "common/bus/bus.hpp"

#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/memory_bus.hpp"
#include "lookout/lidar_nmea_t.hpp"

namespace lookout::bus {
namespace {

lidar_nmea_t Sentence(std::int64_t seq) {
  lidar_nmea_t message{};
  message.seq = seq;
  message.sentence = "$GPRMC";
  return message;
}

void HandleAll(Bus& bus) {
  while (bus.HandleOnce(std::chrono::milliseconds(0))) {
  }
}

TEST(MemoryBus, HandlesMessagesInTheOrderOfPublication) {
  MemoryBus bus;
  std::vector<std::int64_t> seen;
  Subscribe<lidar_nmea_t>(bus, kLidarNmea, [&](const lidar_nmea_t& message) {
    seen.push_back(message.seq);
    if (message.seq == 0) Publish(bus, kLidarNmea, Sentence(2));  // goes behind what waits already
  });
  Publish(bus, kLidarNmea, Sentence(0));
  Publish(bus, kLidarNmea, Sentence(1));
  HandleAll(bus);
  EXPECT_EQ(seen, (std::vector<std::int64_t>{0, 1, 2}));
}

TEST(Subscribe, CountsGapsInSeq) {
  MemoryBus bus;
  Subscribe<lidar_nmea_t>(bus, kLidarNmea, [](const lidar_nmea_t&) {});
  for (const int seq : {0, 1, 5}) Publish(bus, kLidarNmea, Sentence(seq));
  HandleAll(bus);
  EXPECT_EQ(bus.input_traffic().at("LIDAR_NMEA").num_lost, 3);
  EXPECT_EQ(bus.input_traffic().at("LIDAR_NMEA").num_messages, 3);
}

TEST(Subscribe, CountsWhatDoesNotDecodeAndGoesOn) {
  MemoryBus bus;
  int num_handled = 0;
  Subscribe<lidar_nmea_t>(bus, kLidarNmea, [&](const lidar_nmea_t&) { ++num_handled; });
  auto bytes = Encode(Sentence(0));
  bytes.push_back(0);  // trailing byte
  bus.Publish(kLidarNmea, bytes);
  bytes.resize(bytes.size() / 2);  // cut short
  bus.Publish(kLidarNmea, bytes);
  bus.Publish(kLidarNmea, Bytes());
  Publish(bus, kLidarNmea, Sentence(0));
  HandleAll(bus);
  EXPECT_EQ(num_handled, 1);
  EXPECT_EQ(bus.input_traffic().at("LIDAR_NMEA").num_undecodable, 3);
}

TEST(Publish, RefusesAMessageThatLcmWouldLoseInSilence) {
  MemoryBus bus;
  const std::vector<std::uint8_t> bytes(kMaxMessageBytes + 1);
  EXPECT_THROW(bus.Publish(kLidarScan, bytes), std::runtime_error);
}

TEST(SubscribeAll, SeesEveryChannel) {
  MemoryBus bus;
  std::vector<std::string> seen;
  bus.SubscribeAll([&](std::string_view channel, Bytes) { seen.emplace_back(channel); });
  Publish(bus, kLidarNmea, Sentence(0));
  Publish(bus, kHealth, Sentence(1));
  HandleAll(bus);
  EXPECT_EQ(seen, (std::vector<std::string>{"LIDAR_NMEA", "HEALTH"}));
}

TEST(Encode, ThrowsWhenACountDoesNotAgreeWithAString) {
  auto message = Sentence(0);
  message.sentence = std::string("a\0b", 3);  // LCM encodes strings up to the first zero
  EXPECT_THROW(Encode(message), std::logic_error);
}

// LCM's in-process provider: the same client code as the live bus, without a network.
TEST(LcmBus, CarriesMessagesAndRethrowsWhatAHandlerThrew) {
  LcmBus bus("memq://");
  int num_handled = 0;
  Subscribe<lidar_nmea_t>(bus, kLidarNmea, [&](const lidar_nmea_t& message) {
    ++num_handled;
    if (message.seq == 1) throw std::runtime_error("from the handler");
  });
  Publish(bus, kLidarNmea, Sentence(0));
  EXPECT_TRUE(bus.HandleOnce(std::chrono::milliseconds(1000)));
  Publish(bus, kLidarNmea, Sentence(1));
  EXPECT_THROW(bus.HandleOnce(std::chrono::milliseconds(1000)), std::runtime_error);
  Publish(bus, kLidarNmea, Sentence(2));
  EXPECT_TRUE(bus.HandleOnce(std::chrono::milliseconds(1000)));
  EXPECT_EQ(num_handled, 3);
}

TEST(LcmBus, SaysWhatIsWrongWithAnAddress) { EXPECT_THROW(LcmBus("nonsense://"), std::runtime_error); }

TEST(ChannelTable, HasNoTwins) {
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    for (std::size_t k = i + 1; k < kChannels.size(); ++k) {
      EXPECT_NE(kChannels[i].name, kChannels[k].name);
      EXPECT_NE(kChannels[i].type, kChannels[k].type);
    }
  }
}

TEST(ChannelTable, QueuesHoldTwoSecondsAtTheGreatestRate) {
  for (const auto& channel : kChannels) EXPECT_GE(channel.queue_depth, 2 * channel.max_rate_hz) << channel.name;
}

}  // namespace
}  // namespace lookout::bus
