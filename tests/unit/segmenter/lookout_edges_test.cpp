// The lookout method where the circle closes, where a scan is a part of one, and where a lidar is another than the VLP-16.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <tuple>

#include "common/core/partition.hpp"
#include "tests/unit/segmenter/lookout_stages.hpp"
#include "tests/unit/wire/counting_new.hpp"

namespace lookout::segmenter {
namespace {

using test::EmptyScan;
using test::SegmentOf;
using test::SetReturn;
using test::Stages;
using test::Wall;

// A step of the window may be more columns than there are.
TEST(FewColumns, AreLinkedAsManyAre) {
  for (const int num_columns : {3, 2, 1}) {
    auto scan = EmptyScan({.num_columns = num_columns, .num_rings = 2, .width_rad = 0.0035 * num_columns});
    for (int column = 0; column < num_columns; ++column) {
      for (const int ring : {0, 1}) SetReturn(scan, column, ring, 10.0);
    }
    const auto segments = SegmentScan(scan, {});
    EXPECT_EQ(segments.segments.size(), 1U) << num_columns;
    EXPECT_EQ(std::ranges::count(segments.label, 0), 0) << num_columns;
  }
}

// Their number on an arc was made an int however great it was: the least int on x86, the greatest on arm64.
TEST(FewColumns, AsFineAsNumbersGoTakeAtMostHalfTheCircle) {
  auto scan = EmptyScan({.num_columns = 100, .num_rings = 2, .width_rad = 0.1});
  for (int column = 0; column < 100; ++column) {
    scan.columns.azimuth_rad[static_cast<std::size_t>(column)] = 1e-15F * static_cast<float>(column);
    SetReturn(scan, column, 0, 10.0);
  }
  const Stages stages(scan);
  EXPECT_EQ(stages.grid.ColumnsOf(1.0, 10.0), stages.grid.num_columns() / 2);
  EXPECT_EQ(SegmentScan(scan, {}).segments.size(), 1U);
}

// 512 columns of a wall all round at 20 m are 0.245 m apart and linked up to 0.5 m. What is right above one of them is of it in each column.
TEST(WholeCircle, IsLinkedToTheNextRingInEachColumn) {
  for (int column = 0; column < 512; ++column) {
    auto scan = EmptyScan({.num_columns = 512, .num_rings = 2});
    for (int other = 0; other < 512; ++other) SetReturn(scan, other, 0, 20.0);
    SetReturn(scan, column, 1, 20.0);
    EXPECT_EQ(Stages(scan).pieces.size(), 1) << column;
  }
}

// A wall that winds inwards all the way round, but for 5 columns: its ends are 3 m apart. What is beside an end is linked to it.
TEST(WholeCircle, AlmostClosedIsLinkedAtBothEnds) {
  constexpr int kColumns = 512;
  for (const bool is_mirrored : {false, true}) {
    for (int beyond = 1; beyond <= 2; ++beyond) {
      auto scan = EmptyScan({.num_columns = kColumns, .num_rings = 2});
      const auto at = [is_mirrored](int column) { return is_mirrored ? kColumns - 1 - column : column; };
      constexpr int kLength = kColumns - 5;
      for (int column = 0; column < kLength; ++column) SetReturn(scan, at(column), 0, 15.0 + 3.0 * column / kLength);
      SetReturn(scan, at(kLength - 1 + beyond), 1, 18.0);  // link 0.48 m; 0.22 m and 0.44 m off
      EXPECT_EQ(Stages(scan).pieces.size(), 1) << beyond << (is_mirrored ? " mirrored" : "");
    }
  }
}

// From the water, 1 m below the lidar, to 2 m above it. Its runs close: their first and last returns are neighbours, and say nothing of its length.
TEST(WholeCircle, OfAHarbourWallIsLand) {
  for (const double turn_rad : {0.0, 0.4, 2.0}) {
    std::vector<Wall> walls;
    test::AddBoat(walls, 5.0, -3.0, turn_rad, 50.0, 36.0, -1.0, 2.0);  // a rectangle
    const auto segments = SegmentScan(test::See(walls), {});
    ASSERT_EQ(segments.segments.size(), 1U) << turn_rad;
    EXPECT_GT(segments.segments[0].length_m, 49.0F) << turn_rad;
    EXPECT_EQ(segments.segments[0].kind, SegmentKind::kLand) << turn_rad;
  }
}

TEST(WholeCircle, OfEqualDistanceIsOneThing) {
  auto scan = EmptyScan({});
  for (int column = 0; column < 1808; ++column) {
    for (int ring = 5; ring < 11; ++ring) SetReturn(scan, column, ring, 20.0);
  }
  const auto segments = SegmentScan(scan, {});
  ASSERT_EQ(segments.segments.size(), 1U);
  EXPECT_GT(segments.segments[0].length_m, 39.0F);
}

// A quarter of a turn, its columns from left to right, with something near that hides the middle of a shore.
TEST(PartOfAScan, HasItsWaterlineFromLeftToRight) {
  auto scan = EmptyScan({.num_columns = 452, .width_rad = kPi / 2});
  test::Look(scan, std::vector<Wall>{{40.0, 0.0, 0.0, -40.0, -3.0, 3.0}}, 0.02);
  for (int column = 200; column < 232; ++column) {
    for (int ring = 0; ring < 16; ++ring) SetReturn(scan, column, ring, 8.0);
  }
  const auto segments = SegmentScan(scan, {});
  ASSERT_EQ(segments.segments.size(), 2U);
  const auto land = std::ranges::find(segments.segments, SegmentKind::kLand, &Segment::kind);
  ASSERT_NE(land, segments.segments.end());
  ASSERT_GE(land->waterline.size(), 2U);
  double last_deg = -1.0;
  for (const auto& corner : land->waterline) {
    const double azimuth_deg = RadToDeg(-std::atan2(double{corner.y_m}, double{corner.x_m}));
    EXPECT_GT(azimuth_deg, last_deg);
    last_deg = azimuth_deg;
  }
}

// Lidars of other makers fire the beams of a column up to some 4 degrees apart: a column is no upright line.
TEST(OtherLidars, WithBeamsOfAColumnAsideOfEachOtherSeeTheSameObjects) {
  for (const int num_rings : {32, 64, 128}) {
    for (const int num_columns : {1024, 2048}) {
      for (const double offset_deg : {0.0, 3.0}) {
        auto scan = EmptyScan({.num_columns = num_columns, .num_rings = num_rings});
        for (int ring = 0; ring < num_rings; ++ring) {
          auto& beam = scan.head.rings[static_cast<std::size_t>(ring)];
          beam.elevation_rad = static_cast<float>(DegToRad(-20.0 + 40.0 * ring / (num_rings - 1)));
          beam.azimuth_offset_rad = static_cast<float>(DegToRad(offset_deg * ((ring % 4) * 2 - 3) / 3.0));
        }
        std::vector<Wall> walls;
        test::AddBoat(walls, 12.0, 4.0, 1.0, 7.0, 2.5, -1.0, 1.5);
        test::AddBoat(walls, 25.0, -14.0, 0.5, 5.0, 2.0, -1.0, 1.5);
        test::AddBoat(walls, -20.0, 3.0, 0.2, 0.5, 0.5, -1.0, 0.5);
        test::Look(scan, walls, 0.02);
        EXPECT_EQ(SegmentScan(scan, {}).segments.size(), 3U) << num_rings << " rings, " << num_columns << " columns, " << offset_deg << " degrees";
      }
    }
  }
}

// The hull that is published holds every return, whichever way the beams of a column look.
TEST(OtherLidars, WithBeamsOfAColumnAsideOfEachOtherHaveHullsAroundAllReturns) {
  for (const double offset_deg : {0.0, 3.0}) {
    auto scan = EmptyScan({.num_columns = 1024});
    for (std::size_t ring = 0; ring < 16; ++ring) {
      scan.head.rings[ring].azimuth_offset_rad = static_cast<float>(DegToRad(ring % 2 == 0 ? offset_deg : -offset_deg));
    }
    for (int column = 500; column < 510; ++column) {
      for (int ring = 4; ring < 12; ++ring) SetReturn(scan, column, ring, 4.0 + 0.02 * ring);
    }
    const auto segments = SegmentScan(scan, {});
    for (const auto& one : ClassifyReturns(scan, {}).returns) {
      const auto& hull = SegmentOf(segments, segments.label[static_cast<std::size_t>(one.cell)]).hull;
      for (std::size_t i = 0; hull.size() >= 3 && i < hull.size(); ++i) {
        const auto& from = hull[i];
        const auto& to = hull[(i + 1) % hull.size()];
        const double edge_m = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
        const double inside_m = ((to.x_m - from.x_m) * (one.point.y_m - from.y_m) - (to.y_m - from.y_m) * (one.point.x_m - from.x_m)) / edge_m;
        ASSERT_GE(inside_m, -1e-4) << offset_deg << " degrees: return of ring " << one.ring << ", column " << one.column;
      }
    }
  }
}

// A boat of 8 m seen from ahead: both ends of its runs are at the stern, and its length is from there to the bow.
Scan BowOn() {
  auto scan = EmptyScan({});
  for (int step = -70; step <= 70; ++step) {
    for (int ring = 7; ring < 10; ++ring) SetReturn(scan, 900 + step, ring, 6.0 + 8.0 * std::abs(step) / 70.0);
  }
  return scan;
}

TEST(BowOn, TheLengthIsFromBowToStern) {
  const Stages stages(BowOn());
  ASSERT_EQ(stages.pieces.size(), 1);
  EXPECT_GT(stages.pieces[0].length_m, 7.0);
}

// The middle of the boat is farther off than its bow.
TEST(BowOn, WhatIsBesideTheBowIsOfIt) {
  for (const auto& [range_m, num_segments] : {std::pair{5.5, 1U}, {2.0, 2U}}) {  // 0.5 m and 4 m before the bow
    auto scan = BowOn();
    for (int step = -4; step <= 4; ++step) SetReturn(scan, 900 + step, 3, range_m / std::cos(DegToRad(9.0)));
    ASSERT_EQ(Stages(scan).pieces.size(), 2);
    EXPECT_EQ(SegmentScan(scan, {}).segments.size(), num_segments) << range_m;
  }
}

// Two quays, the left one farther off: one with a step in it, or two that have nothing to do with each other. Which of them in between is for the
// evidence to say, but for both sides alike.
TEST(Mirrored, TwoQuaysAreAsManyPieces) {
  for (const double farther_m : {0.1, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 14.0}) {
    std::array<std::size_t, 2> num_segments{};
    for (const std::size_t is_mirrored : {0U, 1U}) {
      auto scan = EmptyScan({});
      const auto at = [is_mirrored](int column) { return is_mirrored != 0 ? 1807 - column : column; };
      for (int column = 300; column < 900; ++column) {
        for (int ring = 6; ring < 10; ++ring) SetReturn(scan, at(column), ring, column < 600 ? 16.0 + farther_m : 16.0);
      }
      num_segments[is_mirrored] = SegmentScan(scan, {}).segments.size();
    }
    EXPECT_EQ(num_segments[0], num_segments[1]) << farther_m;
    if (farther_m < 0.5) {
      EXPECT_EQ(num_segments[0], 1U);
    } else if (farther_m > 10.0) {
      EXPECT_EQ(num_segments[0], 2U);
    }
  }
}

// 50 m of beach that rises from the water at 20 m by 1 in 10, with a row of trees behind it.
std::vector<Wall> Beach() {
  std::vector<Wall> walls;
  for (int step = 0; step < 12; ++step) walls.push_back({20.0 + 0.5 * step, -25.0, 20.0 + 0.5 * step, 25.0, -1.0, -0.9 + 0.05 * step});
  walls.push_back({27.0, -25.0, 27.0, 25.0, -0.5, 4.0});
  return walls;
}

// A hull of 6 m by 2.2 m with a cabin, 0.9 m and 1.8 m above the water.
void AddCabinBoat(std::vector<Wall>& walls, double x_m, double y_m, double heading_rad) {
  test::AddBoat(walls, x_m, y_m, heading_rad, 6.0, 2.2, -1.0, -0.1);
  test::AddBoat(walls, x_m, y_m, heading_rad, 2.2, 1.6, -0.1, 0.8);
}

TEST(ClearCases, ABoatAloneIsOneThing) {
  for (const double range_m : {8.0, 12.0, 25.0, 40.0}) {
    for (const double heading_rad : {0.6, 1.2, kPi / 2, 2.3}) {
      std::vector<Wall> walls;
      AddCabinBoat(walls, range_m, 0.0, heading_rad);
      const auto segments = SegmentScan(test::See(walls), {});
      ASSERT_EQ(segments.segments.size(), 1U) << range_m << " m, " << heading_rad;
      EXPECT_EQ(segments.segments[0].kind, SegmentKind::kObstacle) << range_m << " m, " << heading_rad;
    }
  }
}

TEST(ClearCases, TwoBoatsTenMetresApartAreTwoThings) {
  for (const double range_m : {8.0, 15.0, 30.0}) {
    std::vector<Wall> walls;
    AddCabinBoat(walls, range_m, -7.5, kPi / 4);
    AddCabinBoat(walls, range_m, 7.5, -kPi / 4);
    const auto segments = SegmentScan(test::See(walls), {});
    ASSERT_EQ(segments.segments.size(), 2U) << range_m;
    for (const auto& one : segments.segments) EXPECT_EQ(one.kind, SegmentKind::kObstacle) << range_m;
  }
}

// In the scenes of the fit nothing but the own crew, spray and fog is so near.
TEST(ClearCases, AWallBesideTheBoatIsSure) {
  for (const double distance_m : {0.9, 1.5, 2.5, 4.0}) {
    for (const double height_m : {0.8, 2.0}) {
      std::vector<Wall> walls{{distance_m, -6.0, distance_m, 9.0, -1.0, height_m - 1.0}};
      const auto segments = SegmentScan(test::See(walls), {});
      ASSERT_EQ(segments.segments.size(), 1U) << distance_m << ' ' << height_m;
      EXPECT_EQ(segments.segments[0].confidence, Confidence::kSure) << distance_m << ' ' << height_m;
    }
  }
}

TEST(ClearCases, AShoreOfFortyMetresIsLand) {
  const auto scan = test::See(Beach());
  const auto segments = SegmentScan(scan, {});
  for (const double y_m : {-15.0, 0.0, 15.0}) {
    const auto trees = test::SegmentsNear(scan, segments, 27.0, y_m, 3.0);
    ASSERT_EQ(trees.size(), 1U) << y_m;
    EXPECT_EQ(SegmentOf(segments, *trees.begin()).kind, SegmentKind::kLand) << y_m;
  }
}

TEST(ClearCases, ABoatThreeMetresBeforeABeachIsAThingOfItsOwn) {
  for (const double y_m : {-10.0, 0.0, 8.0}) {
    auto walls = Beach();
    AddCabinBoat(walls, 15.9, y_m, kPi / 2);  // its far side at 17 m
    const auto scan = test::See(walls);
    const auto segments = SegmentScan(scan, {});
    const auto boat = test::SegmentsNear(scan, segments, 15.0, y_m, 2.0);
    const auto beach = test::SegmentsNear(scan, segments, 27.0, -y_m - 5.0, 3.0);
    ASSERT_EQ(boat.size(), 1U) << y_m;
    EXPECT_FALSE(beach.contains(*boat.begin())) << y_m;
    EXPECT_EQ(SegmentOf(segments, *boat.begin()).kind, SegmentKind::kObstacle) << y_m;
  }
}

TEST(Memory, NothingIsAllocatedForAScanThatHasBeenSeen) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    auto scan = EmptyScan({});
    test::Look(scan, test::Lake(seed), 0.03, seed);
    if (seed % 2 == 0) test::AddRain(scan, 600, seed);
    Segmenter segmenter{Params{}};
    segmenter.Segment(scan);
    const auto before = num_allocated_bytes;
    segmenter.Segment(scan);
    EXPECT_EQ(num_allocated_bytes - before, 0U) << "seed " << seed;
  }
}

