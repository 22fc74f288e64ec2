#include "services/navigator/core/item_sequencer.hpp"

#include <gtest/gtest.h>

#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

std::string Text(const std::vector<Item>& items) {
  static const char* const kNames[] = {"start", "sentence", "imu", "tick", "end"};
  std::string text;
  for (const auto& item : items) {
    text += Print("%lld %s %.3f\n", static_cast<long long>(item.seq), kNames[static_cast<int>(item.kind)],
                  std::chrono::duration<double>(item.time - NoonPlus(0)).count());
  }
  return text;
}

TEST(ItemSequencer, BeginsWithAStartMark) {
  ItemSequencer sequencer;
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(0.03))), "0 start 0.030\n");
  ItemSequencer other;
  EXPECT_EQ(Text(other.OnLines(NoonPlus(0.03), {"$A", "$B"})), "0 start 0.030\n1 sentence 0.030\n2 sentence 0.030\n");
}

TEST(ItemSequencer, PutsSamplesOfAnImuInTheirPlace) {
  ItemSequencer sequencer;
  const StrapdownSample sample{{0.1, 0.2, 0.3}, {0.0, 0.0, -9.81}};
  EXPECT_EQ(Text(sequencer.OnImu(NoonPlus(0.03), sample, "imu")), "0 start 0.030\n1 imu 0.030\n");
  const auto items = sequencer.OnImu(NoonPlus(0.11), sample, "imu");
  EXPECT_EQ(Text(items), "2 tick 0.100\n3 imu 0.110\n");
  ASSERT_TRUE(items[1].imu);
  EXPECT_EQ(items[1].imu->specific_force_mps2.z(), -9.81);
  EXPECT_EQ(items[1].source, "imu");
  EXPECT_EQ(Text(sequencer.OnImu(NoonPlus(0.05), sample, "imu")), "4 imu 0.110\n");
  sequencer.AdvanceTo(NoonPlus(3.0));
  EXPECT_TRUE(sequencer.OnImu(NoonPlus(1.9), sample, "imu").empty());
}

TEST(ItemSequencer, MakesNothingAtTheEndWhenNothingCame) {
  ItemSequencer sequencer;
  EXPECT_TRUE(sequencer.Finish(NoonPlus(0)).empty());
}

TEST(ItemSequencer, TicksAtWholeMultiplesOf100Ms) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(0.1));
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(0.199))), "");
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(0.2))), "1 tick 0.200\n");
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(0.45))), "2 tick 0.300\n3 tick 0.400\n");
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(0.45))), "");
}

TEST(ItemSequencer, TicksBeforeALaterDatagram) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(0));
  EXPECT_EQ(Text(sequencer.OnLines(NoonPlus(0.25), {"$A"})), "1 tick 0.100\n2 tick 0.200\n3 sentence 0.250\n");
}

TEST(ItemSequencer, ClampsADatagramThatWaited) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(0));
  sequencer.AdvanceTo(NoonPlus(1));
  EXPECT_EQ(Text(sequencer.OnLines(NoonPlus(0), {"$A"})), "11 sentence 1.000\n");
}

TEST(ItemSequencer, RefusesWhatIsMoreThanASecondOff) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(0));
  sequencer.AdvanceTo(NoonPlus(3));
  EXPECT_TRUE(sequencer.OnLines(NoonPlus(1.9), {"$A", "$B"}).empty());
  EXPECT_TRUE(sequencer.OnLidarSentence(NoonPlus(1.9), "$A").empty());
  EXPECT_TRUE(sequencer.OnLidarSentence(NoonPlus(4.1), "$A").empty()) << "the lidar's host has another clock";
  EXPECT_EQ(sequencer.counters()[1].name, "stale_sentence");
  EXPECT_EQ(sequencer.counters()[1].count, 4);
}

TEST(ItemSequencer, LetsALidarSentenceGoAheadWithoutTicks) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(0));
  EXPECT_EQ(Text(sequencer.OnLidarSentence(NoonPlus(0.25), "$A")), "1 sentence 0.250\n");
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(0.3))), "2 tick 0.250\n3 tick 0.250\n4 tick 0.300\n");
}

// A computer that is told of a leap second is set back by a second; slewed clocks never go back.
TEST(ItemSequencer, BeginsAgainWhenTheClockIsSetBackByMoreThanZeroPointFourSeconds) {
  for (const auto& [back_s, expected] : {std::pair(0.4, ""), std::pair(0.41, "0 start 99.590\n"), std::pair(0.9, "0 start 99.100\n")}) {
    ItemSequencer sequencer;
    sequencer.AdvanceTo(NoonPlus(100));
    EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(100 - back_s))), expected) << back_s;
  }
}

TEST(ItemSequencer, BeginsAgainWhenTheClockIsSetBack) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(100));
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(99.6))), "") << "0.4 s is no step";
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(98.99))), "0 start 98.990\n");
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(99))), "1 tick 99.000\n");
  EXPECT_EQ(sequencer.counters()[0].name, "clock_set_back");
  EXPECT_EQ(sequencer.counters()[0].count, 1);
}

// A lidar's sentence of another computer may be ahead: that sets no clock back.
TEST(ItemSequencer, BeginsAgainInALeapSecondButNotBehindALidarSentence) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(100));
  sequencer.OnLidarSentence(NoonPlus(100.9), "$A");
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(100.1))), "2 tick 100.900\n");
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(99.2))), "0 start 99.200\n");
}

TEST(ItemSequencer, SkipsTheTicksOfALongSilence) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(0));
  EXPECT_EQ(sequencer.AdvanceTo(NoonPlus(10)).size(), 100U);
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(1000.05))), "101 tick 1000.000\n");
}

TEST(ItemSequencer, EndsAndBeginsANewSequence) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(0));
  EXPECT_EQ(Text(sequencer.Finish(NoonPlus(0.15))), "1 tick 0.100\n2 end 0.150\n");
  EXPECT_TRUE(sequencer.Finish(NoonPlus(0.2)).empty());
  EXPECT_EQ(Text(sequencer.AdvanceTo(NoonPlus(0.3))), "0 start 0.300\n");
}

TEST(ItemSequencer, EndsNotBeforeItsLastItem) {
  ItemSequencer sequencer;
  sequencer.AdvanceTo(NoonPlus(5));
  EXPECT_EQ(Text(sequencer.Finish(NoonPlus(0))), "1 end 5.000\n");
}

TEST(ItemSequencer, FloorsTicksBefore1970Too) {
  ItemSequencer sequencer;
  const Utime time{-1'950'000us};
  sequencer.AdvanceTo(time);
  const auto items = sequencer.AdvanceTo(time + 60ms);
  ASSERT_EQ(items.size(), 1U);
  EXPECT_EQ(items[0].time, Utime(-1'900'000us));
}

}  // namespace
}  // namespace lookout::navigator
