// What is known of pieces, and of pieces that were joined.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "services/segmenter/core/lookout/pieces.hpp"
#include "tests/unit/segmenter/lookout_stages.hpp"

namespace lookout::segmenter {
namespace {

using test::EmptyScan;
using test::SetReturn;
using test::Stages;

// A scan of one ring, at 20 m in these columns: neighbours are linked, others more than 6 columns apart are not.
Scan RingWith(const std::vector<std::pair<int, int>>& stretches, int num_columns = 360) {
  auto scan = EmptyScan({.num_columns = num_columns, .num_rings = 1});
  for (const auto& [first, num] : stretches) {
    for (int i = 0; i < num; ++i) SetReturn(scan, (first + i) % num_columns, 0, 20.0);
  }
  return scan;
}

TEST(Pieces, AreNumberedInTheOrderOfTheirFirstRun) {
  const Stages stages(RingWith({{10, 3}, {100, 5}, {200, 2}}));
  ASSERT_EQ(stages.pieces.size(), 3);
  EXPECT_EQ(stages.pieces.ArcOf(0).first, 10);
  EXPECT_EQ(stages.pieces.ArcOf(1).first, 100);
  EXPECT_EQ(stages.pieces.ArcOf(2).num, 2);
}

TEST(Pieces, FactsAreThoseOfTheirReturns) {
  auto scan = EmptyScan({});
  const int middle = test::ColumnAt(scan, 90.0);  // to starboard, -y
  for (int step = -10; step <= 10; ++step) {
    for (const int ring : {7, 8}) SetReturn(scan, middle + step, ring, 20.0);
  }
  const Stages stages(scan);
  ASSERT_EQ(stages.pieces.size(), 1);
  const auto& facts = stages.pieces.FactsOf(0);
  EXPECT_EQ(facts.num_returns, 42);
  EXPECT_EQ(facts.min_ring, 7);
  EXPECT_EQ(facts.max_ring, 8);
  EXPECT_EQ(facts.arc.first, middle - 10);
  EXPECT_EQ(facts.arc.num, 21);
  EXPECT_NEAR(facts.min_range_m, 20.0, 0.01);
  EXPECT_NEAR(facts.max_height_m, 20.0 * std::sin(DegToRad(1.0)), 0.001);
  EXPECT_NEAR(facts.mean_m.y(), -20.0, 0.01);
  EXPECT_NEAR(std::abs(facts.direction.x()), 1.0, 1e-3);
  EXPECT_NEAR(facts.length_m, 20 * 20.0 * kTwoPi / 1808, 0.01);
  EXPECT_LT(facts.off_m, 0.05);
}

TEST(Pieces, AtOnePlaceHaveNoLengthAndFiniteFacts) {
  auto scan = EmptyScan({.num_columns = 360, .num_rings = 1, .num_returns = 2});
  SetReturn(scan, 5, 0, 20.0);
  const Stages stages(scan);
  const auto& facts = stages.pieces.FactsOf(0);
  EXPECT_EQ(facts.length_m, 0.0);
  EXPECT_LT(facts.off_m, 1e-4);
  EXPECT_TRUE(facts.direction.allFinite());
}

TEST(CoveringArc, GoesOnOverTheSeam) {
  auto scan = RingWith({{355, 10}});
  SetReturn(scan, 0, 0, 0.0);                                               // a hole at the seam: two runs of one piece
  const Stages stages(scan, LinkFor(LookoutParams{}.link, DegToRad(1.0)));  // columns are a degree apart
  ASSERT_EQ(stages.pieces.size(), 1);
  EXPECT_EQ(stages.pieces.FactsOf(0).arc.first, 355);
  EXPECT_EQ(stages.pieces.FactsOf(0).arc.num, 10);
}

TEST(CoveringArc, OfTheWholeCircleHasAllColumns) {
  const Stages stages(RingWith({{0, 360}}));
  EXPECT_EQ(stages.pieces.FactsOf(0).arc.num, 360);
}

// The circle without its widest empty stretch, counted by brute force.
TEST(CoveringArc, LeavesOutTheWidestGapOfManySeededSets) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 300; ++round) {
    constexpr int kColumns = 120;
    std::vector<std::pair<int, int>> stretches;
    for (std::uint64_t i = 0; i <= random() % 4; ++i) {
      stretches.emplace_back(static_cast<int>(random() % kColumns), 1 + static_cast<int>(random() % 30));
    }
    const auto scan = RingWith(stretches, kColumns);
    Stages stages(scan);
    for (std::int32_t piece = 1; piece < stages.pieces.size(); ++piece) stages.pieces.Join(0, piece);
    stages.pieces.Settle(stages.grid);
    ASSERT_EQ(stages.pieces.roots().size(), 1U);
    int widest = 0;
    for (int begin = 0; begin < kColumns; ++begin) {
      int num = 0;
      while (num < kColumns && scan.columns.range[static_cast<std::size_t>((begin + num) % kColumns)] == 0) ++num;
      widest = std::max(widest, num);
    }
    const Arc arc = stages.pieces.FactsOf(0).arc;
    ASSERT_EQ(arc.num, kColumns - widest) << "round " << round;
    ASSERT_NE(scan.columns.range[static_cast<std::size_t>(arc.first)], 0) << "round " << round;
    ASSERT_NE(scan.columns.range[static_cast<std::size_t>((arc.first + arc.num - 1) % kColumns)], 0) << "round " << round;
  }
}

