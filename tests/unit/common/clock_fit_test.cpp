#include "common/core/clock_fit.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace lookout {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr microseconds kPeriod(1327);

TEST(ClockFit, TakesTheLeastDelayedPacketOfTheLastTwoSeconds) {
  ClockFit fit;
  const auto at = [&](microseconds time, microseconds delay) {
    fit.Add(time, delay);
    return fit.offset();
  };
  EXPECT_EQ(at(milliseconds(0), microseconds(900)), microseconds(900));
  EXPECT_EQ(at(milliseconds(1), microseconds(100)), microseconds(100));
  EXPECT_EQ(at(milliseconds(2), microseconds(5000)), microseconds(100));
  EXPECT_EQ(at(milliseconds(2500), microseconds(5000)), microseconds(100));
  EXPECT_EQ(at(milliseconds(3600), microseconds(5000)), microseconds(5000));  // the best one has left the window
}

TEST(ClockFit, FindsTheDriftUnderDelaysAndOutliers) {
  for (const double drift_ppm : {-50.0, 0.0, 7.0, 50.0}) {
    ClockFit fit;
    std::mt19937 random(1);
    std::exponential_distribution<double> delay_us(1.0 / 150.0);
    double worst_us = 0.0;
    for (int i = 0; i < 45'000; ++i) {  // a minute
      const microseconds time = i * kPeriod;
      const double true_us = 1e9 - drift_ppm * 1e-6 * static_cast<double>(time.count());
      // For three seconds the network is jammed: no datagram comes in time.
      const double jam_us = i > 15'000 && i < 17'300 ? 20'000.0 : 0.0;
      fit.Add(time, microseconds(std::llround(true_us + delay_us(random) + jam_us)));
      if (i > 20'000) worst_us = std::max(worst_us, std::abs(static_cast<double>(fit.offset().count()) - true_us));
    }
    ASSERT_TRUE(fit.drift_ppm());
    EXPECT_NEAR(*fit.drift_ppm(), drift_ppm, 0.2);
    EXPECT_LT(worst_us, 10.0);
  }
}

TEST(ClockFit, SaysNoDriftBeforeTenSeconds) {
  ClockFit fit;
  for (int i = 0; i < 7000; ++i) fit.Add(i * kPeriod, microseconds(5));
  EXPECT_FALSE(fit.drift_ppm());
  for (int i = 7000; i < 9000; ++i) fit.Add(i * kPeriod, microseconds(5));
  EXPECT_EQ(fit.drift_ppm(), 0.0);
}

TEST(ClockFit, IsNotMisledByOneBadStampAndFollowsAStep) {
  ClockFit fit;
  const auto offset_after = [&fit](int packet, microseconds error) {
    fit.Add(packet * kPeriod, microseconds(1000) + error);
    return fit.offset();
  };
  const auto offset = offset_after(1, seconds(0));
  EXPECT_EQ(offset_after(2, -std::chrono::days(3650)), offset);
  EXPECT_EQ(offset_after(3, seconds(0)), offset);
  EXPECT_EQ(offset_after(4, -seconds(100)), offset);
  EXPECT_EQ(offset_after(5, -seconds(100)), offset);
  EXPECT_EQ(offset_after(6, -seconds(100)), offset - seconds(100)) << "too early to be late";
  // Forward it may be late: not till three seconds are over.
  const int num_packets = static_cast<int>(seconds(3) / kPeriod);
  for (int packet = 7; packet < 7 + num_packets; ++packet) ASSERT_EQ(offset_after(packet, seconds(0)), offset - seconds(100)) << packet;
  offset_after(7 + num_packets, seconds(0));
  EXPECT_EQ(offset_after(8 + num_packets, seconds(0)), offset);
}

TEST(ClockFit, SettlesOnWhatIsTheSameForThreeSeconds) {
  ClockFit fit;
  // A queue that is drained at the start.
  for (int i = 0; i < 100; ++i) {
    fit.Add(milliseconds(100 * i), seconds(10) - milliseconds(99 * i));
    EXPECT_FALSE(fit.is_settled()) << i;
  }
  for (int i = 100; i < 130; ++i) {
    fit.Add(milliseconds(100 * i), milliseconds(90));
    EXPECT_FALSE(fit.is_settled()) << i;
  }
  fit.Add(seconds(13), milliseconds(90));
  EXPECT_TRUE(fit.is_settled());
}

TEST(ClockFit, KeepsTheDriftAcrossASmallStepOfTheHost) {
  for (const auto step : {milliseconds(-40), milliseconds(40)}) {
    ClockFit fit;
    const auto run = [&](int from_s, int to_s, microseconds error) {
      for (auto time = microseconds(seconds(from_s)); time < seconds(to_s); time += kPeriod) {
        fit.Add(time, error - microseconds(static_cast<std::int64_t>(20e-6 * static_cast<double>(time.count()))));
      }
    };
    run(0, 20, microseconds(0));
    EXPECT_NEAR(*fit.drift_ppm(), 20.0, 0.1);
    run(20, 25, step);
    EXPECT_NEAR(static_cast<double>((fit.offset() - step).count()), -20.0 * 25, 45.0) << step.count();
    run(25, 40, step);
    EXPECT_NEAR(*fit.drift_ppm(), 20.0, 0.1) << step.count();
    EXPECT_NEAR(static_cast<double>((fit.offset() - step).count()), -20.0 * 40, 1.0) << step.count();
  }
}

}  // namespace
}  // namespace lookout
