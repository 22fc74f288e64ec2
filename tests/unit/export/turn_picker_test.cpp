#include "tools/export/turn_picker.hpp"

#include <gtest/gtest.h>

namespace lookout::exporter {
namespace {

constexpr std::int32_t kPartialEnd = lidar_scan_t::FLAG_PARTIAL_END;

TEST(TurnPicker, TakesTheLastWholeTurn) {
  TurnPicker<int> picker(std::nullopt);
  picker.Add({.utime_us = 100, .seq = 0}, 1);
  picker.Add({.utime_us = 200, .seq = 1}, 2);
  picker.Add({.utime_us = 300, .seq = 2, .scan_flags = kPartialEnd}, 3);
  picker.Finish();
  EXPECT_EQ(picker.parts(), std::vector{2});
  EXPECT_EQ(picker.place().seq, 1);
}

TEST(TurnPicker, TakesAPartialTurnWhenNoneIsWhole) {
  TurnPicker<int> picker(std::nullopt);
  picker.Add({.utime_us = 100, .seq = 0, .scan_flags = kPartialEnd}, 1);
  picker.Finish();
  EXPECT_EQ(picker.parts(), std::vector{1});
}

TEST(TurnPicker, GathersThePartsOfATurnAndCallsOneWithAMissingPartNotWhole) {
  TurnPicker<int> picker(std::nullopt);
  picker.Add({.utime_us = 100, .seq = 0, .part_index = 0, .num_parts = 2}, 1);
  picker.Add({.utime_us = 100, .seq = 0, .part_index = 1, .num_parts = 2}, 2);
  picker.Add({.utime_us = 200, .seq = 1, .part_index = 1, .num_parts = 2}, 3);
  picker.Finish();
  EXPECT_EQ(picker.parts(), (std::vector{1, 2}));
}

TEST(TurnPicker, TakesTheFirstTurnOfTheWantedNumberAndIsThenDone) {
  TurnPicker<int> picker(1);
  picker.Add({.utime_us = 100, .seq = 0}, 1);
  picker.Add({.utime_us = 200, .seq = 1}, 2);
  EXPECT_FALSE(picker.IsDone());  // a further part may come
  picker.Add({.utime_us = 300, .seq = 2}, 3);
  EXPECT_TRUE(picker.IsDone());
  picker.Add({.utime_us = 900, .seq = 1}, 4);  // after a restart
  picker.Finish();
  EXPECT_EQ(picker.parts(), std::vector{2});
}

TEST(TurnPicker, HoldsNothingWhenTheWantedTurnDoesNotCome) {
  TurnPicker<int> picker(5);
  picker.Add({.utime_us = 100, .seq = 0}, 1);
  picker.Finish();
  EXPECT_TRUE(picker.parts().empty());
}

TEST(TurnPicker, TakesARepeatedTurnAsAnotherOne) {
  TurnPicker<int> picker(std::nullopt);
  picker.Add({.utime_us = 100, .seq = 0}, 1);
  picker.Add({.utime_us = 100, .seq = 0}, 2);
  picker.Finish();
  EXPECT_EQ(picker.parts(), std::vector{2});
}

}  // namespace
}  // namespace lookout::exporter
