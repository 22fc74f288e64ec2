// Which pieces are of one object, and how far a segment is believed.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "services/segmenter/core/lookout/objects.hpp"
#include "tests/unit/segmenter/lookout_stages.hpp"

namespace lookout::segmenter {
namespace {

using test::AddBoat;
using test::See;
using test::SetReturn;
using test::Wall;

constexpr double kObjectsWaterM = -1.0;  // of the lidar 1 m over it

TEST(Objects, ACabinOverAHullIsOfIt) {
  // The cabin stands 2.4 m behind the side of the hull, more than what is joined side by side at 12 m (1.72 m).
  std::vector<Wall> walls;
  AddBoat(walls, 12.0, 0.0, kPi / 2, 9.0, 3.0, kObjectsWaterM, -0.2);
  AddBoat(walls, 14.0, 0.0, kPi / 2, 3.0, 1.6, 0.0, 2.5);
  EXPECT_EQ(SegmentScan(See(walls), {}).segments.size(), 1U);
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

TEST(Objects, WhatIsJoinedSideBySideIsWithinTheReach) {
  // Two blocks of 8 columns at 20 m: joined up to 1.6 + 0.01 x 20 = 1.8 m.
  const double column_m = 20.0 * kTwoPi / 1808;
  for (const auto& [columns_apart, num_segments] : {std::pair{static_cast<int>(1.75 / column_m), 1U}, {static_cast<int>(1.95 / column_m), 2U}}) {
    auto scan = test::EmptyScan({});
    for (int i = 0; i < 8; ++i) {
      SetReturn(scan, 400 + i, 7, 20.0);
      SetReturn(scan, 407 + columns_apart + i, 7, 20.0);
    }
    EXPECT_EQ(SegmentScan(scan, {}).segments.size(), num_segments) << columns_apart;
  }
}

// Three returns are tiny: farther apart than the link they join nothing, however near to each other and to a hull.
TEST(Objects, TinyPiecesJoinNothing) {
  const double column_m = 20.0 * kTwoPi / 1808;
  const int metre = static_cast<int>(1.0 / column_m);  // beyond the link of 0.5 m, within the reach of 1.8 m
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
