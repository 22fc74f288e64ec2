// Runs, and the three rules by which they are linked.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "services/segmenter/core/lookout/runs.hpp"
#include "tests/unit/segmenter/lookout_stages.hpp"

namespace lookout::segmenter {
namespace {

using test::EmptyScan;
using test::SetReturn;
using test::Stages;

// At 10 m two returns are linked when they are at most 0.4 m apart (0.3 m + 0.01 x 10 m); columns are 0.0348 m apart.
constexpr double kRangeM = 10.0;
constexpr double kInsideM = 0.39;
constexpr double kOutsideM = 0.41;

// Range along the beam of a ring at which it is `plan_m` away seen from above.
double SlantM(const Scan& scan, int ring, double plan_m) { return plan_m / std::cos(scan.head.rings[static_cast<std::size_t>(ring)].elevation_rad); }

int NumPieces(const Scan& scan) { return Stages(scan).pieces.size(); }

// A return at column 100 of one ring, and another.
int NumPiecesOfTwo(int ring, double plan_m, int other_ring, int columns_on, double other_plan_m, int num_columns = 1808) {
  auto scan = EmptyScan({.num_columns = num_columns});
  SetReturn(scan, 100, ring, SlantM(scan, ring, plan_m));
  SetReturn(scan, 100 + columns_on, other_ring, SlantM(scan, other_ring, other_plan_m));
  return NumPieces(scan);
}

TEST(Runs, OfAnEmptyScanAreNone) {
  const Stages stages(EmptyScan({}));
  EXPECT_EQ(stages.runs.size(), 0);
  EXPECT_EQ(stages.pieces.size(), 0);
}

TEST(Runs, BreakWhereNeighboursAreFartherApartThanTheLink) {
  for (const auto& [step_m, num_runs] : {std::pair{kInsideM, 1}, {kOutsideM, 2}}) {
    auto scan = EmptyScan({.num_rings = 1});
    for (int column = 100; column < 110; ++column) SetReturn(scan, column, 0, column < 105 ? kRangeM : kRangeM + step_m);
    EXPECT_EQ(Stages(scan).runs.size(), num_runs) << step_m;
  }
}

TEST(Runs, BreakAtAnEmptyBeam) {
  auto scan = EmptyScan({.num_rings = 1});
  for (const int column : {100, 101, 103}) SetReturn(scan, column, 0, kRangeM);
  const Stages stages(scan);
  ASSERT_EQ(stages.runs.size(), 2);
  EXPECT_EQ(stages.runs[0].first, 100);
  EXPECT_EQ(stages.runs[0].length, 2);
  EXPECT_EQ(stages.runs[1].first, 103);
}

TEST(Runs, GoOnOverTheSeam) {
  auto scan = EmptyScan({.num_rings = 1});
  for (const int column : {1806, 1807, 0, 1, 2}) SetReturn(scan, column, 0, kRangeM);
  const Stages stages(scan);
  ASSERT_EQ(stages.runs.size(), 1);
  EXPECT_EQ(stages.runs[0].first, 1806);
  EXPECT_EQ(stages.runs[0].length, 5);
}

TEST(Runs, AllRoundAreOne) {
  auto scan = EmptyScan({.num_rings = 1});
  for (int column = 0; column < 1808; ++column) SetReturn(scan, column, 0, kRangeM);
  const Stages stages(scan);
  ASSERT_EQ(stages.runs.size(), 1);
  EXPECT_EQ(stages.runs[0].length, 1808);
}

TEST(Runs, OfBothReturnsOfAShotAreApart) {
  auto scan = EmptyScan({.num_rings = 1, .num_returns = 2});
  for (int column = 100; column < 105; ++column) {
    SetReturn(scan, column, 0, kRangeM, 0);
    SetReturn(scan, column, 0, 2.0 * kRangeM, 1);
  }
  const Stages stages(scan);
  EXPECT_EQ(stages.runs.size(), 2);
  EXPECT_EQ(stages.pieces.size(), 2);
}

TEST(LinksInARing, ReachOverEmptyBeamsAsFarAsTheLink) {
  EXPECT_EQ(NumPiecesOfTwo(8, kRangeM, 8, kLinkColumns, kRangeM), 1);
  EXPECT_EQ(NumPiecesOfTwo(8, kRangeM, 8, kLinkColumns + 1, kRangeM), 2);
  EXPECT_EQ(NumPiecesOfTwo(8, kRangeM, 8, 2, kRangeM + kInsideM - 0.01), 1);
  EXPECT_EQ(NumPiecesOfTwo(8, kRangeM, 8, 2, kRangeM + kOutsideM), 2);
}

TEST(LinksInARing, GoOnOverTheSeam) {
  auto scan = EmptyScan({.num_rings = 1});
  SetReturn(scan, 1805, 0, kRangeM);
  SetReturn(scan, 3, 0, kRangeM);
  EXPECT_EQ(NumPieces(scan), 1);
}

// The nearest two of a run and the next may be others than their ends: a stray end on a hull.
TEST(LinksInARing, AreBetweenAnyTwoReturnsOfTheRunsNearEnough) {
  auto scan = EmptyScan({.num_rings = 1});
  for (int column = 100; column < 104; ++column) SetReturn(scan, column, 0, kRangeM);
  SetReturn(scan, 104, 0, kRangeM + 0.6);  // a run by itself, 0.6 m behind
  SetReturn(scan, 105, 0, kRangeM);
  const Stages stages(scan);
  EXPECT_EQ(stages.runs.size(), 3);
  EXPECT_EQ(stages.pieces.size(), 2) << "what the stray one parts is one piece";
}

TEST(LinksInARing, TakeTheOtherReturnOfAShot) {
  auto scan = EmptyScan({.num_returns = 2});
  SetReturn(scan, 100, 8, kRangeM, 0);
  SetReturn(scan, 102, 8, kRangeM + 0.3, 1);
  EXPECT_EQ(NumPieces(scan), 1);
  SetReturn(scan, 102, 8, kRangeM + 0.6, 1);
  EXPECT_EQ(NumPieces(scan), 2);
}

TEST(LinksBetweenRings, ReachThreeRingsAndFourColumns) {
  EXPECT_EQ(NumPiecesOfTwo(4, kRangeM, 4 + kLinkRings, 0, kRangeM), 1);
  EXPECT_EQ(NumPiecesOfTwo(4, kRangeM, 4 + kLinkRings + 1, 0, kRangeM), 2);
  EXPECT_EQ(NumPiecesOfTwo(4, kRangeM, 5, kLinkAcrossColumns, kRangeM), 1);
  EXPECT_EQ(NumPiecesOfTwo(4, kRangeM, 5, kLinkAcrossColumns + 1, kRangeM), 2);
  EXPECT_EQ(NumPiecesOfTwo(5, kRangeM, 4, kLinkAcrossColumns, kRangeM), 1) << "also from the upper to the lower";
}

TEST(LinksBetweenRings, GoByTheDistanceSeenFromAbove) {
  // Three rings apart is 1 m up at 10 m: a mast over its hull.
  EXPECT_EQ(NumPiecesOfTwo(4, kRangeM, 7, 0, kRangeM + kInsideM), 1);
  EXPECT_EQ(NumPiecesOfTwo(4, kRangeM, 7, 0, kRangeM + kOutsideM), 2);
}

TEST(LinksBetweenRings, GoOnOverTheSeam) {
  auto scan = EmptyScan({});
  SetReturn(scan, 1806, 8, kRangeM);
  SetReturn(scan, 1, 9, kRangeM);
  EXPECT_EQ(NumPieces(scan), 1);
}

// A wall 5 m to the side, seen along. At r metres its sine is 5 / r and its returns are r / 5 x 0.035 r / 10 apart.
Scan WallSeenAlong(double from_m, double to_m) {
  auto scan = EmptyScan({.num_rings = 1});
  const std::vector<test::Wall> walls{{from_m, 5.0, to_m, 5.0, -1.0, 1.0}};
  test::Look(scan, walls);
  return scan;
}

TEST(LinksAlongAWall, GoFartherThanTheLinkWhereThreeReturnsAreInLine) {
  const auto scan = WallSeenAlong(36.0, 45.0);  // 0.9 to 1.4 m apart; the link is 0.66 to 0.75 m
  ASSERT_GE(test::NumReturns(scan), 6);
  const Stages stages(scan);
  EXPECT_EQ(stages.runs.size(), test::NumReturns(scan));
  EXPECT_EQ(stages.pieces.size(), 1);
}

TEST(LinksAlongAWall, DoNotReachWhereItIsSeenAtLessThanSixDegrees) {
  const auto scan = WallSeenAlong(60.0, 110.0);
  ASSERT_GE(test::NumReturns(scan), 6);
  EXPECT_EQ(NumPieces(scan), test::NumReturns(scan));
}

TEST(LinksAlongAWall, WantThreeReturns) {
  auto scan = WallSeenAlong(38.0, 40.0);
  ASSERT_EQ(test::NumReturns(scan), 2);
  EXPECT_EQ(NumPieces(scan), 2);
}

TEST(LinksAlongAWall, DoNotGoRoundACorner) {
  auto scan = WallSeenAlong(38.0, 41.0);
  ASSERT_EQ(test::NumReturns(scan), 3);
  ASSERT_EQ(NumPieces(scan), 1);
  int column = 0;
  while (scan.columns.range[test::CellOf(scan, column, 0)] == 0) ++column;
  const double middle_m = scan.columns.range[test::CellOf(scan, column + 1, 0)] * scan.head.range_unit_m;
  SetReturn(scan, column + 1, 0, middle_m + 2.0);  // beyond the farther one: no way through
  EXPECT_EQ(NumPieces(scan), 3);
}

// Walls in steps, holes, drops and both returns of a shot.
Scan PatchyScan(std::mt19937_64& random, const test::Shape& shape) {
  auto scan = EmptyScan(shape);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  const double share = uniform(0.03, 1.0);
  for (int ring = 0; ring < shape.num_rings; ++ring) {
    double range_m = 4.0;
    for (int column = 0; column < shape.num_columns; ++column) {
      if (random() % 12 == 0) range_m = uniform(2.0, 2.0 + 0.5 * ring);
      for (int index = 0; index < shape.num_returns; ++index) {
        if (uniform(0.0, 1.0) < share) SetReturn(scan, column, ring, random() % 6 == 0 ? uniform(1.0, 6.0) : range_m + uniform(0.0, 0.05), index);
      }
    }
  }
  return scan;
}

// Sets of returns after all pairs were looked at; `share` of the link, and of the steps along a wall, is reach enough.
UnionFind ByAllPairs(const Stages& stages, double share, bool goes_along_walls) {
  const ScanGrid& grid = stages.grid;
  const Reach link = LookoutParams{}.link;
  const auto count = static_cast<std::int32_t>(grid.points().size());
  UnionFind sets(static_cast<std::size_t>(count));
  for (std::int32_t i = 0; i < count; ++i) {
    const LevelPoint& one = grid.PointOf(i);
    for (std::int32_t j = i + 1; j < count; ++j) {
      const LevelPoint& other = grid.PointOf(j);
      const int rings = std::abs(grid.RingOf(grid.LineOf(i)) - grid.RingOf(grid.LineOf(j)));
      const int columns = std::abs(grid.ColumnOf(i) - grid.ColumnOf(j));
      const int apart = std::min(columns, grid.num_columns() - columns);
      if (rings > kLinkRings || apart > (rings == 0 ? kLinkColumns : kLinkAcrossColumns)) continue;
      const double plan_m = std::sqrt(double{SquaredPlanDistance(one, other)});
      const double distance_m = rings == 0 ? std::hypot(plan_m, one.height_m - other.height_m) : plan_m;
      const float nearer_m = std::min(one.range_m, other.range_m);
      const bool is_along = goes_along_walls && grid.LineOf(i) == grid.LineOf(j) && apart == 1 &&
                            plan_m <= 10.0 * share * grid.column_step_rad() * std::max(one.range_m, other.range_m);
      if (distance_m <= share * link.At(nearer_m) || is_along) sets.Join(i, j);
    }
  }
  return sets;
}

// No fewer returns are joined than those a little nearer than the link, and no more than those a little farther.
TEST(Links, AreThoseOfAllPairs) {
  constexpr std::uint64_t kSeed = 20261122;
  std::mt19937_64 random(kSeed);
  const test::Shape shapes[] = {{.num_columns = 64, .num_rings = 9}, {.num_columns = 80, .num_rings = 4, .num_returns = 2}, {.num_columns = 40}};
  for (int round = 0; round < 90; ++round) {
    Stages stages(PatchyScan(random, shapes[round % 3]));
    UnionFind least = ByAllPairs(stages, 0.999, false);
    UnionFind most = ByAllPairs(stages, 1.001, true);
    const auto count = static_cast<std::int32_t>(stages.returns.size());
    for (std::int32_t i = 0; i < count; ++i) {
      const auto set_of = [&](std::int32_t index) { return stages.sets.Find(stages.runs.OfReturn(index)); };
      ASSERT_EQ(set_of(i), set_of(least.Find(i))) << "round " << round;
      // The root of the first return of its piece.
      const std::int32_t first = FirstReturn(stages.grid, stages.runs[set_of(i)]);
      ASSERT_EQ(most.Find(i), most.Find(first)) << "round " << round;
    }
  }
}

// Two columns as fine as they can be, of 128 rings and two returns: the rest of the circle is not 65 534 columns of nothing.
TEST(Grid, OfANarrowPartHasNoMoreCellsThanAScan) {
  const auto scan = test::EmptyScan({.num_columns = 2, .num_rings = 128, .num_returns = 2, .width_rad = kTwoPi / 65536 * 2});
  ScanGrid grid;
  grid.Fill(scan, {}, Eigen::Matrix3d::Identity());
  EXPECT_EQ(grid.num_columns(), (1 << 21) / 256);
}

}  // namespace
}  // namespace lookout::segmenter
