#include "lab/sim/faulty_network.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <vector>

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

constexpr int kDataPort = 2368;
constexpr int kOtherPort = 10110;
const Utime kFaultsStart = Utime(1'781'532'600s);

struct Run {
  std::vector<Datagram> datagrams;
  std::vector<Fault> faults;
  FaultTotals totals;
};

// The number of a datagram among those of its port.
int NumberOf(const Datagram& datagram) { return datagram.payload[0] + 256 * datagram.payload[1]; }

Datagram Make(Utime time, int port, int number) {
  return {time, port, {static_cast<std::uint8_t>(number % 256), static_cast<std::uint8_t>(number / 256)}};
}

// Data packets every 1327 us, the first after 1 ms; something else every 50 us.
std::vector<Datagram> Datagrams(std::chrono::microseconds duration) {
  std::vector<Datagram> datagrams;
  int num_data = 0;
  int num_other = 0;
  for (auto time = 50us; time < duration; time += 50us) {
    datagrams.push_back(Make(kFaultsStart + time, kOtherPort, num_other++));
    const auto data_time = 1000us + num_data * 1327us;
    if (data_time < time + 50us) datagrams.push_back(Make(kFaultsStart + data_time, kDataPort, num_data++));
  }
  return datagrams;
}

Run RunAll(const FaultParams& params, const std::vector<Datagram>& datagrams, std::chrono::microseconds duration, std::uint64_t seed = 1) {
  Run run;
  auto next = datagrams.begin();
  FaultyNetwork network([&]() -> std::optional<Datagram> { return next == datagrams.end() ? std::nullopt : std::optional(*next++); },
                        [&](const Fault& fault) { run.faults.push_back(fault); }, params, kDataPort, kFaultsStart, kFaultsStart + duration, seed);
  while (auto datagram = network.Next()) run.datagrams.push_back(std::move(*datagram));
  EXPECT_FALSE(network.Next());
  run.totals = network.totals();
  return run;
}

Run RunAll(const FaultParams& params, std::chrono::microseconds duration, std::uint64_t seed = 1) {
  return RunAll(params, Datagrams(duration), duration, seed);
}

std::vector<int> DataNumbers(const Run& run) {
  std::vector<int> numbers;
  for (const auto& datagram : run.datagrams) {
    if (datagram.port == kDataPort) numbers.push_back(NumberOf(datagram));
  }
  return numbers;
}

TEST(FaultyNetwork, ChangesNothingWithoutFaults) {
  const auto datagrams = Datagrams(200ms);
  const auto run = RunAll({}, datagrams, 200ms);
  ASSERT_EQ(run.datagrams.size(), datagrams.size());
  for (std::size_t i = 0; i < datagrams.size(); ++i) {
    EXPECT_EQ(run.datagrams[i].time, datagrams[i].time);
    EXPECT_EQ(run.datagrams[i].port, datagrams[i].port);
    EXPECT_EQ(run.datagrams[i].payload, datagrams[i].payload);
  }
  EXPECT_TRUE(run.faults.empty());
  EXPECT_EQ(run.totals.num_made, 150);
  EXPECT_EQ(run.totals.num_sent, 150);
}

TEST(FaultyNetwork, GivesNothingOutOfNothing) {
  const auto run = RunAll({0.1, 0.1, 0.1}, std::vector<Datagram>{}, 10s);
  EXPECT_TRUE(run.datagrams.empty());
  EXPECT_EQ(run.totals.num_made, 0);
}

TEST(FaultyNetwork, ADroppedPacketNeverComes) {
  const auto run = RunAll({1.0, 0.0, 0.0}, 100ms);
  // Made 1 ms + 1.327 ms k after the start; spared before 30 ms and after 70 ms.
  std::vector<int> expected;
  for (int k = 0; k < 75; ++k) {
    if (1.0 + 1.327 * k < 30.0 || 1.0 + 1.327 * k > 70.0) expected.push_back(k);
  }
  EXPECT_EQ(DataNumbers(run), expected);
  EXPECT_EQ(run.totals.num_made, 75);
  EXPECT_EQ(run.totals.num_sent, static_cast<std::int64_t>(expected.size()));
  EXPECT_EQ(run.totals.num_dropped, 75 - run.totals.num_sent);
  ASSERT_EQ(run.faults.size(), static_cast<std::size_t>(run.totals.num_dropped));
  EXPECT_EQ(run.faults[0].packet_index, 22);
  EXPECT_EQ(run.faults[0].time, kFaultsStart + 1000us + 22 * 1327us);
}

TEST(FaultyNetwork, ADoubledPacketComesTwiceInARow) {
  const auto run = RunAll({0.0, 1.0, 0.0}, 100ms);
  std::vector<int> expected;
  for (int k = 0; k < 75; ++k) {
    expected.push_back(k);
    if (1.0 + 1.327 * k >= 30.0 && 1.0 + 1.327 * k <= 70.0) expected.push_back(k);
  }
  EXPECT_EQ(DataNumbers(run), expected);
  EXPECT_EQ(run.totals.num_doubled, static_cast<std::int64_t>(expected.size()) - 75);
  EXPECT_EQ(run.totals.num_sent, static_cast<std::int64_t>(expected.size()));
}

TEST(FaultyNetwork, ASwappedPacketComesRightAfterTheNextAndThatOneIsLeftAlone) {
  const auto run = RunAll({0.0, 0.0, 1.0}, 100ms);
  std::vector<int> expected;
  int num_pairs = 0;
  for (int k = 0; k < 75; ++k) {
    if (1.0 + 1.327 * k >= 30.0 && 1.0 + 1.327 * k <= 70.0) {
      expected.insert(expected.end(), {k + 1, k});
      ++k;
      ++num_pairs;
    } else {
      expected.push_back(k);
    }
  }
  EXPECT_EQ(DataNumbers(run), expected);
  EXPECT_EQ(run.totals.num_swapped, num_pairs);
  EXPECT_EQ(run.totals.num_sent, 75);
  ASSERT_GE(run.faults.size(), 2U);
  EXPECT_EQ(run.faults[0].packet_index, 22);
  EXPECT_EQ(run.faults[1].packet_index, 24);
  EXPECT_EQ(run.faults[0].time, kFaultsStart + 1000us + 22 * 1327us);
  // Never before it was measured.
  for (const auto& datagram : run.datagrams) {
    if (datagram.port != kDataPort) continue;
    EXPECT_GE(datagram.time, kFaultsStart + 1000us + NumberOf(datagram) * 1327us);
  }
}

TEST(FaultyNetwork, TimesNeverGoBackAndOtherDatagramsPassUntouched) {
  const auto datagrams = Datagrams(10s);
  const auto run = RunAll({0.2, 0.3, 0.4}, datagrams, 10s);
  for (std::size_t i = 1; i < run.datagrams.size(); ++i) ASSERT_GE(run.datagrams[i].time, run.datagrams[i - 1].time);
  const auto others = [](const std::vector<Datagram>& all) {
    std::vector<std::pair<Utime, int>> found;
    for (const auto& datagram : all) {
      if (datagram.port == kOtherPort) found.emplace_back(datagram.time, NumberOf(datagram));
    }
    return found;
  };
  EXPECT_EQ(others(run.datagrams), others(datagrams));
}

TEST(FaultyNetwork, WhatItTellsIsWhatHappened) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto run = RunAll({0.05, 0.02, 0.03}, 10s, seed);
    std::map<int, int> num_seen;
    std::map<int, int> num_late;
    int highest = -1;
    for (const int number : DataNumbers(run)) {
      if (number < highest && num_seen[number] == 0) ++num_late[number];
      ++num_seen[number];
      highest = std::max(highest, number);
    }
    FaultTotals told;
    int last_faulty = -1;
    for (const auto& fault : run.faults) {
      const int number = static_cast<int>(fault.packet_index);
      EXPECT_GT(number, last_faulty) << "one fault a packet, in order; seed " << seed;
      last_faulty = number;
      EXPECT_EQ(num_seen[number], fault.kind == FaultKind::kDropped ? 0 : fault.kind == FaultKind::kDoubled ? 2 : 1) << "seed " << seed;
      EXPECT_EQ(num_late[number], fault.kind == FaultKind::kSwapped ? 1 : 0) << "seed " << seed;
      if (fault.kind == FaultKind::kSwapped) last_faulty = number + 1;
      ++(fault.kind == FaultKind::kDropped ? told.num_dropped : fault.kind == FaultKind::kDoubled ? told.num_doubled : told.num_swapped);
    }
    EXPECT_EQ(told.num_dropped, run.totals.num_dropped);
    EXPECT_EQ(told.num_doubled, run.totals.num_doubled);
    EXPECT_EQ(told.num_swapped, run.totals.num_swapped);
    EXPECT_EQ(run.totals.num_sent, run.totals.num_made - run.totals.num_dropped + run.totals.num_doubled);
    EXPECT_EQ(run.totals.num_sent, static_cast<std::int64_t>(DataNumbers(run).size()));
    // 7490 packets may be faulty: within five standard deviations of what was asked for (an overtaking packet draws in vain).
    EXPECT_NEAR(static_cast<double>(told.num_dropped), 7490 * 0.05 * 0.97, 100.0);
    EXPECT_NEAR(static_cast<double>(told.num_doubled), 7490 * 0.02 * 0.97, 65.0);
    EXPECT_NEAR(static_cast<double>(told.num_swapped), 7490 * 0.03 * 0.97, 80.0);
  }
}

