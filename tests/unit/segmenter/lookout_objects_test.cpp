// Which pieces are of one object, and how far a segment is believed.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "services/segmenter/core/lookout/objects.hpp"
#include "tests/unit/segmenter/lookout_stages.hpp"

namespace lookout::segmenter {
namespace {

using test::AddBoat;
using test::See;
using test::SetReturn;
using test::Wall;

constexpr double kObjectsWaterM = -1.0;  // of the lidar 1 m over it

// Beyond what is joined side by side (0.3 + 0.03 x 10.5 = 0.62 m), and longer than the small parts that are attached (1.4 m).
// The farther behind, the less it is of the hull: one segment at first, two in the end, and no way back.
TEST(Objects, ACabinOverAHullIsOfItUnlessItIsFarBehindItsSide) {
  std::vector<std::size_t> num_segments;
  for (double behind_m = 1.0; behind_m <= 6.0; behind_m += 0.25) {
    std::vector<Wall> walls{{10.5, -4.5, 10.5, 4.5, kObjectsWaterM, -0.2}};
    AddBoat(walls, 10.5 + behind_m + 0.8, 0.0, kPi / 2, 3.0, 1.6, 0.0, 2.5);
    num_segments.push_back(SegmentScan(See(walls), {}).segments.size());
  }
  EXPECT_EQ(num_segments.front(), 1U);
  EXPECT_EQ(num_segments.back(), 2U);
  EXPECT_TRUE(std::ranges::is_sorted(num_segments)) << testing::PrintToString(num_segments);
}

// A cabin stands over its hull: what is seen beyond a boat, and lower than her top, is another boat.
TEST(Objects, WhatIsSeenOverAHullButLowerThanItsTopIsNotOfIt) {
  for (const bool has_tower : {false, true}) {
    std::vector<Wall> walls{{10.5, -4.5, 10.5, 4.5, kObjectsWaterM, -0.2}};
    if (has_tower) walls.push_back({10.5, 3.0, 10.5, 4.5, -0.2, 2.5});
    AddBoat(walls, 12.5, -1.0, kPi / 2, 3.0, 1.6, 0.0, 1.0);
    EXPECT_EQ(SegmentScan(See(walls), {}).segments.size(), has_tower ? 2U : 1U) << has_tower;
  }
}

// 2 m behind and over a hull of 5 m, whose ends hide less than a third of it: a cabin as wide as the hull is of it, a wall of twice its width is not.
TEST(Objects, WhatIsSeenOverANearerThingIsNotMuchWider) {
  std::vector<std::size_t> num_segments;
  for (double wider_m = 0.0; wider_m <= 5.0; wider_m += 0.25) {
    const double half_m = (5.0 + wider_m) / 2;
    const std::vector<Wall> walls{{8.0, -2.5, 8.0, 2.5, kObjectsWaterM, -0.2}, {10.0, -half_m, 10.0, half_m, 0.0, 1.2}};
    num_segments.push_back(SegmentScan(See(walls), {}).segments.size());
  }
  EXPECT_EQ(num_segments.front(), 1U);
  EXPECT_GE(num_segments.back(), 2U);
  EXPECT_TRUE(std::ranges::is_sorted(num_segments)) << testing::PrintToString(num_segments);
}

TEST(Objects, ABoatBehindABoatIsNotOfIt) {
  std::vector<Wall> walls;
  AddBoat(walls, 12.0, 0.0, kPi / 2, 4.0, 1.5, kObjectsWaterM, -0.3);
  AddBoat(walls, 24.0, 0.0, kPi / 2, 4.0, 1.5, kObjectsWaterM, 1.5);
  EXPECT_EQ(SegmentScan(See(walls), {}).segments.size(), 2U);
}

// Segments that are sure. Of a side seen along, the last beams are too far apart to be linked, and tentative segments of their own.
std::size_t NumSure(const Segments& segments) {
  return static_cast<std::size_t>(std::ranges::count(segments.segments, Confidence::kSure, &Segment::confidence));
}

TEST(Objects, TwoBoatsThreeMetresApartStayTwo) {
  for (const double range_m : {10.0, 20.0, 35.0}) {
    for (const double turned_rad : {0.0, 0.7, 3.1}) {
      std::vector<Wall> walls;
      for (const double side : {-1.0, 1.0}) {  // bow to stern, and both abeam
        const double y_m = side * (3.0 + 6.0) / 2;
        AddBoat(walls, range_m * std::cos(turned_rad) - y_m * std::sin(turned_rad), range_m * std::sin(turned_rad) + y_m * std::cos(turned_rad),
                turned_rad + kPi / 2, 6.0, 2.0, kObjectsWaterM, 1.0);
      }
      EXPECT_EQ(NumSure(SegmentScan(See(walls), {})), 2U) << range_m << " m, turned by " << turned_rad;
    }
  }
}

// At berths, seen from their bows: side by side 0.54 m is joined at 8 m, 0.66 m at 12 m, and 0.9 m at 20 m.
TEST(Objects, TwoBoatsAtBerthsStayTwo) {
  for (const auto& [range_m, gap_m] : {std::pair{8.0, 0.7}, {8.0, 1.0}, {12.0, 0.8}, {12.0, 0.9}, {20.0, 1.0}}) {
    for (const double turned_rad : {0.0, 0.7, 3.1}) {
      std::vector<Wall> walls;
      for (const double side : {-1.0, 1.0}) {
        const double x_m = range_m + 3.0;
        const double y_m = side * (gap_m + 2.2) / 2;
        AddBoat(walls, x_m * std::cos(turned_rad) - y_m * std::sin(turned_rad), x_m * std::sin(turned_rad) + y_m * std::cos(turned_rad), turned_rad,
                6.0, 2.2, kObjectsWaterM, 0.5);
      }
      EXPECT_EQ(NumSure(SegmentScan(See(walls), {})), 2U) << gap_m << " m apart at " << range_m << " m, turned by " << turned_rad;
    }
  }
}

// Boats 0.6 m apart at 8 m, more than is joined side by side (0.54 m), and a drop half way between them, nearer the one.
TEST(Objects, ADropBetweenTwoBoatsDoesNotJoinThem) {
  for (const double nearer_m : {-0.02, 0.0, 0.02}) {
    auto scan = See({{8.0, 0.3, 8.0, 2.5, kObjectsWaterM, 0.6}, {8.0, -0.3, 8.0, -2.5, kObjectsWaterM, 0.6}});
    SetReturn(scan, test::ColumnAt(scan, RadToDeg(WrapTo2Pi(nearer_m / 8.0))), 7, 8.0);
    const auto segments = SegmentScan(scan, {});
    auto boats = test::SegmentsNear(scan, segments, 8.0, 1.5, 0.8);
    boats.merge(test::SegmentsNear(scan, segments, 8.0, -1.5, 0.8));
    EXPECT_EQ(boats.size(), 2U) << nearer_m;
  }
}

// Where the gap between them is as wide as a walkway, the hulls' inner sides are seen along, column by column, and are no posts of a dock.
TEST(Objects, TheInnerSidesOfTwoBoatsAreNoDock) {
  for (const auto& [range_m, gap_m] : {std::pair{12.0, 1.0}, {8.0, 2.0}, {10.0, 2.5}, {12.0, 3.0}, {20.0, 1.5}}) {
    int num_joined = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      for (int turn = 0; turn < 21; ++turn) {
        const double turned_rad = 0.31 * turn;
        const auto at = [turned_rad](double x_m, double y_m) {
          return std::pair(x_m * std::cos(turned_rad) - y_m * std::sin(turned_rad), x_m * std::sin(turned_rad) + y_m * std::cos(turned_rad));
        };
        std::vector<Wall> walls;
        for (const double side : {-1.0, 1.0}) {
          const auto [x_m, y_m] = at(range_m + 3.0, side * (gap_m + 2.2) / 2);
          AddBoat(walls, x_m, y_m, turned_rad, 6.0, 2.2, kObjectsWaterM, 0.5);
        }
        const auto scan = See(walls, {}, seed);
        const auto segments = SegmentScan(scan, {});
        std::set<int> bows;
        for (const double side : {-1.0, 1.0}) {
          const auto [x_m, y_m] = at(range_m, side * (gap_m + 2.2) / 2);
          bows.merge(test::SegmentsNear(scan, segments, x_m, y_m, 0.5));
        }
        num_joined += bows.size() < 2 ? 1 : 0;
      }
    }
    EXPECT_EQ(num_joined, 0) << "of 210, " << gap_m << " m apart at " << range_m << " m";
  }
}

// Blocks of so many columns at 20 m, 0.07 m each, in two rings; the next one begins so many columns after the last of the one before.
Scan Blocks(const std::vector<std::pair<int, int>>& after_and_num, int first_column, bool is_mirrored = false, double range_m = 20.0) {
  auto scan = test::EmptyScan({});
  int last = first_column;
  for (const auto& [after, num] : after_and_num) {
    for (int column = last + after; column < last + after + num; ++column) {
      for (const int ring : {7, 8}) SetReturn(scan, is_mirrored ? 1807 - column : column, ring, range_m);
    }
    last += after + num - 1;
  }
  return scan;
}

TEST(Objects, WhatIsJoinedSideBySideIsWithinTheReach) {
  const double column_m = 20.0 * kTwoPi / 1808;
  // Blocks of 1.6 m are joined up to 0.3 + 0.03 x 20 = 0.9 m; small ones, of 0.5 m, are attached up to 1.2 + 0.03 x 20 = 1.8 m.
  for (const auto& [num_columns, reach_m] : {std::pair{24, 0.9}, {8, 1.8}}) {
    const int columns_apart = static_cast<int>(reach_m / column_m);
    EXPECT_EQ(SegmentScan(Blocks({{0, num_columns}, {columns_apart, num_columns}}, 400), {}).segments.size(), 1U) << num_columns;
    EXPECT_EQ(SegmentScan(Blocks({{0, num_columns}, {columns_apart + 1, num_columns}}, 400), {}).segments.size(), 2U) << num_columns;
  }
}

TEST(Objects, ASmallPartIsAtMostOnePointFourMetresLong) {
  // 1 m beside a hull of 2.2 m: 1.32 m and 1.46 m long.
  EXPECT_EQ(SegmentScan(Blocks({{0, 32}, {15, 20}}, 400), {}).segments.size(), 1U);
  EXPECT_EQ(SegmentScan(Blocks({{0, 32}, {15, 22}}, 400), {}).segments.size(), 2U);
}

// Of a kayak at 12 m its two paddlers: attached up to 1.2 + 0.03 x 12 = 1.56 m.
TEST(Objects, TwoPaddlersAreOfOneKayak) {
  for (const double turned_rad : {0.0, 0.5, -0.5}) {
    for (const auto& [gap_m, num_segments] : {std::pair{1.0, 1U}, {1.3, 1U}, {1.8, 2U}}) {
      std::vector<Wall> walls;
      for (const double side : {-1.0, 1.0}) {
        const double along_m = side * (gap_m + 0.5) / 2;
        AddBoat(walls, 12.0 + along_m * std::sin(turned_rad), along_m * std::cos(turned_rad), -turned_rad, 0.5, 0.5, -0.6, 0.3);
      }
      EXPECT_EQ(SegmentScan(See(walls), {}).segments.size(), num_segments) << gap_m << " m apart, turned by " << turned_rad;
    }
  }
}

// At 12 m, columns of 0.042 m: boats of 2.2 m that are 2.5 m apart, and a pole of 0.25 m between them.
TEST(Objects, APoleBetweenTwoBoatsIsOfTheNearerAndJoinsThemNot) {
  for (const bool is_mirrored : {false, true}) {
    for (const int first_column : {40, 400, 1500}) {
      const auto scan = Blocks({{0, 53}, {24, 7}, {29, 53}}, first_column, is_mirrored, 12.0);  // 1 m from one, 1.21 m from the other
      const auto segments = SegmentScan(scan, {});
      const auto label = [&](int column) {
        return segments.label[test::CellOf(scan, is_mirrored ? 1807 - first_column - column : first_column + column, 7)];
      };
      EXPECT_EQ(segments.segments.size(), 2U);
      EXPECT_EQ(label(0), label(76)) << "the pole is of the nearer";
      EXPECT_NE(label(0), label(52 + 24 + 6 + 29)) << "the farther is by itself";
    }
  }
}

// Its gaps are equal but for rounding, wherever it stands: so what is said of the pole is said in the mirror too.
TEST(Objects, APoleInTheMiddleOfTwoBoatsIsInAMirrorAsItIs) {
  int num_of_both = 0;
  int num_not_mirrored = 0;
  for (int first_column = 10; first_column < 1600; first_column += 7) {
    bool is_of[2][2]{};
    for (const bool is_mirrored : {false, true}) {
      const auto scan = Blocks({{0, 53}, {26, 7}, {26, 53}}, first_column, is_mirrored, 12.0);
      const auto segments = SegmentScan(scan, {});
      const auto label = [&](int column) {
        return segments.label[test::CellOf(scan, is_mirrored ? 1807 - first_column - column : first_column + column, 7)];
      };
      is_of[is_mirrored ? 1 : 0][0] = label(0) == label(80);
      is_of[is_mirrored ? 1 : 0][1] = label(136) == label(80);
    }
    num_of_both += is_of[0][0] && is_of[0][1] ? 1 : 0;
    num_not_mirrored += is_of[0][0] != is_of[1][0] || is_of[0][1] != is_of[1][1] ? 1 : 0;
  }
  EXPECT_EQ(num_not_mirrored, 0) << "of 228 places; at " << num_of_both << " it is of both";
}

// Three returns are tiny: at 20 m they join nothing over more than 0.5 m, which is the link and what few returns far away may lie apart.
TEST(Objects, TinyPiecesJoinNothing) {
  const double column_m = 20.0 * kTwoPi / 1808;
  const int metre = static_cast<int>(1.0 / column_m);  // four are a small part, attached up to 1.8 m
  for (const auto& [num_returns, num_segments] : {std::pair{3, 4U}, {4, 1U}}) {
    auto scan = test::EmptyScan({});
    for (int i = 0; i < 20; ++i) SetReturn(scan, 400 + i, 7, 20.0);
    int column = 419;
    for (int piece = 0; piece < 3; ++piece) {
      column += metre;
      for (int i = 0; i < num_returns; ++i) SetReturn(scan, column + i, 7, 20.0);
      column += num_returns - 1;
    }
    EXPECT_EQ(SegmentScan(scan, {}).segments.size(), num_segments) << num_returns;
  }
}

// Posts of 0.3 m at the corners of a rectangle of 6 m by 2.4 m, and one half way along each long side.
void AddDock(std::vector<Wall>& walls, double x_m, double y_m, double heading_rad) {
  for (const double along_m : {-3.0, 0.0, 3.0}) {
    for (const double across_m : {-1.2, 1.2}) {
      AddBoat(walls, x_m + along_m * std::cos(heading_rad) - across_m * std::sin(heading_rad),
              y_m + along_m * std::sin(heading_rad) + across_m * std::cos(heading_rad), heading_rad, 0.3, 0.3, kObjectsWaterM, 0.8);
    }
  }
}

TEST(Docks, PostsOnARectangleAreOfOne) {
  for (double heading_rad = 0.2; heading_rad < kPi; heading_rad += 0.5) {
    std::vector<Wall> walls;
    AddDock(walls, 12.0, 3.0, heading_rad);
    const auto segments = SegmentScan(See(walls), {});
    ASSERT_EQ(segments.segments.size(), 1U) << heading_rad;
    EXPECT_EQ(segments.segments[0].kind, SegmentKind::kObstacle);
    EXPECT_EQ(segments.segments[0].confidence, Confidence::kSure) << heading_rad;
  }
}

TEST(Docks, PostsInARowAreNotOfOne) {
  std::vector<Wall> walls;
  for (int post = 0; post < 4; ++post) AddBoat(walls, 12.0, 3.0 * post - 4.5, 0.0, 0.3, 0.3, kObjectsWaterM, 0.8);
  EXPECT_EQ(SegmentScan(See(walls), {}).segments.size(), 4U);
}

TEST(Docks, PostsInACrowdAreNotOfOne) {
  std::vector<Wall> walls;
  AddDock(walls, 14.0, 3.0, 0.2);
  auto scan = See(walls);
  const auto num_alone = SegmentScan(scan, {}).segments.size();
  // Drops all about, none on the posts' own beams.
  std::mt19937_64 random(5);
  for (int drop = 0; drop < 60;) {
    const int column = (1808 - 160 + static_cast<int>(random() % 200)) % 1808;
    const int ring = static_cast<int>(random() % 16);
    if (scan.columns.range[test::CellOf(scan, column, ring)] != 0) continue;
    SetReturn(scan, column, ring, 9.0 + static_cast<double>(random() % 1000) / 100.0);
    ++drop;
  }
  const auto segments = SegmentScan(scan, {});
  EXPECT_EQ(num_alone, 1U);
  int num_of_posts = 0;
  for (const auto& segment : segments.segments) num_of_posts += segment.num_points >= ThinPieces::kSolidReturns ? 1 : 0;
  EXPECT_GE(num_of_posts, 4) << "each by itself";
}

// One piece of `num` returns in a row at a range.
Segment Row(int num, int ring, double range_m) {
  auto scan = test::EmptyScan({});
  for (int i = 0; i < num; ++i) SetReturn(scan, 400 + i, ring, range_m);
  const auto segments = SegmentScan(scan, {});
  EXPECT_EQ(segments.segments.size(), 1U);
  return segments.segments.at(0);
}

TEST(Believing, FewReturnsAreTentative) {
  const auto few = Row(3, 8, 20.0);
  EXPECT_EQ(few.grounds, kFewReturns);
  EXPECT_EQ(few.confidence, Confidence::kTentative);
  const auto enough = Row(4, 8, 20.0);
  EXPECT_EQ(enough.grounds, 0);
  EXPECT_EQ(enough.confidence, Confidence::kSure);
}

TEST(Believing, WhatMostBeamsGoThroughIsScattered) {
  for (const auto& [every, grounds] : {std::pair{2, std::int32_t{kScattered}}, {1, 0}}) {
    auto scan = test::EmptyScan({});
    for (int column = 400; column < 420; column += every) {
      for (int ring = 7; ring < 10; ++ring) SetReturn(scan, column, ring, 20.0);
    }
    const auto segments = SegmentScan(scan, {});
    ASSERT_EQ(segments.segments.size(), 1U);
    EXPECT_EQ(segments.segments[0].grounds, grounds) << every;
  }
}

TEST(Believing, WhatIsNearAndHardlyHigherThanTheWaterIsAtItsSurface) {
  // The lidar is 1 m over the water. Ring 3 looks 9 degrees down: at 6 m 0.94 m below the lidar, 0.06 m over the water.
  EXPECT_EQ(Row(10, 3, 6.0).grounds, kAtSurface);
  EXPECT_EQ(Row(10, 4, 6.0).grounds, 0);   // 7 degrees down is 0.73 m below it: 0.27 m over the water, and 0.25 m is the limit
  EXPECT_EQ(Row(10, 5, 11.0).grounds, 0);  // as low, but beyond the 10 m within which foam is seen
}

TEST(Believing, LandIsSure) {
  // Every third beam only, low over the water: a slipway.
  auto scan = test::EmptyScan({});
  for (int column = 150; column < 950; column += 3) {
    for (const int ring : {4, 5}) SetReturn(scan, column, ring, 8.2);  // from end to end 16 m
  }
  const auto segments = SegmentScan(scan, {});
  ASSERT_EQ(segments.segments.size(), 1U);
  EXPECT_EQ(segments.segments[0].kind, SegmentKind::kLand);
  EXPECT_EQ(segments.segments[0].grounds, 0);
  EXPECT_EQ(segments.segments[0].confidence, Confidence::kSure);
}

TEST(Believing, TheSeenShareIsOfTheColumnsFromEndToEnd) {
  EXPECT_EQ(Row(10, 8, 20.0).seen_share, 1.0F);
  std::vector<Wall> walls{{-9.0, 25.0, 9.0, 25.0, kObjectsWaterM, 1.0}};
  AddBoat(walls, 0.0, 10.0, 0.0, 2.0, 1.0, kObjectsWaterM, 2.0);
  const auto segments = SegmentScan(See(walls), {});
  for (const auto& segment : segments.segments) {
    if (segment.kind != SegmentKind::kLand) continue;
    EXPECT_LT(segment.seen_share, 0.85F);
    EXPECT_GT(segment.seen_share, 0.6F);
  }
}

}  // namespace
}  // namespace lookout::segmenter
