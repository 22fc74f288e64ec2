#include "common/core/outlines.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout {
namespace {

using Polygon2d = std::vector<Eigen::Vector2d>;

const Polygon2d kSquare{{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};
const Polygon2d kLine{{0.0, 0.0}, {3.0, 4.0}};
const Polygon2d kPoint{{-7.0, 11.0}};

Polygon2d Square(double east_m, double north_m, double half_m) {
  return {{east_m - half_m, north_m - half_m},
          {east_m + half_m, north_m - half_m},
          {east_m + half_m, north_m + half_m},
          {east_m - half_m, north_m + half_m}};
}

TEST(Outlines, DistanceIsThatOfTheNearestEdges) {
  EXPECT_DOUBLE_EQ(GapBetween(Square(0.0, 0.0, 1.0), Square(5.0, 0.5, 1.0)), 3.0);
  EXPECT_DOUBLE_EQ(GapBetween(Square(0.0, 0.0, 1.0), Square(5.0, 6.0, 1.0)), 5.0) << "corner to corner: 3, 4, 5";
}

TEST(Outlines, DistanceIsZeroWhenTheyCrossTouchOrHoldEachOther) {
  EXPECT_EQ(GapBetween(Square(0.0, 0.0, 1.0), Square(1.5, 0.0, 1.0)), 0.0);
  EXPECT_EQ(GapBetween(Square(0.0, 0.0, 1.0), Square(2.0, 0.0, 1.0)), 0.0);
  EXPECT_EQ(GapBetween(Square(0.0, 0.0, 1.0), Square(0.0, 0.0, 9.0)), 0.0);
  EXPECT_EQ(GapBetween(Square(0.0, 0.0, 9.0), Square(0.0, 0.0, 1.0)), 0.0);
  // A cross: no corner of one lies in the other.
  EXPECT_EQ(GapBetween(Polygon2d{{-9.0, -1.0}, {9.0, -1.0}, {9.0, 1.0}, {-9.0, 1.0}}, Polygon2d{{-1.0, -9.0}, {1.0, -9.0}, {1.0, 9.0}, {-1.0, 9.0}}),
            0.0);
}

TEST(Outlines, HoldsWhatLiesInItAlsoWhenItIsNotConvex) {
  const Polygon2d hook_m{{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {3.0, 4.0}, {3.0, 1.0}, {0.0, 1.0}};
  EXPECT_TRUE(Contains(hook_m, {3.5, 3.0}));
  EXPECT_TRUE(Contains(hook_m, {0.5, 0.5}));
  EXPECT_FALSE(Contains(hook_m, {1.0, 3.0}));
  EXPECT_FALSE(Contains(hook_m, {5.0, 0.5}));
}

TEST(RectangleAround, IsThatOfLeastArea) {
  const double angle_rad = DegToRad(130.0);
  const Eigen::Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d center(30.0, -40.0);
  const Polygon2d hull{center - 3.0 * along - across, center + 3.0 * along - across, center + 3.0 * along + 0.2 * across,
                       center + 2.0 * along + across, center - 3.0 * along + across};
  const auto rectangle = RectangleAround(hull);
  EXPECT_NEAR(rectangle.length_m, 6.0, 1e-9);
  EXPECT_NEAR(rectangle.width_m, 2.0, 1e-9);
  EXPECT_NEAR(rectangle.length_angle_rad, angle_rad, 1e-9);
  EXPECT_NEAR((rectangle.center_m - center).norm(), 0.0, 1e-9);
}

TEST(RectangleAround, OfALineAndAPoint) {
  const auto line = RectangleAround(kLine);
  EXPECT_DOUBLE_EQ(line.length_m, 5.0);
  EXPECT_NEAR(line.width_m, 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(line.length_angle_rad, std::atan2(4.0, 3.0));
  EXPECT_NEAR((line.center_m - Eigen::Vector2d(1.5, 2.0)).norm(), 0.0, 1e-12);
  const auto back = RectangleAround(Polygon2d{{3.0, 4.0}, {0.0, 0.0}});
  EXPECT_DOUBLE_EQ(back.length_angle_rad, std::atan2(4.0, 3.0));
  const auto point = RectangleAround(kPoint);
  EXPECT_EQ(point.length_m, 0.0);
  EXPECT_EQ(point.width_m, 0.0);
  EXPECT_EQ(point.length_angle_rad, 0.0);
  EXPECT_EQ(point.center_m, kPoint[0]);
}

TEST(ConvexHull, IsThatOfSquaresLinesAndPoints) {
  Polygon2d places_m = kSquare;
  for (const auto& inside_m : {Eigen::Vector2d(1.0, 1.0), Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(2.0, 0.5)}) places_m.push_back(inside_m);
  places_m.push_back(kSquare.front());
  EXPECT_EQ(ConvexHull(places_m), kSquare);
  EXPECT_EQ(ConvexHull({kLine[1], kLine[0], kLine[1]}), kLine);
  EXPECT_EQ(ConvexHull({{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}, {0.5, 0.5}}), (Polygon2d{{0.0, 0.0}, {2.0, 2.0}}));
  EXPECT_EQ(ConvexHull({kPoint[0], kPoint[0], kPoint[0]}), kPoint);
}

TEST(ConvexHull, IsConvexHoldsAllAndHasNoCornerButOfThem) {
  constexpr double kRoundingM2 = 1e-12;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place_m(-10.0, 10.0);
  for (int i = 0; i < 500; ++i) {
    Polygon2d places_m(1 + random() % 40);
    // Often on a raster, where many lie on a line.
    const double raster_m = i % 2 == 0 ? 1.0 : 1e-6;
    for (auto& place : places_m) place = {raster_m * std::round(place_m(random) / raster_m), raster_m * std::round(place_m(random) / raster_m)};
    const auto hull_m = ConvexHull(places_m);
    for (std::size_t k = 0; hull_m.size() > 2 && k < hull_m.size(); ++k) {
      for (const auto& place : places_m) ASSERT_GE(Cross(hull_m[(k + 1) % hull_m.size()] - hull_m[k], place - hull_m[k]), -kRoundingM2) << i;
    }
    for (const auto& corner : hull_m) ASSERT_NE(std::ranges::find(places_m, corner), places_m.end()) << i;
    for (std::size_t k = 0; hull_m.size() > 2 && k < hull_m.size(); ++k) {
      const auto& next = hull_m[(k + 1) % hull_m.size()];
      ASSERT_GT(Cross(next - hull_m[k], hull_m[(k + 2) % hull_m.size()] - next), 0.0) << i;
    }
    std::ranges::shuffle(places_m, random);
    ASSERT_EQ(ConvexHull(places_m), hull_m) << i;
  }
}

TEST(ConvexHull, LeavesOutFlatCornersWhereItShall) {
  const Polygon2d places_m{{0.0, 0.0}, {1.0, -1e-5}, {2.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}};
  EXPECT_EQ(ConvexHull(places_m), places_m);
  EXPECT_EQ(ConvexHull(places_m, 1e-4), (Polygon2d{{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}}));
}

}  // namespace
}  // namespace lookout
