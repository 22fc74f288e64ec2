#include "services/navigator/core/measurement.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;
using std::chrono::sys_days;

const sys_days kDay = std::chrono::year(2026) / 6 / 1;
constexpr auto kMaxLatency = 2s;

TEST(TimeOfMeasurement, IsTheArrivalWhenTheSentenceHasNone) {
  const auto when = TimeOfMeasurement(kDay + 12h, std::nullopt, std::nullopt, kMaxLatency);
  EXPECT_EQ(when.time, kDay + 12h);
  EXPECT_FALSE(when.is_from_sentence);
}

TEST(TimeOfMeasurement, IsTheSentencesNearTheArrivalOnBothSides) {
  for (const auto offset : {-2000ms, -400ms, 0ms, 400ms, 2000ms}) {
    const auto when = TimeOfMeasurement(kDay + 12h - offset, 12h, kDay, kMaxLatency);
    EXPECT_EQ(when.time, kDay + 12h);
    EXPECT_EQ(when.arrival, kDay + 12h - offset);
    EXPECT_TRUE(when.is_from_sentence);
  }
}

TEST(TimeOfMeasurement, IsTheArrivalWhenTheSentenceIsFarFromIt) {
  for (const auto offset : {2001ms, -2001ms}) {
    const auto when = TimeOfMeasurement(kDay + 12h + offset, 12h, kDay, kMaxLatency);
    EXPECT_EQ(when.time, kDay + 12h + offset);
    EXPECT_FALSE(when.is_from_sentence);
  }
}

TEST(TimeOfMeasurement, KeepsTheTimeOfDayWhereTheDateIsWrong) {
  for (const auto date : {kDay - std::chrono::days(7168), kDay + std::chrono::days(1)}) {  // 1024 weeks: the receiver's calendar rolled over
    const auto when = TimeOfMeasurement(kDay + 12h + 50ms, 12h, date, kMaxLatency);
    EXPECT_EQ(when.time, kDay + 12h);
    EXPECT_TRUE(when.is_from_sentence);
    EXPECT_TRUE(when.is_date_refused);
  }
}

TEST(TimeOfMeasurement, FindsTheDayAcrossMidnight) {
  EXPECT_EQ(TimeOfMeasurement(kDay + 100ms, 23h + 59min + 59900ms, std::nullopt, kMaxLatency).time, kDay - 100ms);
  EXPECT_EQ(TimeOfMeasurement(kDay - 100ms, 100ms, std::nullopt, kMaxLatency).time, kDay + 100ms);
  EXPECT_EQ(TimeOfMeasurement(kDay + 1s, 24h + 500ms, std::nullopt, kMaxLatency).time, kDay + 500ms) << "the leap second";
}

TEST(TimeOfMeasurement, DoesNotOverflowAtTheBoundsOfTime) {
  const Utime first{std::chrono::microseconds(kMinUtimeUs)};
  const Utime last{std::chrono::microseconds(kMaxUtimeUs)};
  EXPECT_FALSE(TimeOfMeasurement(first, 12h, sys_days(std::chrono::year(2079) / 12 / 31), kMaxLatency).is_from_sentence);
  EXPECT_FALSE(TimeOfMeasurement(last, 12h, sys_days(std::chrono::year(1980) / 1 / 1), kMaxLatency).is_from_sentence);
}

TEST(HorizontalSd, GrowsWithHdopAndShrinksWithCorrections) {
  EXPECT_DOUBLE_EQ(HorizontalSdM(FixQuality::kGnss, 2.0, 2.5), 5.0);
  EXPECT_DOUBLE_EQ(HorizontalSdM(FixQuality::kGnss, kNan, 2.5), 2.5);
  EXPECT_DOUBLE_EQ(HorizontalSdM(FixQuality::kGnss, 0.0, 2.5), 2.5) << "an HDOP of 0 says nothing";
  EXPECT_LT(HorizontalSdM(FixQuality::kDifferential, 1.0, 2.5), 2.5);
  EXPECT_LT(HorizontalSdM(FixQuality::kRtkFloat, 1.0, 2.5), 0.5);
  EXPECT_LT(HorizontalSdM(FixQuality::kRtkFixed, 1.0, 2.5), 0.05);
  EXPECT_GT(HorizontalSdM(FixQuality::kDeadReckoning, 1.0, 2.5), 5.0);
  EXPECT_TRUE(std::isnan(HorizontalSdM(FixQuality::kNone, 1.0, 2.5)));
  EXPECT_TRUE(std::isnan(HorizontalSdM(FixQuality::kSimulator, 1.0, 2.5)));
}

}  // namespace
}  // namespace lookout::navigator
