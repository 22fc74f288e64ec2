#include "common/core/partition.hpp"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace lookout {
namespace {

using Groups = std::vector<std::int32_t>;
using Pairs = std::vector<EvidencePair>;

Groups GroupsOf(std::int32_t num_pieces, const Pairs& pairs, float threshold = 0.0F, Linkage linkage = Linkage::kMean) {
  Partition partition(linkage);
  partition.Find(num_pieces, pairs, threshold);
  return {partition.group_of_piece().begin(), partition.group_of_piece().end()};
}

TEST(Partition, OfNothingIsNothing) {
  EXPECT_EQ(GroupsOf(0, {}), Groups{});
  EXPECT_EQ(GroupsOf(3, {}), (Groups{0, 1, 2}));
}

TEST(Partition, MergesTheBestFirstAndThenGoesByTheMeanBetweenGroups) {
  // 0 and 1 first; then 2 is (2 - 3) / 2 to them.
  EXPECT_EQ(GroupsOf(3, {{0, 1, 3.0F}, {1, 2, 2.0F}, {0, 2, -3.0F}}), (Groups{0, 0, 1}));
  EXPECT_EQ(GroupsOf(3, {{0, 1, 3.0F}, {1, 2, 2.0F}, {0, 2, -1.0F}}), (Groups{0, 0, 0}));
  // What is better between groups than it was between pieces.
  EXPECT_EQ(GroupsOf(3, {{0, 1, 3.0F}, {1, 2, -1.0F}, {0, 2, 2.0F}}), (Groups{0, 0, 0}));
}

TEST(Partition, OfSumsMergesFirstWhereManyWeakPairsAddUp) {
  // 3 is 1.5 to the three in sum and 0.5 in the mean, 1 to 4.
  const Pairs pairs{{0, 1, 3.0F}, {1, 2, 3.0F}, {0, 3, 0.5F}, {1, 3, 0.5F}, {2, 3, 0.5F}, {3, 4, 1.0F}, {0, 4, -1.2F}};
  EXPECT_EQ(GroupsOf(5, pairs, 0.0F, Linkage::kSum), (Groups{0, 0, 0, 0, 1}));
  EXPECT_EQ(GroupsOf(5, pairs, 0.0F, Linkage::kMean), (Groups{0, 0, 0, 0, 0}));
  EXPECT_EQ(GroupsOf(2, {{0, 1, 0.0F}}, 0.0F, Linkage::kSum), (Groups{0, 1}));
}

TEST(Partition, PairsThatAreNotGivenAreNoEvidence) { EXPECT_EQ(GroupsOf(4, {{2, 3, 1.0F}, {1, 3, 0.5F}}), (Groups{0, 1, 1, 1})); }

TEST(Partition, MergesAboveTheThresholdOnly) {
  EXPECT_EQ(GroupsOf(2, {{0, 1, 0.0F}}), (Groups{0, 1}));
  EXPECT_EQ(GroupsOf(2, {{0, 1, 1.0F}}, 1.0F), (Groups{0, 1}));
  EXPECT_EQ(GroupsOf(2, {{0, 1, 1.1F}}, 1.0F), (Groups{0, 0}));
  EXPECT_EQ(GroupsOf(3, {{0, 1, 3.0F}, {1, 2, 2.0F}, {0, 2, -1.0F}}, 0.6F), (Groups{0, 0, 1}));
}

TEST(Partition, OfEqualEvidenceTheLeastGapComesFirst) {
  EXPECT_EQ(GroupsOf(3, {{0, 1, 1.0F, 2.0F}, {1, 2, 1.0F, 1.0F}, {0, 2, -1.5F, 3.0F}}), (Groups{0, 1, 1}));
  EXPECT_EQ(GroupsOf(3, {{0, 1, 1.0F, 1.0F}, {1, 2, 1.0F, 2.0F}, {0, 2, -1.5F, 3.0F}}), (Groups{0, 0, 1}));
}

// As the header says it, with a look at all pairs for each merge.
Groups Reference(std::int32_t num_pieces, const Pairs& pairs, float threshold, Linkage linkage) {
  Groups group(static_cast<std::size_t>(num_pieces));
  std::iota(group.begin(), group.end(), 0);
  const auto of = [&group](std::int32_t piece) -> std::int32_t& { return group[static_cast<std::size_t>(piece)]; };
  while (true) {
    double most = threshold;
    std::pair<std::int32_t, std::int32_t> best{-1, -1};
    for (std::int32_t one = 0; one < num_pieces; ++one) {
      for (std::int32_t other = one + 1; other < num_pieces; ++other) {
        double sum = 0.0;
        int count = 0;
        for (const auto& pair : pairs) {
          const auto [a, b] = std::minmax(of(pair.one), of(pair.other));
          if (a != one || b != other) continue;
          sum += pair.log_odds;
          ++count;
        }
        const double evidence = linkage == Linkage::kMean ? sum / std::max(1, count) : sum;
        if (count > 0 && evidence > most) {
          most = evidence;
          best = {one, other};
        }
      }
    }
    if (best.first < 0) break;
    std::ranges::replace(group, best.second, best.first);
  }
  // Numbers in the order of the first piece.
  Groups number(group.size(), -1);
  std::int32_t count = 0;
  for (auto& one : group) {
    auto& of_group = number[static_cast<std::size_t>(one)];
    if (of_group < 0) of_group = count++;
    one = of_group;
  }
  return group;
}

Pairs RandomPairs(std::int32_t num_pieces, double share, std::mt19937& random) {
  std::uniform_real_distribution<float> log_odds(-3.0F, 3.0F);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Pairs pairs;
  for (std::int32_t one = 0; one < num_pieces; ++one) {
    for (std::int32_t other = one + 1; other < num_pieces; ++other) {
      if (uniform(random) < share) pairs.push_back({one, other, log_odds(random), 1.0F});
    }
  }
  return pairs;
}

TEST(Partition, IsThatOfTheReference) {
  std::mt19937 random(1);
  // They keep nothing from one round to the next.
  std::array partitions{Partition(Linkage::kMean), Partition(Linkage::kSum)};
  for (int round = 0; round < 300; ++round) {
    const auto num_pieces = static_cast<std::int32_t>(1 + random() % 16);
    const float threshold = round % 3 == 0 ? 0.5F : 0.0F;
    const auto pairs = RandomPairs(num_pieces, round % 2 == 0 ? 0.9 : 0.3, random);
    for (const auto linkage : {Linkage::kMean, Linkage::kSum}) {
      auto& partition = partitions.at(static_cast<std::size_t>(linkage));
      partition.Find(num_pieces, pairs, threshold);
      const Groups groups(partition.group_of_piece().begin(), partition.group_of_piece().end());
      ASSERT_EQ(groups, Reference(num_pieces, pairs, threshold, linkage)) << "round " << round;
      ASSERT_EQ(partition.count(), std::ranges::max(groups) + 1);
    }
  }
}

TEST(Partition, DoesNotDependOnTheOrderOfThePairsOrTheirEnds) {
  std::mt19937 random(2);
  for (int round = 0; round < 50; ++round) {
    constexpr std::int32_t kPieces = 200;
    auto pairs = RandomPairs(kPieces, 0.05, random);
    const auto linkage = round % 2 == 0 ? Linkage::kMean : Linkage::kSum;
    const auto groups = GroupsOf(kPieces, pairs, 0.0F, linkage);
    std::ranges::shuffle(pairs, random);
    for (auto& pair : pairs) {
      if (random() % 2 == 0) std::swap(pair.one, pair.other);
    }
    ASSERT_EQ(GroupsOf(kPieces, pairs, 0.0F, linkage), groups) << "round " << round;
  }
}

// A shore among spray: what is small joins it one by one, and each time its many neighbours need no look.
TEST(Partition, OfALargeGroupWithManyNeighboursIsFast) {
  constexpr std::int32_t kPieces = 100'000;
  Pairs pairs;
  for (std::int32_t piece = 1; piece < kPieces; ++piece) {
    pairs.push_back({0, piece, 1.0F + 1e-6F * static_cast<float>(piece), 1.0F});
    if (piece > 1) pairs.push_back({piece - 1, piece, 0.5F, 1.0F});
  }
  EXPECT_EQ(GroupsOf(kPieces, pairs), Groups(kPieces, 0));
}

}  // namespace
}  // namespace lookout
