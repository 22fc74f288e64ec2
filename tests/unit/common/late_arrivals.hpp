// When messages come that were sent in time: stalls, bursts of a busy computer, steps of its clock. For tests of clocks; driven by message time.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace lookout::late {

/// Nothing that is sent in [begin, end) is delivered before `end`.
struct Stall {
  std::chrono::microseconds begin{0};
  std::chrono::microseconds end{0};
};

/// The host's clock is set by so much.
struct ClockStep {
  std::chrono::microseconds time{0};
  std::chrono::microseconds step{0};
};

/// What happens, in true time since the start.
struct Disturbance {
  std::string name;
  std::vector<Stall> stalls;
  std::vector<ClockStep> steps;
  std::chrono::microseconds end{0};  // from here on all is well

  /// What the host's clock is ahead of the true time.
  std::chrono::microseconds HostError(std::chrono::microseconds time) const {
    std::chrono::microseconds error(0);
    for (const auto& step : steps) {
      if (time >= step.time) error += step.step;
    }
    return error;
  }

  /// @return true time of the delivery of what was sent at `sent`, without what a network takes: in the order of sending
  std::chrono::microseconds Delivery(std::chrono::microseconds sent) const {
    auto delivery = sent;
    for (const auto& stall : stalls) {
      if (delivery >= stall.begin && delivery < stall.end) delivery = stall.end;
    }
    return delivery;
  }
};

inline Disturbance StoppedFor12SecondsAndDrained() {
  using std::chrono::seconds;
  return {"stopped for 12 s and drained at once", {{seconds(30), seconds(42)}}, {}, seconds(42)};
}

inline Disturbance StoppedFor300MsAHundredTimes() {
  using std::chrono::milliseconds;
  Disturbance disturbance{"stopped 0.3 s and continued, 100 times", {}, {}, milliseconds(30'000 + 100 * 600)};
  for (int i = 0; i < 100; ++i) disturbance.stalls.push_back({milliseconds(30'000 + 600 * i), milliseconds(30'300 + 600 * i)});
  return disturbance;
}

/// The computer gives the process a moment of time now and then: what waited comes in a burst.
inline Disturbance BusyComputer(unsigned seed) {
  using std::chrono::microseconds;
  using std::chrono::seconds;
  Disturbance disturbance{"busy computer, seed " + std::to_string(seed), {}, {}, seconds(60)};
  std::mt19937 random(seed);
  for (microseconds time = seconds(30); time < seconds(60);) {
    const microseconds length(1000 + static_cast<std::int64_t>(random() % 400'000));
    disturbance.stalls.push_back({time, time + length});
    time += length + microseconds(random() % 20'000);
  }
  disturbance.stalls.back().end = std::min<microseconds>(disturbance.stalls.back().end, seconds(60));
  return disturbance;
}

/// From 10 ms to 15 s, with 1 ms to 5 s between them, one in four of them within a second of the one before.
inline Disturbance RandomStalls(unsigned seed) {
  using std::chrono::microseconds;
  using std::chrono::seconds;
  Disturbance disturbance{"random stalls, seed " + std::to_string(seed), {}, {}, seconds(90)};
  std::mt19937 random(seed);
  for (microseconds time = seconds(25); time < seconds(90);) {
    const std::int64_t most_us = random() % 3 == 0 ? 15'000'000 : 1'500'000;
    const microseconds begin = time + microseconds(1000 + static_cast<std::int64_t>(random()) % (random() % 4 == 0 ? 1'000'000 : 5'000'000));
    const microseconds end = begin + microseconds(10'000 + static_cast<std::int64_t>(random()) % most_us);
    if (end > seconds(90)) break;
    disturbance.stalls.push_back({begin, end});
    time = end;
  }
  if (!disturbance.stalls.empty()) disturbance.end = disturbance.stalls.back().end;
  return disturbance;
}

inline std::vector<Disturbance> LateDeliveries() {
  std::vector<Disturbance> disturbances{StoppedFor12SecondsAndDrained(), StoppedFor300MsAHundredTimes()};
  for (unsigned seed = 1; seed <= 3; ++seed) disturbances.push_back(BusyComputer(seed));
  for (unsigned seed = 1; seed <= 20; ++seed) disturbances.push_back(RandomStalls(seed));
  return disturbances;
}

inline std::vector<Disturbance> ClockSteps() {
  using std::chrono::milliseconds;
  std::vector<Disturbance> disturbances;
  for (const std::int64_t step_ms : {500, -500, 1000, -1000, 5000, -5000, 3'600'000, -3'600'000}) {
    disturbances.push_back(
        {"host clock set by " + std::to_string(step_ms) + " ms", {}, {{milliseconds(30'000), milliseconds(step_ms)}}, milliseconds(30'000)});
  }
  return disturbances;
}

}  // namespace lookout::late
