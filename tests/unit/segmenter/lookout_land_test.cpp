// Land: what belongs to it, and what stays an obstacle beside it.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "services/segmenter/core/lookout/land.hpp"
#include "tests/unit/segmenter/lookout_stages.hpp"

namespace lookout::segmenter {
namespace {

using test::AddBoat;
using test::See;
using test::SegmentOf;
using test::SegmentsNear;
using test::Wall;

constexpr double kWaterM = -1.0;  // of the lidar 1 m over it

// The only segment near a place, and its kind.
int OnlyAt(const Scan& scan, const Segments& segments, double x_m, double y_m, double radius_m) {
  const auto ids = SegmentsNear(scan, segments, x_m, y_m, radius_m);
  EXPECT_EQ(ids.size(), 1U) << "at " << x_m << ", " << y_m;
  return ids.empty() ? 1 : *ids.begin();
}

// A boat is not land, a long quay is, and between them there is one length from which on a wall is land.
TEST(Land, IsWhatIsLongAndHasAWaterline) {
  std::vector<bool> is_land;
  for (double length_m = 6.0; length_m <= 40.0; length_m += 1.0) {
    const auto scan = See({{-length_m / 2, 20.0, length_m / 2, 20.0, kWaterM, 1.0}});
    const auto segments = SegmentScan(scan, {});
    ASSERT_EQ(segments.segments.size(), 1U) << length_m;
    is_land.push_back(segments.segments[0].kind == SegmentKind::kLand);
    EXPECT_EQ(segments.segments[0].waterline.empty(), !is_land.back()) << length_m;
  }
  EXPECT_FALSE(is_land.front());
  EXPECT_TRUE(is_land.back());
  EXPECT_TRUE(std::ranges::is_sorted(is_land)) << testing::PrintToString(is_land);
}

TEST(Land, IsAlsoASquareBasinAllRound) {
  std::vector<Wall> walls;
  AddBoat(walls, 0.0, 0.0, 0.0, 60.0, 16.0, kWaterM, 3.0);
  const auto segments = SegmentScan(See(walls), {});
  ASSERT_EQ(segments.segments.size(), 1U);
  EXPECT_EQ(segments.segments[0].kind, SegmentKind::kLand);
}

TEST(Land, AWallBehindANearerBoatIsOne) {
  for (const double turned_rad : {0.0, 0.9, 2.2, 3.1, 4.5}) {  // also over the seam
    const double cos_turned = std::cos(turned_rad);
    const double sin_turned = std::sin(turned_rad);
    const auto x = [&](double x_m, double y_m) { return x_m * cos_turned - y_m * sin_turned; };
    const auto y = [&](double x_m, double y_m) { return x_m * sin_turned + y_m * cos_turned; };
    std::vector<Wall> walls{{x(-14, 20), y(-14, 20), x(14, 20), y(14, 20), kWaterM, 0.5}};
    AddBoat(walls, x(0, 12), y(0, 12), turned_rad, 6.0, 2.0, kWaterM, 3.0);
    const auto scan = See(walls);
    const auto segments = SegmentScan(scan, {});
    const int boat = OnlyAt(scan, segments, x(0, 11), y(0, 11), 2.0);
    const int left = OnlyAt(scan, segments, x(-12, 20), y(-12, 20), 1.0);
    const int right = OnlyAt(scan, segments, x(12, 20), y(12, 20), 1.0);
    EXPECT_EQ(left, right) << turned_rad;
    EXPECT_NE(left, boat);
    EXPECT_EQ(SegmentOf(segments, left).kind, SegmentKind::kLand);
    EXPECT_EQ(SegmentOf(segments, boat).kind, SegmentKind::kObstacle);
  }
}

TEST(Land, TwoBoatsInLineWithOpenWaterBetweenStayTwo) {
  for (const double gap_m : {4.0, 6.0, 10.0}) {
    std::vector<Wall> walls;
    AddBoat(walls, -(7.0 + gap_m) / 2, 22.0, 0.0, 7.0, 2.0, kWaterM, 1.0);
    AddBoat(walls, (7.0 + gap_m) / 2, 22.0, 0.0, 7.0, 2.0, kWaterM, 1.0);
    const auto segments = SegmentScan(See(walls), {});
    int num_sure = 0;
    for (const auto& segment : segments.segments) {
      EXPECT_EQ(segment.kind, SegmentKind::kObstacle) << gap_m;
      num_sure += segment.confidence == Confidence::kSure ? 1 : 0;
    }
    EXPECT_EQ(num_sure, 2) << gap_m;
  }
}

// A low beach that winds a little, 45 m off, and a kayak 1 m before it.
TEST(Land, AKayakOneMetreOffABeachIsNotOfIt) {
  for (const double along_m : {-10.0, 0.0, 8.0}) {
    std::vector<Wall> walls;
    const auto beach_m = [](double x_m) { return 45.0 + 0.4 * std::sin(x_m / 4.0); };
    for (double x_m = -30.0; x_m < 30.0; x_m += 1.0) walls.push_back({x_m, beach_m(x_m), x_m + 1.0, beach_m(x_m + 1.0), kWaterM, 1.0});
    AddBoat(walls, along_m, beach_m(along_m) - 1.4, 0.05, 4.0, 0.6, kWaterM, -0.5);
    const auto scan = See(walls);
    const auto segments = SegmentScan(scan, {});
    const int kayak = OnlyAt(scan, segments, along_m, beach_m(along_m) - 1.7, 0.5);
    const int beach = OnlyAt(scan, segments, -25.0, beach_m(-25.0), 1.0);
    EXPECT_NE(kayak, beach);
    EXPECT_EQ(SegmentOf(segments, kayak).kind, SegmentKind::kObstacle);
    EXPECT_EQ(SegmentOf(segments, beach).kind, SegmentKind::kLand);
    EXPECT_EQ(beach, OnlyAt(scan, segments, 25.0, beach_m(25.0), 1.0)) << "the beach is one";
  }
}

// A stony shore, and trees 6 m behind that stand over it.
std::vector<Wall> ShoreWithTrees() {
  std::vector<Wall> walls;
  const auto shore_m = [](double x_m) { return 30.0 + 1.5 * std::sin(x_m / 3.0); };
  for (double x_m = -25.0; x_m < 25.0; x_m += 0.5) walls.push_back({x_m, shore_m(x_m), x_m + 0.5, shore_m(x_m + 0.5), kWaterM, 0.3});
  for (double x_m = -20.0; x_m < 20.0; x_m += 5.0) AddBoat(walls, x_m, 38.0, 0.4, 2.0, 2.0, 0.5, 6.0);
  return walls;
}

TEST(Land, TakesTheTreesBehindIt) {
  const auto segments = SegmentScan(See(ShoreWithTrees()), {});
  ASSERT_EQ(segments.segments.size(), 1U);
  EXPECT_EQ(segments.segments[0].kind, SegmentKind::kLand);
}

TEST(Land, DoesNotTakeABoatBehindAStraightPier) {
  for (const double behind_m : {4.0, 7.0}) {
    std::vector<Wall> walls{{-15.0, 20.0, 15.0, 20.0, kWaterM, 0.0}};
    AddBoat(walls, -3.0, 20.0 + behind_m, 0.2, 7.0, 2.5, kWaterM, 2.0);
    const auto scan = See(walls);
    const auto segments = SegmentScan(scan, {});
    ASSERT_EQ(segments.segments.size(), 2U) << behind_m;
    EXPECT_EQ(SegmentOf(segments, OnlyAt(scan, segments, 10.0, 20.0, 2.0)).kind, SegmentKind::kLand);
    EXPECT_EQ(SegmentOf(segments, OnlyAt(scan, segments, -3.0, 20.0 + behind_m - 1.2, 1.0)).kind, SegmentKind::kObstacle);
  }
}

// Behind land means most of it: of this one a quarter is.
TEST(Land, DoesNotTakeABoatThatLiesPastItsEnd) {
  auto walls = ShoreWithTrees();
  AddBoat(walls, 32.0, 37.0, 0.0, 12.0, 3.0, kWaterM, 2.0);
  const auto scan = See(walls);
  const auto segments = SegmentScan(scan, {});
  EXPECT_EQ(SegmentOf(segments, OnlyAt(scan, segments, 34.0, 35.5, 2.0)).kind, SegmentKind::kObstacle);
}

TEST(Land, DoesNotTakeABoatBeforeIt) {
  auto walls = ShoreWithTrees();
  AddBoat(walls, 2.0, 20.0, 0.3, 6.0, 2.0, kWaterM, 1.0);
  const auto scan = See(walls);
  const auto segments = SegmentScan(scan, {});
  ASSERT_EQ(segments.segments.size(), 2U);
  EXPECT_EQ(SegmentOf(segments, OnlyAt(scan, segments, 2.0, 19.0, 1.5)).kind, SegmentKind::kObstacle);
}

struct Tree {
  double x_m = 0.0;
  double y_m = 0.0;
  double width_m = 0.0;
};

// Things 6 m high, as seen over what hides their foot.
Segments SeeTrees(const std::vector<Tree>& trees) {
  std::vector<Wall> walls;
  for (const Tree& tree : trees) AddBoat(walls, tree.x_m, tree.y_m, 0.4, tree.width_m, tree.width_m, 0.0, 5.0);
  return SegmentScan(See(walls), {});
}

// 35 to 40 m off, their middles 5 m apart.
std::vector<Tree> RowOfTrees(int num_trees, double width_m) {
  std::vector<Tree> trees;
  for (int i = 0; i < num_trees; ++i) trees.push_back({5.0 * i - 10.0, i % 2 == 0 ? 37.0 : 39.5, width_m});
  return trees;
}

std::size_t NumLand(const Segments& segments) {
  return static_cast<std::size_t>(std::ranges::count(segments.segments, SegmentKind::kLand, &Segment::kind));
}

TEST(Groves, TreesOverTwentyMetresAreOneLand) {
  for (const double width_m : {2.0, 2.5, 3.0}) {
    const auto segments = SeeTrees(RowOfTrees(5, width_m));
    EXPECT_EQ(segments.segments.size(), 1U) << width_m;
    EXPECT_EQ(NumLand(segments), 1U) << width_m;
  }
}

TEST(Groves, TwoTreesAreNoLand) {
  const auto two = SeeTrees(RowOfTrees(2, 2.5));
  EXPECT_EQ(two.segments.size(), 2U);
  EXPECT_EQ(NumLand(two), 0U);
  // However wide: 18 m from end to end, of which they fill 12 m.
  EXPECT_EQ(NumLand(SeeTrees({{-6.0, 40.0, 5.0}, {6.0, 40.0, 5.0}})), 0U);
  EXPECT_EQ(NumLand(SeeTrees({{-12.0, 40.0, 5.0}, {0.0, 40.0, 5.0}, {12.0, 40.0, 5.0}})), 1U) << "but a third one makes a grove of them";
}

TEST(Groves, AreAsLongAsLandAndFilled) {
  EXPECT_EQ(NumLand(SeeTrees({{-5.0, 40.0, 2.5}, {0.0, 40.0, 2.5}, {5.0, 40.0, 2.5}})), 0U) << "13 m from end to end";
  EXPECT_EQ(NumLand(SeeTrees({{-6.5, 40.0, 3.0}, {0.0, 40.0, 3.0}, {6.5, 40.0, 3.0}})), 1U) << "17 m";
  // Three of 2 m fill 8 m at most of as much, and 0.6 x 15 = 9 m is the least.
  EXPECT_EQ(NumLand(SeeTrees({{-7.0, 40.0, 2.0}, {0.0, 40.0, 2.0}, {7.0, 40.0, 2.0}})), 0U);
  // Nearest returns 11 m apart: more than 6 + 0.08 x 40 = 9.2 m.
  EXPECT_EQ(NumLand(SeeTrees({{-15.0, 40.0, 4.0}, {0.0, 40.0, 4.0}, {15.0, 40.0, 4.0}})), 0U);
}

TEST(Groves, MastsAreNone) {
  const auto segments = SeeTrees(RowOfTrees(5, 0.3));
  EXPECT_EQ(segments.segments.size(), 5U);
  EXPECT_EQ(NumLand(segments), 0U);
}

// A row of boats' masts past the end of a shore with trees, the first one 3 m off it.
TEST(Land, DoesNotTakeMastsBesideIt) {
  for (const bool is_mirrored : {false, true}) {
    auto walls = ShoreWithTrees();
    for (int mast = 0; mast < 4; ++mast) AddBoat(walls, 28.0 + 3.0 * mast, 30.0, 0.4, 0.3, 0.3, kWaterM, 8.0);
    if (is_mirrored) {
      for (Wall& wall : walls) wall.x0_m = -wall.x0_m, wall.x1_m = -wall.x1_m;
    }
    const auto segments = SegmentScan(See(walls), {});
    EXPECT_EQ(NumLand(segments), 1U);
    EXPECT_EQ(segments.segments.size(), 5U);
  }
}

// What is as high and as near, but wide, is a tree.
TEST(Land, TakesATreeBesideIt) {
  auto walls = ShoreWithTrees();
  AddBoat(walls, 31.0, 30.0, 0.4, 2.5, 2.5, kWaterM, 5.0);
  const auto segments = SegmentScan(See(walls), {});
  EXPECT_EQ(segments.segments.size(), 1U);
  EXPECT_EQ(NumLand(segments), 1U);
}

// A hull of 7 m with a mast of 0.25 m, 9 m high, its far side 4 m before the nearest of the shore.
TEST(Land, DoesNotTakeASailingBoatBeforeIt) {
  for (const double x_m : {-12.0, -2.0, 5.0, 15.0}) {
    auto walls = ShoreWithTrees();
    AddBoat(walls, x_m, 23.3, 0.1, 7.0, 2.4, kWaterM, 0.2);
    AddBoat(walls, x_m, 23.3, 0.1, 0.25, 0.25, 0.2, 8.0);
    const auto scan = See(walls);
    const auto segments = SegmentScan(scan, {});
    EXPECT_EQ(SegmentOf(segments, OnlyAt(scan, segments, x_m, 23.0, 1.5)).kind, SegmentKind::kObstacle) << x_m;  // hull and mast are one
    EXPECT_EQ(NumLand(segments), 1U) << x_m;
  }
}

// The waterline: from left to right, on returns of the land, at most 256 corners, and nothing nearer than it.
void CheckWaterline(const Scan& scan, const Segments& segments, const Segment& land) {
  ASSERT_GE(land.waterline.size(), 2U);
  ASSERT_LE(land.waterline.size(), kMaxWaterlineCorners);
  const auto azimuth_rad = [](const HullCorner& corner) { return -std::atan2(double{corner.y_m}, double{corner.x_m}); };
  for (std::size_t i = 0; i + 1 < land.waterline.size(); ++i) {
    EXPECT_GT(WrapToPi(azimuth_rad(land.waterline[i + 1]) - azimuth_rad(land.waterline[i])), 0.0) << "corner " << i;
  }
  // The nearest return of each column lies on it: 0.1 m, and a little more where it was simplified further.
  const auto& returns = ClassifyReturns(scan, {}).returns;
  for (std::size_t i = 0; i < returns.size();) {
    const int column = returns[i].column;
    double nearest_m = 1e9;
    Point nearest;
    for (; i < returns.size() && returns[i].column == column; ++i) {
      const Point& point = returns[i].point;
      if (segments.label[static_cast<std::size_t>(returns[i].cell)] != land.id || std::hypot(point.x_m, point.y_m) >= nearest_m) continue;
      nearest_m = std::hypot(point.x_m, point.y_m);
      nearest = point;
    }
    if (nearest_m > 1e8) continue;
    double off_m = 1e9;
    for (std::size_t corner = 0; corner + 1 < land.waterline.size(); ++corner) {
      const auto& a = land.waterline[corner];
      const auto& b = land.waterline[corner + 1];
      const double length_m2 = std::pow(b.x_m - a.x_m, 2) + std::pow(b.y_m - a.y_m, 2);
      const double along_m2 = (nearest.x_m - a.x_m) * (b.x_m - a.x_m) + (nearest.y_m - a.y_m) * (b.y_m - a.y_m);
      const double share = length_m2 > 0.0 ? std::clamp(along_m2 / length_m2, 0.0, 1.0) : 0.0;
      off_m = std::min(off_m, std::hypot(nearest.x_m - a.x_m - share * (b.x_m - a.x_m), nearest.y_m - a.y_m - share * (b.y_m - a.y_m)));
    }
    ASSERT_LE(off_m, 0.1 + 1e-3) << "column " << column;
  }
}

TEST(Waterline, GoesFromLeftToRightAlongTheNearestReturns) {
  for (const double turned_deg : {0.0, 60.0, 90.0, 180.0, 300.0}) {
    std::vector<Wall> walls;
    for (auto wall : ShoreWithTrees()) {
      const double turned_rad = DegToRad(turned_deg);
      const auto turn = [turned_rad](double& x_m, double& y_m) {
        const double was_x_m = x_m;
        x_m = was_x_m * std::cos(turned_rad) - y_m * std::sin(turned_rad);
        y_m = was_x_m * std::sin(turned_rad) + y_m * std::cos(turned_rad);
      };
      turn(wall.x0_m, wall.y0_m);
      turn(wall.x1_m, wall.y1_m);
      walls.push_back(wall);
    }
    const auto scan = See(walls);
    const auto segments = SegmentScan(scan, {});
    ASSERT_EQ(segments.segments.size(), 1U) << turned_deg;
    CheckWaterline(scan, segments, segments.segments[0]);
  }
}

TEST(Waterline, HasAtMost256CornersHoweverRaggedTheShore) {
  auto scan = test::EmptyScan({.num_columns = 2048});
  for (int column = 100; column < 1900; ++column) {
    for (int ring = 6; ring < 10; ++ring) test::SetReturn(scan, column, ring, column % 2 == 0 ? 30.0 : 30.5);
  }
  const auto segments = SegmentScan(scan, {});
  ASSERT_EQ(segments.segments.size(), 1U);
  ASSERT_EQ(segments.segments[0].kind, SegmentKind::kLand);
  EXPECT_GE(segments.segments[0].waterline.size(), 2U);
  EXPECT_LE(segments.segments[0].waterline.size(), kMaxWaterlineCorners);
}

TEST(Waterline, HasTheTimesOfItsReturns) {
  const auto scan = See({{-14.0, 20.0, 14.0, 20.0, kWaterM, 0.5}});
  const auto segments = SegmentScan(scan, {});
  ASSERT_EQ(segments.segments.size(), 1U);
  const auto& line = segments.segments[0].waterline;
  ASSERT_GE(line.size(), 2U);
  for (const auto& corner : line) {
    const double azimuth_rad = WrapTo2Pi(-std::atan2(double{corner.y_m}, double{corner.x_m}));
    EXPECT_NEAR(corner.time_us, azimuth_rad / kTwoPi * 1808 * 55.296, 200.0);
  }
}

}  // namespace
}  // namespace lookout::segmenter
