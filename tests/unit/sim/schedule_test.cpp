#include "tools/sim/schedule.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

constexpr Utime kStart{1'000'000s};
const Schedule::Clock::time_point kBase{100h};

TEST(Schedule, HasADeadlineForEachDatagram) {
  EXPECT_EQ(Schedule(kStart, kBase, 1.0).DueAt(kStart + 10s), kBase + 10s);
  EXPECT_EQ(Schedule(kStart, kBase, 4.0).DueAt(kStart + 10s), kBase + 2500ms);
  EXPECT_EQ(Schedule(kStart, kBase, 0.0).DueAt(kStart + 10s), kBase);
}

// It went on without a word: what heard it saw a late lidar.
TEST(Schedule, TellsOnceASecondByHowMuchItIsBehind) {
  Schedule schedule(kStart, kBase, 1.0);
  std::vector<std::string> told;
  auto now = kBase;
  for (int i = 0; i < 500; ++i) {
    const auto time = kStart + i * 10ms;
    now = std::max(now, schedule.DueAt(time));
    now += 15ms;  // to make one takes longer than there is time
    if (const auto line = schedule.Tell(time, now)) told.push_back(*line);
  }
  ASSERT_EQ(told.size(), 8U) << "7.5 s of the clock, from 0.12 s on";
  EXPECT_EQ(told[0].substr(0, 6), "0.06 s");
  EXPECT_EQ(told[7].substr(0, 6), "2.40 s");
  EXPECT_EQ(schedule.Summary(), "492 of 500 datagrams went out more than 0.05 s late, the latest 2.51 s");
}

TEST(Schedule, SaysNothingOfOneThatIsKeptOrThatThereIsNone) {
  Schedule kept(kStart, kBase, 1.0);
  Schedule none(kStart, kBase, 0.0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(kept.Tell(kStart + i * 10ms, kBase + i * 10ms + 49ms));
    EXPECT_FALSE(none.Tell(kStart + i * 10ms, kBase + 1h));
  }
  EXPECT_EQ(kept.Summary() + none.Summary(), "");
}

TEST(Schedule, TellsOfEachStretchThatIsLate) {
  Schedule schedule(kStart, kBase, 2.0);
  EXPECT_TRUE(schedule.Tell(kStart + 2s, kBase + 1s + 60ms));
  EXPECT_FALSE(schedule.Tell(kStart + 4s, kBase + 2s));
  EXPECT_TRUE(schedule.Tell(kStart + 6s, kBase + 3s + 60ms));
}

}  // namespace
}  // namespace lookout::sim
