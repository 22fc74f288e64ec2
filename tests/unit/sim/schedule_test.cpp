#include <gtest/gtest.h>
#include <vector>

#include "tools/sim/sinks.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

constexpr Utime kSimulated{1'000'000s};
const Schedule::Clock::time_point kDue{100h};

TEST(Schedule, HasADeadlineForEachDatagram) {
  EXPECT_EQ(Schedule(kSimulated, kDue, 1.0).DueAt(kSimulated + 10s), kDue + 10s);
  EXPECT_EQ(Schedule(kSimulated, kDue, 4.0).DueAt(kSimulated + 10s), kDue + 2500ms);
  EXPECT_EQ(Schedule(kSimulated, kDue, 0.0).DueAt(kSimulated + 10s), kDue);
}

// It went on without a word: what heard it saw a late lidar.
TEST(Schedule, SaysOnceASecondByHowMuchItIsBehind) {
  Schedule schedule(kSimulated, kDue, 1.0);
  std::vector<std::string> told;
  auto now = kDue;
  for (int i = 0; i < 500; ++i) {
    const auto time = kSimulated + i * 10ms;
    now = std::max(now, schedule.DueAt(time));
    now += 15ms;  // to make one takes longer than there is time
    if (const auto line = schedule.Report(time, now)) told.push_back(*line);
  }
  ASSERT_EQ(told.size(), 8U) << "7.5 s of the clock, from 0.12 s on";
  EXPECT_EQ(told[0].substr(0, 6), "0.06 s");
  EXPECT_EQ(told[7].substr(0, 6), "2.40 s");
  EXPECT_EQ(schedule.Summary(), "492 of 500 datagrams were sent more than 0.05 s late, the latest 2.51 s");
}

TEST(Schedule, SaysNothingOfOneThatIsKeptOrThatThereIsNone) {
  Schedule kept(kSimulated, kDue, 1.0);
  Schedule none(kSimulated, kDue, 0.0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(kept.Report(kSimulated + i * 10ms, kDue + i * 10ms + 49ms));
    EXPECT_FALSE(none.Report(kSimulated + i * 10ms, kDue + 1h));
  }
  EXPECT_EQ(kept.Summary() + none.Summary(), "");
}

TEST(Schedule, TellsOfEachStretchThatIsLate) {
  Schedule schedule(kSimulated, kDue, 2.0);
  EXPECT_TRUE(schedule.Report(kSimulated + 2s, kDue + 1s + 60ms));
  EXPECT_FALSE(schedule.Report(kSimulated + 4s, kDue + 2s));
  EXPECT_TRUE(schedule.Report(kSimulated + 6s, kDue + 3s + 60ms));
}

}  // namespace
}  // namespace lookout::sim