TEST(SharedColumns, AreThoseInBothArcs) {
  constexpr int kColumns = 24;
  for (int first = 0; first < kColumns; ++first) {
    for (const int num : {1, 5, 11}) {
      for (const int other_num : {1, 3, 12}) {
        int shared = 0;
        for (int i = 0; i < num; ++i) {
          for (int j = 0; j < other_num; ++j) shared += (first + i) % kColumns == (20 + j) % kColumns ? 1 : 0;
        }
        EXPECT_EQ(SharedColumns({first, num}, {20, other_num}, kColumns), shared) << first << ' ' << num << ' ' << other_num;
      }
    }
  }
}

TEST(Settle, AddsUpWhatWasJoinedUnderTheLeastNumber) {
  Stages stages(RingWith({{10, 3}, {100, 5}, {110, 4}}));
  ASSERT_EQ(stages.pieces.size(), 3);
  stages.pieces.Join(2, 1);
  EXPECT_EQ(stages.pieces.RootOf(2), 2) << "not before it is settled";
  EXPECT_TRUE(stages.pieces.Settle(stages.grid));
  EXPECT_EQ(stages.pieces.RootOf(2), 1);
  EXPECT_EQ(stages.pieces.roots().size(), 2U);
  EXPECT_EQ(stages.pieces.FactsOf(1).num_returns, 9);
  EXPECT_EQ(stages.pieces.FactsOf(1).arc.num, 14);
  EXPECT_EQ(stages.pieces.NextMember(1), 2);
  EXPECT_EQ(stages.pieces.NextMember(2), PieceTable::kNone);
  EXPECT_EQ(stages.pieces.ArcOf(1).num, 5) << "single pieces stay as they are";
  EXPECT_FALSE(stages.pieces.Settle(stages.grid)) << "nothing more";
}

TEST(Settle, MakesLandOfWhatIsJoinedToLand) {
  Stages stages(RingWith({{10, 3}, {100, 5}, {110, 4}}));
  stages.pieces.MarkLand(2);
  stages.pieces.Settle(stages.grid);
  stages.pieces.Join(0, 2);
  stages.pieces.Settle(stages.grid);
  EXPECT_TRUE(stages.pieces.FactsOf(stages.pieces.RootOf(2)).is_land);
  EXPECT_FALSE(stages.pieces.FactsOf(1).is_land);
}

// Over all pairs of entries; infinity where none is within the limit.
double BruteGap(const PieceTable& pieces, std::int32_t one, std::int32_t other, double limit_m) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const std::int32_t i : pieces.OutlineOf(one)) {
    for (const std::int32_t j : pieces.OutlineOf(other)) {
      for (const LevelPoint* a : {&pieces.Entry(i).near_point, &pieces.Entry(i).far_point}) {
        for (const LevelPoint* b : {&pieces.Entry(j).near_point, &pieces.Entry(j).far_point}) {
          least_m = std::min(least_m, std::sqrt(double{SquaredPlanDistance(*a, *b)}));
        }
      }
    }
  }
  return least_m <= limit_m ? least_m : std::numeric_limits<double>::infinity();
}

TEST(PlanGap, IsTheLeastDistanceOfAllEntriesWithinTheLimit) {
  int num_within = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    auto scan = EmptyScan({.num_columns = 400});
    std::mt19937_64 random(seed);
    for (int block = 0; block < 60; ++block) {  // some of them over the seam
      const auto column = static_cast<int>(random() % 400);
      const auto ring = static_cast<int>(random() % 14);
      const double range_m = 1.0 + static_cast<double>(random() % 300) / 10.0;
      for (int i = 0; i < 12; ++i) SetReturn(scan, (column + i / 2) % 400, ring + i % 2, range_m);
    }
    const Stages stages(scan);
    ASSERT_GT(stages.pieces.size(), 20);
    for (std::int32_t one = 0; one < stages.pieces.size(); ++one) {
      for (std::int32_t other = 0; other < stages.pieces.size(); ++other) {
        if (one == other) continue;
        const double limit_m = 0.5 + static_cast<double>(random() % 80) / 10.0;
        const double expected_m = BruteGap(stages.pieces, one, other, limit_m);
        num_within += std::isfinite(expected_m) ? 1 : 0;
        const double gap_m = PlanGap(stages.grid, stages.pieces, one, other, limit_m);
        if (std::isfinite(expected_m)) {
          ASSERT_NEAR(gap_m, expected_m, 1e-5) << "seed " << seed << ": " << one << " and " << other;
        } else {
          ASSERT_GT(gap_m, limit_m) << "seed " << seed << ": " << one << " and " << other;
        }
      }
    }
  }
  EXPECT_GT(num_within, 1000);
}

}  // namespace
}  // namespace lookout::segmenter
