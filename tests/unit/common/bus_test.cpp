#include "common/bus/bus.hpp"

#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/memory_bus.hpp"
#include "lookout/alert_ack_t.hpp"
#include "lookout/alerts_t.hpp"
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

// Two publishers by turns, a restart, and a stop of this process.
class GuardedSubscribe : public ::testing::Test {
 protected:
  MemoryBus bus_;
  std::chrono::nanoseconds now_{0};
  std::vector<std::string> taken_;

  void SetUp() override {
    bus_.GuardStreams([this] { return now_; });
    Subscribe<lidar_nmea_t>(bus_, kLidarNmea,
                            [this](const lidar_nmea_t& message) { taken_.push_back(message.sentence + std::to_string(message.seq)); });
  }
  void Send(const std::string& maker, std::int64_t seq, std::int64_t utime_us) {
    lidar_nmea_t message{};
    message.seq = seq;
    message.utime_us = utime_us;
    message.sentence = maker;
    Publish(bus_, kLidarNmea, message);
    HandleAll(bus_);
  }
  void Pass(std::chrono::milliseconds time) {
    for (; time.count() > 0; time -= std::chrono::milliseconds(100)) {
      now_ += std::chrono::milliseconds(100);
      bus_.ReleaseHeld();
    }
  }
  const ChannelTraffic& Traffic() { return bus_.input_traffic().at("LIDAR_NMEA"); }
};

TEST_F(GuardedSubscribe, KeepsThePublisherThatItHeardFirst) {
  for (int i = 0; i < 5; ++i) {
    Send("a", 70 + i, 200'000 * i);
    Pass(std::chrono::milliseconds(100));
    Send("b", i, 200'000 * i + 50'000);
    Pass(std::chrono::milliseconds(100));
  }
  EXPECT_EQ(taken_, (std::vector<std::string>{"a70", "a71", "a72", "a73", "a74"}));
  EXPECT_EQ(Traffic().num_refused, 4);  // the last is held: a may have ended
  EXPECT_TRUE(Traffic().second_heard);
}

// Page and plotter both send acknowledgements, and each counts from 0.
TEST_F(GuardedSubscribe, TakesAllPublishersOfAcknowledgements) {
  std::vector<std::string> sources;
  Subscribe<alert_ack_t>(bus_, kAlertAck,
                         [&sources](const alert_ack_t& message) { sources.push_back(message.source + std::to_string(message.seq)); });
  for (int i = 0; i < 3; ++i) {
    alert_ack_t message{};
    message.utime_us = 1'000'000 * i;
    message.seq = i;
    for (const auto* source : {"page", "plotter"}) {
      message.source = source;
      Publish(bus_, kAlertAck, message);
      message.seq += 100;
    }
  }
  HandleAll(bus_);
  EXPECT_EQ(sources, (std::vector<std::string>{"page0", "plotter100", "page1", "plotter101", "page2", "plotter102"}));
  EXPECT_EQ(bus_.input_traffic().at("ALERT_ACK").num_lost, 0);
}

// Where no scan comes, ALERTS go out all the same, with the number of the last scan.
TEST_F(GuardedSubscribe, TakesAlertsThatRepeatTheNumberOfTheLastScan) {
  std::vector<std::string> texts;
  Subscribe<alerts_t>(bus_, kAlerts, [&texts](const alerts_t& message) {
    texts.push_back(std::to_string(message.seq) + (message.is_watch ? " " + message.alerts.at(0).text : ""));
  });
  alerts_t message{};
  const auto send = [&](std::chrono::milliseconds pause) {
    Pass(pause);
    Publish(bus_, kAlerts, message);
    HandleAll(bus_);
  };
  for (message.seq = 0; message.seq < 3; ++message.seq, message.utime_us += 100'000) send(std::chrono::milliseconds(100));
  --message.seq;
  message.utime_us -= 100'000;
  message.is_watch = true;
  message.num_alerts = 1;
  message.alerts.resize(1);
  for (const auto* text : {"0.5 s", "1.0 s"}) {
    message.alerts[0].text = text;
    send(std::chrono::milliseconds(500));
  }
  message.is_watch = false;
  message.seq = 9;
  message.utime_us += 700'000;
  send(std::chrono::milliseconds(100));
  EXPECT_EQ(texts, (std::vector<std::string>{"0", "1", "2", "2 0.5 s", "2 1.0 s", "9"}));
  EXPECT_EQ(bus_.input_traffic().at("ALERTS").num_refused, 0);
}

TEST_F(GuardedSubscribe, HandsOutARestartInItsOrderAlsoWhenNothingFurtherComes) {
  for (int i = 0; i < 3; ++i) Send("a", 70 + i, 100'000 * i);
  for (int i = 0; i < 3; ++i) Send("b", i, 1'000'000 + 100'000 * i);
  EXPECT_EQ(taken_.size(), 3U);
  Pass(std::chrono::milliseconds(1000));
  EXPECT_EQ(taken_, (std::vector<std::string>{"a70", "a71", "a72", "b0", "b1", "b2"}));
  EXPECT_EQ(Traffic().num_refused, 0);
  EXPECT_EQ(Traffic().num_lost, 0);
}

TEST_F(GuardedSubscribe, HandsOutWhatIsHeldAtTheEnd) {
  Send("a", 70, 0);
  Send("b", 0, 1'000'000);
  bus_.ReleaseHeld(true);
  EXPECT_EQ(taken_, (std::vector<std::string>{"a70", "b0"}));
}

TEST_F(GuardedSubscribe, AStopOfThisProcessIsNoSilenceOfAPublisher) {
  for (int i = 0; i < 5; ++i) {
    Send("a", 70 + i, 200'000 * i);
    Send("b", i, 200'000 * i + 50'000);
    Pass(std::chrono::milliseconds(200));
  }
  now_ += std::chrono::seconds(10);  // both wait in the queue
  for (int i = 5; i < 55; ++i) {
    Send("b", i, 200'000 * i + 50'000);
    Send("a", 70 + i, 200'000 * i + 100'000);
  }
  EXPECT_EQ(taken_.size(), 55U);
  EXPECT_EQ(taken_.back(), "a124");
}

TEST_F(GuardedSubscribe, HoldsNoMoreThanThereIsRoomFor) {
  Send("a", 70'000, 0);
  for (int i = 0; i < 20'000; ++i) Send("b", i, 1'000'000 + i);
  EXPECT_EQ(Traffic().num_refused, 15'000);
  Pass(std::chrono::milliseconds(1200));
  ASSERT_EQ(taken_.size(), 5001U);
  EXPECT_EQ(taken_[1], "b15000");
  EXPECT_EQ(taken_.back(), "b19999");
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
  bus.Publish(kLidarNmea, {});
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
      // A second lidar has the types of the first.
      EXPECT_TRUE(kChannels[i].type != kChannels[k].type || IsOfSecondLidar(kChannels[k])) << kChannels[k].name;
    }
  }
}

TEST(ChannelTable, QueuesHoldTwoSecondsAtTheGreatestRate) {
  for (const auto& channel : kChannels) EXPECT_GE(channel.queue_depth, 2 * channel.max_rate_hz) << channel.name;
}

}  // namespace
}  // namespace lookout::bus
