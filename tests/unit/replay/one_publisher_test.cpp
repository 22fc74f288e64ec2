#include "tools/replay/one_publisher.hpp"

#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"

namespace lookout::replay {
namespace {

using std::chrono::milliseconds;

class OnePublisherOfALog : public ::testing::Test {
 protected:
  Utime time_{std::chrono::seconds(1'800'000'000)};
  std::int64_t num_events_ = 0;
  std::vector<std::string> taken_;  // "NAV_RAW 3 @ 120": number, and milliseconds since the start of the log
  OnePublisher one_publisher_{[this](Utime time, const bus::Channel& channel, Bytes bytes) {
    const auto header = bus::ReadHeader(bytes);
    const auto since_start = time - Utime(std::chrono::seconds(1'800'000'000));
    taken_.push_back(std::string(channel.name) + " " + std::to_string(header ? header->seq : -1) + " @ " +
                     std::to_string(since_start / milliseconds(1)));
  }};

  template <typename T>
  void Add(const bus::Channel& channel, std::int64_t seq, int milliseconds_later) {
    time_ += milliseconds(milliseconds_later);
    T message{};
    message.seq = seq;
    message.utime_us = ToUtimeUs(time_);
    one_publisher_.Add(num_events_++, time_, channel, bus::Encode(message));
  }
  void NavRaw(std::int64_t seq, int milliseconds_later = 20) { Add<nav_raw_t>(bus::kNavRaw, seq, milliseconds_later); }
  void Pose(std::int64_t seq, int milliseconds_later = 20) { Add<pose_t>(bus::kPose, seq, milliseconds_later); }
};

TEST_F(OnePublisherOfALog, HandsOnAllOfALogWithRestartsInItsOrder) {
  std::vector<std::string> expected;
  std::int64_t pose = 0;
  for (int restart = 0; restart < 5; ++restart) {
    for (std::int64_t seq = 0; seq < 70; ++seq) {
      NavRaw(seq);
      const auto now = [this] { return " @ " + std::to_string((time_ - Utime(std::chrono::seconds(1'800'000'000))) / milliseconds(1)); };
      expected.push_back("NAV_RAW " + std::to_string(seq) + now());
      Pose(pose);
      expected.push_back("POSE " + std::to_string(pose++) + now());
    }
  }
  one_publisher_.Finish();
  EXPECT_EQ(taken_, expected);
  EXPECT_EQ(one_publisher_.num_left_out(), 0);
  EXPECT_TRUE(one_publisher_.Interleavings().empty());
}

TEST_F(OnePublisherOfALog, LeavesOutTheSecondOfTwoAndSaysFromWhere) {
  for (int i = 0; i < 10; ++i) NavRaw(700 + i);
  for (int i = 0; i < 50; ++i) {
    NavRaw(i);
    Pose(i);
    NavRaw(710 + i);
  }
  one_publisher_.Finish();
  EXPECT_EQ(taken_.size(), 110U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(taken_[i].rfind("NAV_RAW " + std::to_string(700 + i) + " ", 0), 0U) << taken_[i];
  const auto interleavings = one_publisher_.Interleavings();
  ASSERT_EQ(interleavings.size(), 1U);
  EXPECT_EQ(interleavings[0].channel, "NAV_RAW");
  EXPECT_EQ(interleavings[0].event, 10);
  EXPECT_EQ(interleavings[0].num_messages, 50);
}

// POSE of two navigators of one switch, for the same instants, five at once: told apart as the live readers do.
TEST_F(OnePublisherOfALog, LeavesOutTheSecondOfTwoOfTheSameInstants) {
  std::int64_t num_events = 0;
  const auto send = [&](std::int64_t seq, double latitude_deg, std::int64_t instant) {
    pose_t message{};
    message.seq = seq;
    message.utime_us = 1'800'000'000'000'000 + instant * 20'000;
    message.latitude_deg = latitude_deg;
    one_publisher_.Add(num_events++, time_, bus::kPose, bus::Encode(message));
  };
  for (std::int64_t i = 0; i < 400; i += 5) {
    time_ += milliseconds(100);
    for (std::int64_t k = i; i >= 50 && k < i + 5; ++k) send(k + 1, 51.0, k);
    for (std::int64_t k = i; k < i + 5; ++k) send(k, 50.0, k);
  }
  one_publisher_.Finish();
  EXPECT_EQ(taken_.size(), 400U);
  EXPECT_EQ(one_publisher_.num_left_out(), 350);
}

TEST_F(OnePublisherOfALog, HandsOnWhatItsReadersRefuse) {
  NavRaw(700);
  const std::vector<std::uint8_t> noise(40, 7);
  one_publisher_.Add(1, time_, bus::kNavRaw, noise);
  one_publisher_.Add(2, time_, bus::kNavRaw, {});
  one_publisher_.Add(3, time_, bus::kHealth, noise);
  EXPECT_EQ(taken_.size(), 4U);
}

TEST_F(OnePublisherOfALog, HoldsNoMoreThanThereIsRoomFor) {
  NavRaw(700);
  NavRaw(0);
  // Sixty megabytes and more within a moment, of another channel.
  const std::vector<std::uint8_t> large(100'000, 1);
  for (int i = 0; i < 700; ++i) one_publisher_.Add(2 + i, time_, bus::kLidarPackets, large);
  EXPECT_GE(taken_.size(), 701U);
  EXPECT_EQ(one_publisher_.num_left_out(), 1);
  one_publisher_.Finish();
  EXPECT_EQ(taken_.size(), 701U);
}

}  // namespace
}  // namespace lookout::replay
