// A stream of messages through bus::StreamGuard, as tests make it.
#pragma once

#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "common/bus/stream_guard.hpp"

namespace lookout::bus {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Act = StreamGuard::Act;
using Held = StreamGuard::Held;
using Time = StreamGuard::Time;
inline constexpr std::int64_t kPeriodUs = 100'000;

// A guard, and what comes out of it: who made each message that was taken, in their order.
class Stream : public ::testing::Test {
 protected:
  StreamGuard guard_{40.0};
  Time now_{seconds(1000)};
  std::int64_t num_events_ = 0;
  std::int64_t num_lost_ = 0;
  struct Message {
    char maker;
    std::int64_t seq;
    bool operator==(const Message&) const = default;
  };
  std::vector<Message> held_;
  std::vector<Message> taken_;

  void Take(const StreamGuard::Decision& decision, const Message& message) {
    num_lost_ += decision.num_lost;
    if (decision.held == Held::kTake) taken_.insert(taken_.end(), held_.begin(), held_.end());
    if (decision.held != Held::kStay) held_.clear();
    if (decision.act == Act::kHold) held_.push_back(message);
    if (decision.act == Act::kTake) taken_.push_back(message);
    EXPECT_EQ(guard_.is_holding(), !held_.empty());
  }
  // A message of `maker`, by default measured where its number says.
  void Send(char maker, std::int64_t seq, std::int64_t offset_us = 0) { SendAt(maker, seq, seq * kPeriodUs + offset_us); }
  void SendAt(char maker, std::int64_t seq, std::int64_t utime_us) {
    const StreamPlace place{
        .seq = seq, .utime_us = utime_us, .digest = static_cast<std::uint64_t>(maker) * 1'000'003 + static_cast<std::uint64_t>(seq)};
    Take(guard_.Next(place, now_, num_events_++), {maker, seq});
  }
  void Pass(milliseconds time) {
    for (milliseconds passed(0); passed < time; passed += milliseconds(50)) {
      now_ += milliseconds(50);
      Release(guard_.Release(now_));
    }
  }
  void Release(std::optional<std::int64_t> num_lost) {
    if (!num_lost) return;
    num_lost_ += *num_lost;
    taken_.insert(taken_.end(), held_.begin(), held_.end());
    held_.clear();
  }
  // So many of one stream, as they come.
  void Run(char maker, std::int64_t first, std::int64_t number, std::int64_t offset_us = 0) {
    for (std::int64_t seq = first; seq < first + number; ++seq) {
      Send(maker, seq, offset_us);
      Pass(milliseconds(100));
    }
  }
  std::int64_t NumTaken(char maker) const {
    return std::count_if(taken_.begin(), taken_.end(), [maker](const Message& message) { return message.maker == maker; });
  }
  bool HasSecond() const { return guard_.HasSecond(now_, seconds(60)); }
};

}  // namespace lookout::bus