// With as many pieces and pairs, in other places.
TEST(Memory, NothingIsAllocatedForAPartitionOfThatSize) {
  constexpr std::int32_t kPieces = 500;
  Partition partition;
  for (const std::int32_t step : {1, 7, 0}) {
    std::vector<EvidencePair> pairs;
    pairs.reserve(kPieces);
    for (std::int32_t piece = 1; piece < kPieces; ++piece) {
      const std::int32_t other = step == 0 ? 0 : (piece * step + step) % kPieces;  // at last all are neighbours of one
      pairs.push_back({piece, other == piece ? 0 : other, 1.0F, static_cast<float>(piece)});
    }
    const auto before = num_allocated_bytes;
    partition.Find(kPieces, pairs, 0.0F);
    if (step == 1) continue;
    EXPECT_EQ(num_allocated_bytes, before) << step;
  }
}

// A return on so many beams, at any range: no water looks so.
Scan Noise(const test::Shape& shape, double share, double from_m, double to_m) {
  auto scan = EmptyScan(shape);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t ring = 0; ring < scan.head.rings.size(); ++ring) {
    scan.head.rings[ring].elevation_rad = static_cast<float>(-0.26 + 0.52 * static_cast<double>(ring) / shape.num_rings);
  }
  for (int column = 0; column < shape.num_columns; ++column) {
    for (int ring = 0; ring < shape.num_rings; ++ring) {
      if (uniform(random) < share) SetReturn(scan, column, ring, from_m + (to_m - from_m) * uniform(random));
    }
  }
  return scan;
}