TEST(FaultyNetwork, SameSeedSameFaultsAndAnotherSeedOthers) {
  const FaultParams params{0.05, 0.02, 0.02};
  EXPECT_EQ(DataNumbers(RunAll(params, 2s, 7)), DataNumbers(RunAll(params, 2s, 7)));
  EXPECT_NE(DataNumbers(RunAll(params, 2s, 7)), DataNumbers(RunAll(params, 2s, 8)));
}

TEST(FaultyNetwork, FaultsForAPartOfTheRunHitThatPartAlone) {
  FaultParams params;
  params.timed = {ParseTimedFault("drop:1:2:0.3"), ParseTimedFault("double:3:4:1"), ParseTimedFault("imu_stop:5:6")};
  const auto run = RunAll(params, 8s);
  for (const auto& fault : run.faults) {
    const auto since_start = fault.time - kFaultsStart;
    if (fault.kind == FaultKind::kDropped) {
      EXPECT_TRUE(since_start >= 1s && since_start < 2s);
    } else {
      EXPECT_EQ(fault.kind, FaultKind::kDoubled);
      EXPECT_TRUE(since_start >= 3s && since_start < 4s);
    }
  }
  EXPECT_NEAR(static_cast<double>(run.totals.num_dropped), 753 * 0.3, 60.0);
  EXPECT_NEAR(static_cast<double>(run.totals.num_doubled), 753, 1.0);
}

TEST(FaultyNetwork, RefusesSharesThatAreMoreThanOneAtAnyTime) {
  FaultParams params{0.5, 0.0, 0.0};
  params.timed = {ParseTimedFault("swap:1:2:0.6")};
  EXPECT_THROW(RunAll(params, 3s), std::invalid_argument);
  params.timed = {ParseTimedFault("swap:1:2:0.5")};
  EXPECT_NO_THROW(RunAll(params, 3s));
}

TEST(FaultyNetwork, APacketThatNothingOvertakesComesAtTheEnd) {
  const auto run = RunAll({0.0, 0.0, 1.0}, {Make(kFaultsStart + 50ms, kDataPort, 0)}, 100ms);
  EXPECT_EQ(DataNumbers(run), std::vector<int>{0});
  EXPECT_EQ(run.totals.num_swapped, 0);
  EXPECT_EQ(run.totals.num_sent, 1);
}

}  // namespace
}  // namespace lookout::sim
