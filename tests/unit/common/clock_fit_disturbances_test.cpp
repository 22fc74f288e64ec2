// The fit of two clocks while deliveries are late and the host's clock is set: the true offset is known.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "common/core/clock_fit.hpp"
#include "tests/unit/common/late_arrivals.hpp"

namespace lookout {
namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kDriftPpm = 30.0;

struct Worst {
  double late_us = 0.0;   // at any time: of an estimate that is above the truth
  double after_us = 0.0;  // from 5 s after the end of the disturbance
  double drift_ppm = 0.0;
  double last_drift_ppm = 0.0;
};

// A sensor that sends every `period`, and is heard through the disturbance.
Worst Play(const late::Disturbance& disturbance, microseconds period, double network_us) {
  ClockFit fit;
  Worst worst;
  std::mt19937 random(7);
  std::exponential_distribution<double> delay_us(1.0 / network_us);
  microseconds last_delivery(0);
  for (microseconds sent(0); sent < disturbance.end + 60s; sent += period) {
    const auto delivery = std::max(last_delivery + 5us, disturbance.Delivery(sent) + microseconds(std::llround(delay_us(random))));
    last_delivery = delivery;
    const microseconds sensor = sent + microseconds(std::llround(kDriftPpm * 1e-6 * static_cast<double>(sent.count())));
    fit.Add(sensor, delivery + disturbance.HostError(delivery) - sensor);
    const auto truth = sent - sensor + disturbance.HostError(delivery);
    const auto error_us = static_cast<double>((fit.offset() - truth).count());
    if (delivery > 5s) worst.late_us = std::max(worst.late_us, error_us);
    if (delivery > disturbance.end + 5s) worst.after_us = std::max(worst.after_us, std::abs(error_us));
    if (fit.drift_ppm()) worst.drift_ppm = std::max(worst.drift_ppm, std::abs(*fit.drift_ppm()));
  }
  worst.last_drift_ppm = fit.drift_ppm().value_or(1e9);
  return worst;
}

TEST(ClockFitDisturbances, LateDeliveriesChangeNeitherOffsetNorDrift) {
  for (const auto& disturbance : late::LateDeliveries()) {
    SCOPED_TRACE(disturbance.name);
    const auto worst = Play(disturbance, 1327us, 100.0);
    EXPECT_LT(worst.late_us, 2000.0);
    EXPECT_LT(worst.after_us, 500.0);
    EXPECT_LT(worst.drift_ppm, 60.0);
    EXPECT_NEAR(worst.last_drift_ppm, kDriftPpm, 2.0);
  }
}

TEST(ClockFitDisturbances, LateDeliveriesOfASlowSourceChangeNeitherOffsetNorDrift) {
  for (const auto period : {100ms, 1000ms}) {
    for (const auto& disturbance : late::LateDeliveries()) {
      SCOPED_TRACE(disturbance.name + ", every " + std::to_string(period.count()) + " ms");
      const auto worst = Play(disturbance, period, 1000.0);
      EXPECT_LT(worst.after_us, 6000.0);
      EXPECT_LE(worst.drift_ppm, ClockFit::kMaxDriftPpm);
    }
  }
}

TEST(ClockFitDisturbances, AStepOfTheHostIsFollowedWithinFiveSecondsAndKeepsTheDrift) {
  for (const auto period : {1327us, 100'000us, 1'000'000us}) {
    for (const auto& disturbance : late::ClockSteps()) {
      SCOPED_TRACE(disturbance.name + ", every " + std::to_string(period.count()) + " us");
      const auto worst = Play(disturbance, period, 100.0);
      EXPECT_LT(worst.after_us, 500.0);
      EXPECT_LE(worst.drift_ppm, ClockFit::kMaxDriftPpm);
      EXPECT_NEAR(worst.last_drift_ppm, kDriftPpm, 5.0);
    }
  }
}

TEST(ClockFitDisturbances, AStepWhileDeliveriesAreLateIsFollowedToo) {
  for (const auto step : {500ms, -500ms, 5000ms}) {
    auto disturbance = late::RandomStalls(3);
    disturbance.steps.push_back({40s, step});
    SCOPED_TRACE(std::to_string(step.count()) + " ms");
    EXPECT_LT(Play(disturbance, 1327us, 100.0).after_us, 500.0);
  }
}

// A queue that is drained at twice the pace of what fills it says for seconds that the host is ahead, a little less each time.
TEST(ClockFitDisturbances, AQueueThatIsDrainedSlowlyIsNoStep) {
  ClockFit fit;
  for (microseconds sent(0); sent < 80s; sent += 1327us) {
    const microseconds late = sent < 30s || sent > 54s ? 0us : microseconds(12s - (sent - 30s) / 2);
    fit.Add(sent, 100us + late);
    EXPECT_NEAR(static_cast<double>(fit.offset().count()), 100.0, 50.0) << sent.count();
  }
}

// A moment between two stalls lets out what waited in the first: late by a second, then by twelve, for fourteen seconds and of more than three.
TEST(ClockFitDisturbances, TwoStallsWithAMomentBetweenThemAreNoStep) {
  late::Disturbance disturbance{"two stalls", {{26'405ms, 27'585ms}, {27'588ms, 41'873ms}}, {}, 41'873ms};
  for (const auto period : {1327us, 100'000us, 1'000'000us}) EXPECT_LT(Play(disturbance, period, 100.0).late_us, 5000.0) << period.count();
}

// In one second after the other the source's clock went back to the same instant: the slope between them was divided by a time of 0.
TEST(ClockFitDisturbances, AClockThatGoesBackWithinASecondLeavesTheDriftFinite) {
  ClockFit fit;
  for (int i = 0; i < 30; ++i) {
    fit.Add(seconds(i), 100us);
    fit.Add(950ms, microseconds(50 - i));
    EXPECT_LE(std::abs(fit.drift_ppm().value_or(0.0)), ClockFit::kMaxDriftPpm) << i;
    EXPECT_LT(std::abs(static_cast<double>(fit.offset().count())), 1000.0) << i;
  }
}

TEST(ClockFitDisturbances, AClockThatGoesBackNowAndThenDoesNotMoveTheOffset) {
  std::mt19937 random(11);
  for (int run = 0; run < 50; ++run) {
    ClockFit fit;
    microseconds time(0);
    for (int i = 0; i < 3000; ++i) {
      time += 10ms;
      if (random() % 40 == 0) time -= milliseconds(random() % 200 * 10);
      fit.Add(time, microseconds(100 + random() % 3000));
      ASSERT_LT(std::abs(static_cast<double>(fit.offset().count())), 5e3);
      ASSERT_LE(std::abs(fit.drift_ppm().value_or(0.0)), ClockFit::kMaxDriftPpm);
    }
  }
}

}  // namespace
}  // namespace lookout