// Without bounds they had millions of pairs: seconds, and gigabytes.
TEST(Noise, HasNoMorePairsThanMayBe) {
  for (const auto& [shape, share, from_m, to_m] : {std::tuple{test::Shape{.num_columns = 2048}, 0.33, 0.6, 6.0},
                                                   {{.num_columns = 2048}, 1.0, 0.6, 100.0},
                                                   {{.num_columns = 1024, .num_rings = 64}, 0.3, 0.6, 6.0},
                                                   {{.num_columns = 2048, .num_rings = 128}, 1.0, 0.6, 100.0},
                                                   {{.num_columns = 2048, .num_rings = 128}, 1.0, 60.0, 100.0}}) {
    const auto scan = Noise(shape, share, from_m, to_m);
    LookoutMethod method({}, Eigen::Matrix3d::Identity());
    method.FindPieces(scan, ClassifyReturns(scan, {}).returns);
    EXPECT_LE(method.pieces().size(), TightPieces::kMostPieces);
    for (std::size_t merge = 0; merge < kNumMerges; ++merge) {
      const auto pairs = method.FindPairs(merge);
      EXPECT_LE(pairs.size(), PairFinder::kMostPairs) << shape.num_columns << " columns, round " << merge;
      method.Merge(merge, pairs);
    }
  }
}

