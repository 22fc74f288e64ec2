// What waits for one client: the newest of each slot, whole groups, everyone's turn.
#include "services/page/core/slots.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace {

using namespace lookout::page;

SharedBytes Frame(std::uint8_t mark, std::size_t size = 1) { return std::make_shared<const std::vector<std::uint8_t>>(size, mark); }

// The marks of all that is taken.
std::vector<int> All(Slots& slots) {
  std::vector<int> marks;
  while (const auto frame = slots.Take()) marks.push_back(frame->front());
  return marks;
}

TEST(Slots, GiveNothingWhenNothingWaits) {
  Slots slots;
  EXPECT_TRUE(slots.is_empty());
  EXPECT_EQ(slots.Take(), nullptr);
}

TEST(Slots, AnewerGroupTakesThePlaceOfAllPartsOfAnOlder) {
  Slots slots;
  slots.Put(1, "", 100, 0, Frame(1));
  slots.Put(1, "", 100, 1, Frame(2));
  slots.Put(1, "", 200, 0, Frame(3));
  EXPECT_EQ(All(slots), std::vector<int>{3});
  EXPECT_EQ(slots.num_replaced(), 2);
}

TEST(Slots, PartsOfAGroupStandTogetherInTheirOrder) {
  Slots slots;
  slots.Put(1, "", 100, 1, Frame(12));
  slots.Put(2, "", 100, 0, Frame(20));
  slots.Put(1, "", 100, 0, Frame(11));
  EXPECT_EQ(All(slots), (std::vector<int>{11, 12, 20}));
  EXPECT_EQ(slots.num_replaced(), 0);
}

// A client that takes a part a scan only would never see a whole scan.
TEST(Slots, AGroupThatHasBegunIsSentToItsEnd) {
  Slots slots;
  slots.Put(1, "", 100, 0, Frame(1));
  slots.Put(1, "", 100, 1, Frame(2));
  EXPECT_EQ(slots.Take()->front(), 1);
  slots.Put(1, "", 200, 0, Frame(3));
  slots.Put(1, "", 300, 0, Frame(4));
  EXPECT_EQ(All(slots), (std::vector<int>{2, 4}));
  EXPECT_EQ(slots.num_replaced(), 1);
}

TEST(Slots, APartThatComesLaterGoesOnWithItsGroup) {
  Slots slots;
  slots.Put(1, "", 100, 0, Frame(1));
  EXPECT_EQ(slots.Take()->front(), 1);
  slots.Put(1, "", 100, 1, Frame(2));
  EXPECT_EQ(All(slots), std::vector<int>{2});
  EXPECT_EQ(slots.num_replaced(), 0);
}

TEST(Slots, ThoseOfOneChannelDoNotReplaceEachOther) {
  Slots slots;
  slots.Put(1, "tracker", 100, 0, Frame(1));
  slots.Put(1, "lidar", 200, 0, Frame(2));
  slots.Put(1, "tracker", 300, 0, Frame(3));
  EXPECT_EQ(All(slots), (std::vector<int>{3, 2}));
}

TEST(Slots, ChannelsTakeTurnsInTheOrderInWhichTheyBecameReady) {
  Slots slots;
  slots.Put(3, "", 1, 0, Frame(3));
  slots.Put(1, "", 1, 0, Frame(1));
  EXPECT_EQ(slots.Take()->front(), 3);
  slots.Put(3, "", 2, 0, Frame(4));
  slots.Put(2, "", 1, 0, Frame(2));
  slots.Put(1, "", 2, 0, Frame(5));  // takes the place, and the turn, of what waited
  EXPECT_EQ(All(slots), (std::vector<int>{5, 4, 2}));
}

TEST(Slots, AChannelThatIsAlwaysReadyWaitsForTheOthers) {
  Slots slots;
  slots.Put(1, "", 0, 0, Frame(1));
  slots.Put(2, "", 0, 0, Frame(2));
  std::vector<int> marks;
  for (int i = 1; i <= 4; ++i) {
    marks.push_back(slots.Take()->front());
    slots.Put(1, "", i, 0, Frame(1));
    slots.Put(2, "", i, 0, Frame(2));
  }
  EXPECT_EQ(marks, (std::vector<int>{1, 2, 1, 2}));
}

TEST(Slots, APartThatComesAgainReplacesItself) {
  Slots slots;
  slots.Put(1, "", 0, 0, Frame(1, 10));
  slots.Put(1, "", 0, 0, Frame(2, 20));
  EXPECT_EQ(slots.num_bytes(), 20U);
  EXPECT_EQ(All(slots), std::vector<int>{2});
  EXPECT_EQ(slots.num_bytes(), 0U);
}

TEST(Slots, ForgetWhatIsNoLongerWatched) {
  Slots slots;
  slots.Put(1, "", 0, 0, Frame(1));
  slots.Put(2, "", 0, 0, Frame(2));
  slots.Put(2, "", 0, 1, Frame(3));
  slots.KeepOnly({2});
  EXPECT_EQ(slots.num_bytes(), 2U);
  EXPECT_EQ(All(slots), (std::vector<int>{2, 3}));
  slots.KeepOnly({});
  slots.Put(2, "", 0, 2, Frame(4));  // of a group that was begun before: it begins again
  EXPECT_EQ(All(slots), std::vector<int>{4});
}

TEST(Slots, HoldNoMoreThanTheirRoom) {
  Slots slots;
  constexpr std::size_t kLarge = Slots::kMaxBytes / 4;
  for (int part = 0; part < 6; ++part) slots.Put(1, "", 0, part, Frame(1, kLarge));
  EXPECT_EQ(slots.num_bytes(), 4 * kLarge);
  EXPECT_EQ(slots.num_dropped(), 2);
  EXPECT_EQ(All(slots).size(), 4U);
  for (std::size_t i = 0; i < Slots::kMaxSlots + 5; ++i) slots.Put(2, std::to_string(i), 0, 0, Frame(1));
  EXPECT_EQ(slots.num_dropped(), 2 + 5);  // the slot of channel 1, which is empty, has made room
}

// What replaces a frame and finds no room leaves an empty slot: it is not ready.
// A process that starts again and again has another slot each time.
TEST(Slots, ThoseThatAreSentMakeRoomForOthers) {
  Slots slots;
  for (int process = 0; process < 1000; ++process) {
    slots.Put(1, std::to_string(process), process, 0, Frame(1));
    ASSERT_NE(slots.Take(), nullptr) << process;
  }
  EXPECT_EQ(slots.num_dropped(), 0);
  for (int process = 0; process < 1000; ++process) slots.Put(1, std::to_string(process), process, 0, Frame(1));
  EXPECT_EQ(slots.num_dropped(), 1000 - static_cast<int>(Slots::kMaxSlots));
  EXPECT_EQ(All(slots).size(), Slots::kMaxSlots);
}

TEST(Slots, AnEmptiedSlotHasNoTurn) {
  Slots slots;
  slots.Put(1, "", 0, 0, Frame(1));
  slots.Put(2, "", 0, 0, Frame(2, Slots::kMaxBytes - 1));
  slots.Put(1, "", 1, 0, Frame(3, 2));
  EXPECT_EQ(All(slots), std::vector<int>{2});
  EXPECT_TRUE(slots.is_empty());
}

}  // namespace
