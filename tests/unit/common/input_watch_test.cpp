#include "common/core/input_watch.hpp"

#include <array>
#include <gtest/gtest.h>

namespace lookout {
namespace {

Utime At_s(double time_s) { return Utime(std::chrono::microseconds(1'000'000'000 + static_cast<std::int64_t>(1e6 * time_s))); }

TEST(InputWatch, SaysForHowLongNothingCame) {
  InputWatch watch("POSE");
  watch.Note();
  EXPECT_EQ(watch.Complaint(), "") << "no time is known";
  watch.AdvanceTo(At_s(0.0));
  watch.AdvanceTo(At_s(1.9));
  EXPECT_EQ(watch.Complaint(), "");
  watch.AdvanceTo(At_s(2.0));
  EXPECT_EQ(watch.Complaint(), "no POSE for 2 s");
  watch.Note();
  EXPECT_EQ(watch.Complaint(), "");
  watch.AdvanceTo(At_s(5.5));
  EXPECT_EQ(watch.Complaint(), "no POSE for 3 s");
}

TEST(InputWatch, WaitsAnewWhereTheClockIsSetBack) {
  InputWatch watch("POSE");
  watch.AdvanceTo(At_s(100.0));
  watch.AdvanceTo(At_s(0.0));
  EXPECT_EQ(watch.silence(), std::chrono::microseconds(0));
  watch.AdvanceTo(At_s(2.5));
  EXPECT_EQ(watch.Complaint(), "no POSE for 2 s");
}

TEST(InputWatch, NamesSeveralInOneSentence) {
  std::array<InputWatch, 3> watches{InputWatch("POSE"), InputWatch("TRACKS"), InputWatch("ALERTS")};
  for (auto& watch : watches) watch.AdvanceTo(At_s(0.0));
  EXPECT_EQ(InputWatch::Complaint(watches), "");
  for (auto& watch : watches) watch.AdvanceTo(At_s(3.0));
  watches[1].Note();
  for (auto& watch : watches) watch.AdvanceTo(At_s(4.0));
  EXPECT_EQ(InputWatch::Complaint(watches), "no POSE, ALERTS for 4 s");
}

}  // namespace
}  // namespace lookout