// What is of no piece has the label of what is left out, and is counted.
TEST(Noise, OfMorePiecesThanLabelsLeavesOutTheSmallest) {
  const auto scan = Noise({.num_columns = 2048, .num_rings = 128}, 1.0, 0.6, 100.0);
  const auto segments = SegmentScan(scan, {});
  EXPECT_GT(segments.num_over_limit, 0);
  EXPECT_LE(segments.segments.size(), 32767U);
  EXPECT_EQ(std::ranges::count(segments.label, 0), std::ranges::count(scan.columns.range, 0));
  EXPECT_GT(std::ranges::count(segments.label, ToLabel(Reason::kTooSmall)), 0);
}

// The same bounds wherever the scan is cut, and in the mirror: another share of the reach would part hundreds of segments. That a single pair of
// thousands is at its limit to the last bit does not count.
TEST(Noise, IsCutToItsBoundsAlikeWhereverTheScanBegins) {
  for (const double share : {0.33, 0.6}) {
    const auto scan = Noise({.num_columns = 2048}, share, 0.6, 6.0);
    auto turned = scan;
    auto mirrored = scan;
    constexpr std::ptrdiff_t kOn = 700 * 16;
    std::ranges::rotate(turned.columns.range, turned.columns.range.begin() + kOn);
    for (std::size_t column = 0; column < 2048; ++column) {
      std::copy_n(scan.columns.range.begin() + static_cast<std::ptrdiff_t>(16 * column), 16,
                  mirrored.columns.range.begin() + static_cast<std::ptrdiff_t>(16 * (2047 - column)));
    }
    const auto num_segments = static_cast<double>(SegmentScan(scan, {}).segments.size());
    EXPECT_NEAR(static_cast<double>(SegmentScan(turned, {}).segments.size()), num_segments, 3.0) << share;
    EXPECT_NEAR(static_cast<double>(SegmentScan(mirrored, {}).segments.size()), num_segments, 3.0) << share;
  }
}

// A slope of 128 rings that rises from 1.7 m below the lidar at 5 m to 15 m above it at 43 m, over a third of the circle.
TEST(ASlope, OfManyRingsIsOnePieceOfLand) {
  auto scan = EmptyScan({.num_columns = 1024, .num_rings = 128});
  for (int ring = 0; ring < 128; ++ring) {
    scan.head.rings[static_cast<std::size_t>(ring)].elevation_rad = static_cast<float>(DegToRad(-20.0 + 40.0 * ring / 127.0));
    for (int column = 300; column < 640; ++column) SetReturn(scan, column, ring, 5.0 + 0.3 * ring);
  }
  const auto segments = SegmentScan(scan, {});
  ASSERT_EQ(segments.segments.size(), 1U);
  EXPECT_EQ(segments.segments[0].kind, SegmentKind::kLand);
}

}  // namespace
}  // namespace lookout::segmenter
