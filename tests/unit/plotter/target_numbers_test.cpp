#include "services/plotter/core/target_numbers.hpp"

#include <gtest/gtest.h>
#include <map>
#include <random>
#include <vector>

#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using namespace std::chrono_literals;
using test::MakeTarget;

std::vector<Target> MakeTargets(int first_id, int count) {
  std::vector<Target> targets;
  for (int i = 0; i < count; ++i) targets.push_back(MakeTarget(first_id + i));
  return targets;
}

TEST(PlotterNumbers, StayWithTheirTarget) {
  TargetNumbers numbers(60s);
  auto targets = MakeTargets(1, 3);
  numbers.Assign(targets, 0s);
  EXPECT_EQ(numbers.Of(1), 0);
  EXPECT_EQ(numbers.Of(3), 2);
  std::swap(targets[0], targets[2]);
  numbers.Assign(targets, 1s);
  EXPECT_EQ(numbers.Of(1), 0);
  EXPECT_EQ(numbers.Of(3), 2);
  EXPECT_FALSE(numbers.Of(4).has_value());
}

TEST(PlotterNumbers, AreKeptFromOthersForAMinute) {
  TargetNumbers numbers(60s);
  numbers.Assign(MakeTargets(1, 1), 0s);
  numbers.Release(1, 10s);
  numbers.Assign(MakeTargets(2, 80), 69s);
  EXPECT_FALSE(numbers.Of(81).has_value());  // 79 were free
  EXPECT_EQ(numbers.num_without(), 1);
  for (int id = 2; id <= 80; ++id) EXPECT_NE(numbers.Of(id), 0);
  numbers.Assign(MakeTargets(2, 80), 70s);
  EXPECT_EQ(numbers.Of(81), 0);
  EXPECT_EQ(numbers.num_without(), 0);
  EXPECT_EQ(numbers.num_overflows(), 1);
}

TEST(PlotterNumbers, LeaveSomeToWhatIsDangerous) {
  TargetNumbers numbers(60s);
  auto targets = MakeTargets(1, 500);
  numbers.Assign(targets, 0s);
  EXPECT_EQ(numbers.num_used(), 80);
  EXPECT_EQ(numbers.num_without(), 420);
  targets.insert(targets.begin(), MakeTarget(1000));
  targets.front().level = Level::kWarning;
  numbers.Assign(targets, 1s);
  EXPECT_EQ(numbers.Of(1000), 80);
  EXPECT_EQ(numbers.num_overflows(), 420);
}

// An hour of dense traffic.
TEST(PlotterNumbers, AreNeverUsedTwiceWithinAMinute) {
  std::mt19937 random(5);
  TargetNumbers numbers(60s);
  std::vector<Target> targets;
  std::map<int, std::pair<std::int64_t, std::chrono::seconds>> last;  // by number: who had it, and until when
  std::int64_t next_id = 1;
  int num_reused = 0;
  for (std::chrono::seconds now(0); now < 3600s; ++now) {
    for (auto target = targets.begin(); target != targets.end();) {
      if (random() % 60 != 0) {
        ++target;
        continue;
      }
      numbers.Release(target->id, now);
      target = targets.erase(target);
    }
    while (targets.size() < 90) {
      targets.push_back(MakeTarget(next_id++));
      if (random() % 5 == 0) targets.back().level = Level::kCaution;
    }
    numbers.Assign(targets, now);
    std::map<int, std::int64_t> at_once;
    for (const auto& target : targets) {
      const auto number = numbers.Of(target.id);
      if (!number) continue;
      ASSERT_TRUE(at_once.emplace(*number, target.id).second);
      const auto before = last.find(*number);
      if (before != last.end() && before->second.first != target.id) {
        ++num_reused;
        ASSERT_GE(now - before->second.second, 60s);
      }
      last[*number] = {target.id, now};
    }
  }
  EXPECT_GT(num_reused, 500);
}

}  // namespace
}  // namespace lookout::plotter
