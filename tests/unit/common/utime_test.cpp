#include "common/core/utime.hpp"

#include <gtest/gtest.h>

namespace lookout {
namespace {

using namespace std::chrono_literals;
using std::chrono::days;
using std::chrono::year;

constexpr Utime kMidnight = std::chrono::sys_days(year(2026) / 7 / 1);

TEST(Utime, OfATimeOfDayIsOnTheNearestDay) {
  EXPECT_EQ(OnTheDayNearest(kMidnight + 1s, 23h + 59min + 59s), kMidnight - 1s);
  EXPECT_EQ(OnTheDayNearest(kMidnight - 1s, 0h), kMidnight);
  EXPECT_EQ(OnTheDayNearest(kMidnight + 1h, 13h - 1us), kMidnight + 13h - 1us);
  EXPECT_EQ(OnTheDayNearest(kMidnight + 1h, 13h + 1us), kMidnight - 11h + 1us);
  EXPECT_EQ(OnTheDayNearest(kMidnight + 500ms, 24h), kMidnight) << "a leap second is the first of the next day";
  EXPECT_EQ(OnTheDayNearest(Utime(-1s), 0h), Utime());
}

TEST(Utime, OfADateIsMendedByWholeRolloversAlone) {
  constexpr days kRollover(7 * 1024);
  for (const int number : {-1, 0, 1, 2}) {
    const auto off = number * kRollover;
    EXPECT_EQ(MendRollover(kMidnight - off, kMidnight + 1s), kMidnight) << number;
    EXPECT_EQ(MendRollover(kMidnight - off, kMidnight + 24h), kMidnight) << number;
    EXPECT_EQ(MendRollover(kMidnight - off, kMidnight - 24h), kMidnight) << number;
    EXPECT_EQ(MendRollover(kMidnight - off, kMidnight + 24h + 1us), kMidnight - off) << number;
    EXPECT_EQ(MendRollover(kMidnight - off, kMidnight - 24h - 1us), kMidnight - off) << number;
  }
}

}  // namespace
}  // namespace lookout
