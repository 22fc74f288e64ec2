#include "services/tracker/core/outline.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout::tracker {
namespace {

using Polygon2d = std::vector<Eigen::Vector2d>;

const Polygon2d kSquare{{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};
const Polygon2d kLine{{0.0, 0.0}, {3.0, 4.0}};
const Polygon2d kPoint{{-7.0, 11.0}};

Polygon2d Moved(Polygon2d polygon, const Eigen::Vector2d& by_m) {
  for (auto& corner : polygon) corner += by_m;
  return polygon;
}

// A convex polygon of 1 to 16 corners: on an ellipse, in the order of their angles.
Polygon2d RandomPolygon(std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<double> angles(1 + random() % 16);
  for (auto& angle_rad : angles) angle_rad = kTwoPi * share(random);
  std::sort(angles.begin(), angles.end());
  const Eigen::Vector2d center(20.0 * share(random) - 10.0, 20.0 * share(random) - 10.0);
  const double length_m = 0.1 + 8.0 * share(random);
  const double width_m = 0.1 + 3.0 * share(random);
  Polygon2d polygon;
  for (const double angle_rad : angles) polygon.emplace_back(center + Eigen::Vector2d(length_m * std::cos(angle_rad), width_m * std::sin(angle_rad)));
  return polygon;
}

double DistanceToSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  const double share = along.squaredNorm() > 0.0 ? std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0.0;
  return (from + share * along - point).norm();
}

// Of two outlines that do not cross: every corner against every edge.
double PlainGap(const Polygon2d& first, const Polygon2d& second) {
  double least_m = 1e9;
  const auto corners_to_edges = [&least_m](const Polygon2d& corners, const Polygon2d& edges) {
    for (const auto& corner : corners) {
      for (std::size_t i = 0; i < edges.size(); ++i) least_m = std::min(least_m, DistanceToSegment(corner, edges[i], edges[(i + 1) % edges.size()]));
    }
  };
  corners_to_edges(first, second);
  corners_to_edges(second, first);
  return least_m;
}

TEST(Outline, ReachesAsFarAsItsCorners) {
  const auto support = SupportOf(kSquare);
  EXPECT_EQ(support[0], 2.0);
  EXPECT_EQ(support[4], 2.0);
  EXPECT_EQ(support[8], 0.0);
  EXPECT_EQ(support[12], 0.0);
  EXPECT_NEAR(support[2], 2.0 * std::numbers::sqrt2, 1e-12);
}

TEST(Outline, ComesBackFromItsReaches) {
  const auto polygon = Polygon(SupportOf(kSquare));
  EXPECT_EQ(polygon.size(), 4U);
  EXPECT_NEAR(AreaOf(polygon), 4.0, 1e-9);
  for (const auto& corner : kSquare) EXPECT_NEAR(PlainGap({corner}, polygon), 0.0, 1e-9);
}

TEST(Outline, OfAPointIsThatPoint) {
  for (const auto& point : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(-7.0, 11.0), Eigen::Vector2d(12345.678, -9876.543)}) {
    const auto polygon = Polygon(SupportOf(Polygon2d{point}));
    ASSERT_EQ(polygon.size(), 1U);
    EXPECT_NEAR((polygon[0] - point).norm(), 0.0, 1e-8);
  }
}

TEST(Outline, OfALineAlongADirectionIsThatLine) {
  for (std::size_t i = 0; i < kDirections; ++i) {
    const Polygon2d line{{100.0, -50.0}, Eigen::Vector2d(100.0, -50.0) + 5.0 * CompassDirections()[i]};
    const auto polygon = Polygon(SupportOf(line));
    ASSERT_EQ(polygon.size(), 2U) << i;
    EXPECT_NEAR((polygon[0] - polygon[1]).norm(), 5.0, 1e-8);
    for (const auto& corner : line) EXPECT_NEAR(PlainGap({corner}, polygon), 0.0, 1e-8);
  }
}

TEST(Outline, HoldsWhatItIsMadeOf) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const auto truth = RandomPolygon(random);
    const auto support = SupportOf(truth);
    const auto polygon = Polygon(support);
    ASSERT_GE(polygon.size(), 1U);
    ASSERT_LE(polygon.size(), kDirections);
    for (const auto& corner : truth) EXPECT_EQ(GapOf(Polygon2d{corner}, polygon).distance_m, 0.0);
    const auto again = SupportOf(polygon);
    for (std::size_t k = 0; k < kDirections; ++k) EXPECT_NEAR(again[k], support[k], 1e-5);
    for (std::size_t k = 0; k < polygon.size() && polygon.size() > 2; ++k) {
      const auto& next = polygon[(k + 1) % polygon.size()];
      EXPECT_GT(Cross(next - polygon[k], polygon[(k + 2) % polygon.size()] - next), 0.0);
    }
  }
}

