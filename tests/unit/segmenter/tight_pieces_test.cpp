#include "services/segmenter/core/lookout/tight_pieces.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "services/segmenter/core/union_find.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

using test::EmptyScan;
using test::SetReturn;

constexpr int kColumns = 360;  // of a degree
constexpr Reach kLink{0.3, 0.01};

struct Found {
  std::vector<std::int32_t> of_return;
  std::vector<std::int32_t> reference;
};

// As the header says it, with a look at every pair of returns.
std::vector<std::int32_t> Reference(const ScanGrid& grid, const Reach& link) {
  const auto points = grid.points();
  UnionFind sets(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto one = static_cast<std::int32_t>(i);
      const auto other = static_cast<std::int32_t>(j);
      const int rings = std::abs(grid.RingOf(grid.LineOf(one)) - grid.RingOf(grid.LineOf(other)));
      int columns = std::abs(grid.ColumnOf(one) - grid.ColumnOf(other));
      columns = std::min(columns, grid.num_columns() - columns);
      if (rings > kLinkRings || columns > (rings == 0 ? kLinkColumns : kLinkAcrossColumns)) continue;
      const double rise_m = rings == 0 ? points[i].height_m - points[j].height_m : 0.0;
      const double apart_m = std::hypot(points[i].x_m - points[j].x_m, points[i].y_m - points[j].y_m, rise_m);
      if (apart_m <= link.At(std::min(points[i].range_m, points[j].range_m))) sets.Join(one, other);
    }
  }
  std::vector<std::int32_t> piece_of_root(points.size(), -1);
  std::vector<std::int32_t> piece;
  std::int32_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    auto& number = piece_of_root[static_cast<std::size_t>(sets.Find(static_cast<std::int32_t>(i)))];
    if (number < 0) number = count++;
    piece.push_back(number);
  }
  return piece;
}

Found Find(const Scan& scan, const Reach& link) {
  const auto returns = ClassifyReturns(scan, {}).returns;
  ScanGrid grid;
  grid.Fill(scan, returns, Eigen::Matrix3d::Identity());
  TightPieces tight;
  tight.Find(grid, link);
  return {tight.of_return(), Reference(grid, link)};
}

int Count(const Scan& scan, const Reach& link) { return std::ranges::max(Find(scan, link).of_return) + 1; }

// At 5 m, 9 columns are 0.79 m.
TEST(TightPieces, LinkInARingOverUpToEightColumns) {
  for (const int first : {100, 355}) {  // the second over the seam
    for (int step = 1; step <= 10; ++step) {
      auto scan = EmptyScan({.num_columns = kColumns, .num_rings = 1});
      SetReturn(scan, first, 0, 5.0);
      SetReturn(scan, (first + step) % kColumns, 0, 5.0);
      EXPECT_EQ(Count(scan, {1.0, 0.0}), step <= 8 ? 1 : 2) << first << " and " << step << " on";
    }
  }
}

TEST(TightPieces, LinkBetweenRingsOverUpToFourColumnsAndTwoRings) {
  for (const int first : {100, 357}) {
    for (int step = -6; step <= 6; ++step) {
      for (int rings = 1; rings <= 3; ++rings) {
        auto scan = EmptyScan({.num_columns = kColumns, .num_rings = 4});
        SetReturn(scan, first, 0, 5.0);
        SetReturn(scan, (first + step + kColumns) % kColumns, rings, 5.0);
        EXPECT_EQ(Count(scan, {1.0, 0.0}), std::abs(step) <= 4 && rings <= 2 ? 1 : 2) << first << " and " << step << " on, " << rings << " up";
      }
    }
  }
}

// A mast over a hull: 1.4 m higher at 20 m, and linked up to 0.5 m.
TEST(TightPieces, LinkBetweenRingsAsSeenFromAbove) {
  auto scan = EmptyScan({.num_columns = kColumns, .num_rings = 3});
  SetReturn(scan, 100, 0, 20.0);
  SetReturn(scan, 100, 2, 20.0);
  EXPECT_EQ(Count(scan, kLink), 1);
}

// 0.3 + 0.01 x 5 = 0.35 m; neighbouring columns are 0.09 m apart.
TEST(TightPieces, AreNoFartherApartThanTheLink) {
  for (const auto& [behind_m, num_pieces] : {std::pair{0.33, 1}, {0.36, 2}, {0.7, 2}, {20.0, 2}}) {
    for (const int ring : {0, 1}) {
      auto scan = EmptyScan({.num_columns = kColumns, .num_rings = 2});
      SetReturn(scan, 100, 0, 5.0);
      SetReturn(scan, 101, ring, 5.0 + behind_m);
      EXPECT_EQ(Count(scan, kLink), num_pieces) << behind_m << " m behind, ring " << ring;
    }
  }
}

TEST(TightPieces, LinkReturnsOfOneShotAndOfShotsBesideIt) {
  for (const auto& [step, behind_m, num_pieces] : {std::tuple{0, 0.8, 1}, {0, 2.0, 2}, {8, 0.5, 1}, {9, 0.5, 2}, {-8, 0.5, 1}, {-9, 0.5, 2}}) {
    auto scan = EmptyScan({.num_columns = kColumns, .num_rings = 1, .num_returns = 2});
    SetReturn(scan, 100, 0, 5.0, 0);
    SetReturn(scan, 100 + step, 0, 5.0 + behind_m, 1);
    EXPECT_EQ(Count(scan, {1.0, 0.0}), num_pieces) << step << " on, " << behind_m << " m behind";
  }
}

TEST(TightPieces, AreThoseOfTheReferenceNumberedByTheirFirstReturn) {
  std::mt19937_64 random(1);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  for (int round = 0; round < 60; ++round) {
    const int num_returns = 1 + round % 2;
    auto scan = EmptyScan({.num_columns = 128, .num_rings = 6, .num_returns = num_returns});
    for (int column = 0; column < 128; ++column) {
      if (column > 30 && column < 90) continue;
      for (int ring = 0; ring < 6; ++ring) {
        for (int index = 0; index < num_returns; ++index) {
          if (random() % 3 == 0) SetReturn(scan, column, ring, uniform(5.0, 9.0), index);
        }
      }
    }
    const auto found = Find(scan, round % 3 == 0 ? Reach{0.6, 0.02} : kLink);
    ASSERT_EQ(found.of_return, found.reference) << "round " << round;
  }
}

// More returns than runs may be, none beside another, and no noise.
TEST(TightPieces, OfAWallOfWhichEveryOtherBeamMetNothingAreOne) {
  constexpr int kFineColumns = 2048;
  constexpr int kFineRings = 128;
  auto scan = EmptyScan({.num_columns = kFineColumns, .num_rings = kFineRings});
  for (int ring = 0; ring < kFineRings; ++ring)
    scan.head.rings[static_cast<std::size_t>(ring)].elevation_rad = 0.002F * static_cast<float>(ring - 64);
  for (int column = 0; column < kFineColumns; column += 2) {
    for (int ring = 0; ring < kFineRings; ++ring) SetReturn(scan, column, ring, 10.0);
  }
  const auto returns = ClassifyReturns(scan, {}).returns;
  ASSERT_GT(returns.size(), 100'000U);
  ScanGrid grid;
  grid.Fill(scan, returns, Eigen::Matrix3d::Identity());
  TightPieces tight;
  tight.Find(grid, {0.6, 0.0});
  EXPECT_EQ(tight.count(), 1);
}

}  // namespace
}  // namespace lookout::segmenter
