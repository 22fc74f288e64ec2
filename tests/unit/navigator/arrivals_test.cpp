#include "services/navigator/core/arrivals.hpp"

#include <gtest/gtest.h>
#include <vector>

#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

class ArrivalsTest : public ::testing::Test {
 protected:
  bool Add(double time_s) { return arrivals_.Add(NoonPlus(time_s)); }
  // Returns how many were refused.
  int AddEvenly(double begin_s, double end_s, double interval_s) {
    int num_refused = 0;
    const int num = static_cast<int>((end_s - begin_s) / interval_s + 0.5);
    for (int i = 0; i < num; ++i) num_refused += Add(begin_s + i * interval_s) ? 0 : 1;
    return num_refused;
  }

  Arrivals arrivals_;
};

TEST_F(ArrivalsTest, UsesAllOfAnEvenSensor) {
  for (const double interval_s : {0.0025, 0.01, 0.1, 1.0}) {
    arrivals_ = {};
    EXPECT_EQ(AddEvenly(0.0, 60.0, interval_s), 0) << interval_s;
  }
}

TEST_F(ArrivalsTest, UsesAllThatComesSeveralAtOnce) {
  int num_refused = 0;
  for (int i = 0; i < 1000; ++i) num_refused += Add(0.08 * (i / 8)) ? 0 : 1;
  EXPECT_EQ(num_refused, 0);
}

TEST_F(ArrivalsTest, RefusesAQueueToItsLast) {
  for (const double drained_s : {0.0, 0.1, 0.9}) {
    for (const double interval_s : {0.01, 0.1, 1.0}) {
      arrivals_ = {};
      EXPECT_EQ(AddEvenly(0.0, 30.0, interval_s), 0);
      const int num_waiting = static_cast<int>(13.0 / interval_s + 0.5);  // till 43 s
      for (int i = 0; i < num_waiting; ++i) EXPECT_FALSE(Add(42.0 + drained_s * i / num_waiting)) << i;
      const int num_refused = AddEvenly(43.0, 60.0, interval_s);
      EXPECT_LE(num_refused * interval_s, 2.5) << interval_s << ", " << drained_s;
    }
  }
}

TEST_F(ArrivalsTest, UsesASensorThatComesBackWithoutAQueue) {
  for (const double interval_s : {0.01, 0.1, 1.0}) {
    arrivals_ = {};
    EXPECT_EQ(AddEvenly(0.0, 30.0, interval_s), 0);
    const int num_refused = AddEvenly(42.0, 60.0, interval_s);
    EXPECT_GE(num_refused, 1) << "it might have been a queue";
    EXPECT_LE(num_refused * interval_s, 3.0) << interval_s;
  }
}

TEST_F(ArrivalsTest, FollowsASensorThatSendsAtAnotherRate) {
  EXPECT_EQ(AddEvenly(0.0, 30.0, 0.1), 0);
  EXPECT_LE(AddEvenly(31.0, 60.0, 1.0), 2);
  EXPECT_EQ(AddEvenly(60.0, 90.0, 0.1), 0);
}

TEST_F(ArrivalsTest, BeginsWithAQueue) {
  for (int i = 0; i < 500; ++i) Add(0.0);
  EXPECT_LE(AddEvenly(0.1, 60.0, 0.1), 3);
}

// A sensor that was off and sends more often now must not be refused for as long as it was away.
TEST_F(ArrivalsTest, ASensorThatComesBackFasterIsUsedSoon) {
  for (const double interval_s : {0.5, 0.1}) {
    arrivals_ = {};
    AddEvenly(0.0, 60.0, 1.0);
    AddEvenly(660.0, 676.0, interval_s);
    EXPECT_EQ(AddEvenly(676.0, 700.0, interval_s), 0) << interval_s;
  }
}

}  // namespace
}  // namespace lookout::navigator