TEST(Outline, LeavesOutWhatItsNeighboursCutOff) {
  auto support = SupportOf(kSquare);
  support[2] = 50.0;
  EXPECT_NEAR(AreaOf(Polygon(support)), 4.0, 1e-9);
  support[1] = support[3] = 50.0;
  EXPECT_NEAR(AreaOf(Polygon(support)), 4.0, 1e-9);
}

// A pontoon whose two sides were measured 4 cm through each other keeps its length.
TEST(Outline, IsALineMidwayWhereTwoSidesContradict) {
  auto support = SupportOf(Polygon2d{{-10.0, 0.0}, {10.0, 0.0}});
  support[4] = 1.0;
  support[12] = -1.04;
  const auto polygon = Polygon(support);
  ASSERT_EQ(polygon.size(), 2U);
  EXPECT_NEAR(polygon[0].y(), 1.02, 1e-6);
  EXPECT_NEAR(polygon[1].y(), 1.02, 1e-6);
  EXPECT_GT((polygon[0] - polygon[1]).norm(), 14.0);
}

TEST(Outline, IsAPointWhereThreeSidesContradict) {
  Support support;
  support.fill(10.0);
  support[0] = -1.0;  // these three are met nowhere
  support[5] = -1.0;
  support[11] = -1.0;
  const auto polygon = Polygon(support);
  ASSERT_EQ(polygon.size(), 1U);
  const auto& directions = CompassDirections();
  const double slack_m = directions[0].dot(polygon[0]) + 1.0;
  EXPECT_GT(slack_m, 0.0);
  EXPECT_NEAR(directions[5].dot(polygon[0]) + 1.0, slack_m, 1e-6);
  EXPECT_NEAR(directions[11].dot(polygon[0]) + 1.0, slack_m, 1e-6);
}

TEST(Outline, IsNeverEmptyWhateverItsReaches) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> reach(0.0, 1.0);
  for (int i = 0; i < 5000; ++i) {
    Support support;
    for (auto& reach_m : support) reach_m = reach(random) + 0.001 * static_cast<double>(i);
    const auto polygon = Polygon(support);
    ASSERT_GE(polygon.size(), 1U) << i;
    ASSERT_LE(polygon.size(), kDirections) << i;
    EXPECT_GE(AreaOf(polygon), 0.0);
  }
}

TEST(Contains, IsExactForPolygonsLinesAndPoints) {
  EXPECT_TRUE(Contains(kSquare, {1.0, 1.0}));
  EXPECT_TRUE(Contains(kSquare, {2.0, 2.0}));
  EXPECT_FALSE(Contains(kSquare, {2.00001, 1.0}));
  EXPECT_TRUE(Contains(kLine, {1.5, 2.0}));
  EXPECT_TRUE(Contains(kLine, {3.0, 4.0}));
  EXPECT_FALSE(Contains(kLine, {3.3, 4.4})) << "beyond its end";
  EXPECT_FALSE(Contains(kLine, {-0.3, -0.4}));
  EXPECT_FALSE(Contains(kLine, {1.5, 2.00001}));
  EXPECT_TRUE(Contains(kPoint, {-7.0, 11.0}));
  EXPECT_FALSE(Contains(kPoint, {-7.0, 11.00001}));
  const Polygon2d needle{{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}};
  EXPECT_TRUE(Contains(needle, {1.5, 1.5}));
  EXPECT_FALSE(Contains(needle, {2.1, 2.1})) << "three corners on one line";
}

TEST(GapOf, LiesBetweenTheNearestPoints) {
  const auto gap = GapOf(kSquare, Moved(kSquare, {5.0, 1.0}));
  EXPECT_DOUBLE_EQ(gap.distance_m, 3.0);
  EXPECT_DOUBLE_EQ(gap.from_m.x(), 2.0);
  EXPECT_DOUBLE_EQ(gap.to_m.x(), 5.0);
  EXPECT_DOUBLE_EQ(gap.from_m.y(), gap.to_m.y());
}

TEST(GapOf, OfPointsAndLines) {
  EXPECT_DOUBLE_EQ(GapOf(Polygon2d{{0.0, 0.0}}, Polygon2d{{3.0, 4.0}}).distance_m, 5.0);
  EXPECT_EQ(GapOf(kPoint, kPoint).distance_m, 0.0);
  EXPECT_DOUBLE_EQ(GapOf(kLine, Moved(kLine, {4.0, -3.0})).distance_m, 5.0) << "beside each other";
  EXPECT_DOUBLE_EQ(GapOf(kLine, Moved(kLine, {6.0, 8.0})).distance_m, 5.0) << "in one line";
  EXPECT_EQ(GapOf(Polygon2d{{0.0, 0.0}, {2.0, 2.0}}, Polygon2d{{0.0, 2.0}, {2.0, 0.0}}).distance_m, 0.0) << "crossed";
  EXPECT_NEAR(GapOf(kSquare, Polygon2d{{3.0, 3.0}}).distance_m, std::numbers::sqrt2, 1e-12);
  EXPECT_EQ(GapOf(kSquare, Polygon2d{{1.0, 1.0}}).distance_m, 0.0);
}

TEST(GapOf, IsThatOfEveryCornerAgainstEveryEdge) {
  std::mt19937_64 random(3);
  int num_overlapping = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto first = RandomPolygon(random);
    const auto second = RandomPolygon(random);
    const auto gap = GapOf(first, second);
    const auto shared = Intersection(first, second);
    if (gap.distance_m == 0.0) {
      ++num_overlapping;
      EXPECT_FALSE(shared.empty()) << i;
      EXPECT_EQ(gap.from_m, gap.to_m);
      EXPECT_LT(GapOf(first, Polygon2d{gap.from_m}).distance_m, 1e-6) << i;
      EXPECT_LT(GapOf(second, Polygon2d{gap.from_m}).distance_m, 1e-6) << i;
    } else {
      EXPECT_TRUE(shared.empty()) << i;
      EXPECT_NEAR(gap.distance_m, PlainGap(first, second), 1e-9) << i;
      EXPECT_NEAR((gap.from_m - gap.to_m).norm(), gap.distance_m, 1e-9) << i;
      EXPECT_NEAR(PlainGap({gap.from_m}, first), 0.0, 1e-9) << i;
      EXPECT_NEAR(PlainGap({gap.to_m}, second), 0.0, 1e-9) << i;
    }
  }
  EXPECT_GT(num_overlapping, 2000);
  EXPECT_LT(num_overlapping, 18000);
}

TEST(AreaOf, IsPositiveCounterClockwise) {
  EXPECT_DOUBLE_EQ(AreaOf(kSquare), 4.0);
  EXPECT_DOUBLE_EQ(AreaOf(Polygon2d(kSquare.rbegin(), kSquare.rend())), -4.0);
  EXPECT_EQ(AreaOf(kLine), 0.0);
  EXPECT_EQ(AreaOf(kPoint), 0.0);
}

TEST(Intersection, OfSquares) {
  EXPECT_NEAR(AreaOf(Intersection(kSquare, Moved(kSquare, {1.0, 0.5}))), 1.5, 1e-9);
  EXPECT_NEAR(AreaOf(Intersection(kSquare, kSquare)), 4.0, 1e-9);
  EXPECT_TRUE(Intersection(kSquare, Moved(kSquare, {2.1, 0.0})).empty());
  EXPECT_EQ(Intersection(kSquare, Moved(kSquare, {2.0, 0.0})).size(), 2U) << "a shared side";
}

TEST(Intersection, OfLinesAndPoints) {
  const auto cut = Intersection(Polygon2d{{-1.0, 1.0}, {5.0, 1.0}}, kSquare);
  ASSERT_EQ(cut.size(), 2U);
  EXPECT_NEAR((cut[0] - cut[1]).norm(), 2.0, 1e-9);
  EXPECT_EQ(Intersection(kSquare, Polygon2d{{-1.0, 1.0}, {5.0, 1.0}}).size(), 2U);
  const auto crossing = Intersection(Polygon2d{{0.0, 0.0}, {2.0, 2.0}}, Polygon2d{{0.0, 2.0}, {2.0, 0.0}});
  ASSERT_EQ(crossing.size(), 1U);
  EXPECT_NEAR((crossing[0] - Eigen::Vector2d(1.0, 1.0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(Intersection(kSquare, Polygon2d{{1.0, 1.0}}).size(), 1U);
  EXPECT_EQ(Intersection(Polygon2d{{1.0, 1.0}}, kSquare).size(), 1U);
  EXPECT_TRUE(Intersection(kSquare, Polygon2d{{3.0, 1.0}}).empty());
  EXPECT_TRUE(Intersection(kSquare, Polygon2d{}).empty());
}

}  // namespace
}  // namespace lookout::tracker
