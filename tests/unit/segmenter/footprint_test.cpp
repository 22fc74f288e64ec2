#include "services/segmenter/core/footprint.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"

namespace lookout::segmenter {
namespace {

std::vector<FootprintPoint> Points(const std::vector<std::pair<float, float>>& places) {
  std::vector<FootprintPoint> points;
  for (const auto& [x_m, y_m] : places) points.push_back({x_m, y_m, static_cast<std::int32_t>(points.size())});
  return points;
}

std::vector<std::int32_t> Indices(const std::vector<FootprintPoint>& points) {
  std::vector<std::int32_t> indices;
  for (const auto& point : points) indices.push_back(point.return_index);
  return indices;
}

std::vector<FootprintPoint> Circle(int num_points, float radius_m) {
  std::vector<FootprintPoint> points;
  for (int i = 0; i < num_points; ++i) {
    const double angle_rad = kTwoPi * i / num_points;
    points.push_back({radius_m * static_cast<float>(std::cos(angle_rad)), radius_m * static_cast<float>(std::sin(angle_rad)), i});
  }
  return points;
}

TEST(ConvexHull, GoesCounterClockwiseFromLeastX) {
  EXPECT_EQ(Indices(ConvexHull(Points({{1, 1}, {0, 0}, {1, 0}, {0, 1}, {0.5F, 0.5F}}))), (std::vector<std::int32_t>{1, 2, 0, 3}));
}

TEST(ConvexHull, LeavesOutPointsOnEdges) {
  EXPECT_EQ(Indices(ConvexHull(Points({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}))), (std::vector<std::int32_t>{0, 2, 3, 5}));
}

TEST(ConvexHull, OfOnePlaceIsOneCornerWithTheFirstReturn) {
  EXPECT_EQ(Indices(ConvexHull(Points({{1, 2}, {1, 2}, {1, 2}}))), std::vector<std::int32_t>{0});
}

TEST(ConvexHull, OfALineIsItsEnds) {
  EXPECT_EQ(Indices(ConvexHull(Points({{1, 1}, {3, 3}, {2, 2}, {0, 0}}))), (std::vector<std::int32_t>{3, 1}));
  EXPECT_EQ(Indices(ConvexHull(Points({{1, 1}, {1, 3}, {1, 2}}))), (std::vector<std::int32_t>{0, 1}));
}

TEST(ConvexHull, OfManyPointsOnALineAlongYIsItsEnds) {
  std::vector<FootprintPoint> points;
  for (int i = 0; i < 1000; ++i) points.push_back({5.0F, static_cast<float>((i * 7) % 1000), i});
  const auto hull = ConvexHull(points);
  ASSERT_EQ(hull.size(), 2U);
  EXPECT_EQ(hull[0].y_m, 0.0F);
  EXPECT_EQ(hull[1].y_m, 999.0F);
}

TEST(SimplifyHull, LeavesSmallHullsAlone) { EXPECT_EQ(SimplifyHull(ConvexHull(Circle(256, 10.0F))).size(), 256U); }

TEST(SimplifyHull, KeepsExtremesAndAlmostAllOfALargeHull) {
  const auto hull = ConvexHull(Circle(1808, 10.0F));
  ASSERT_GT(hull.size(), 1700U);
  const auto simple = SimplifyHull(hull);
  EXPECT_LE(simple.size(), kMaxHullCorners);
  EXPECT_GT(simple.size(), 250U);
  EXPECT_EQ(Indices(ConvexHull(simple)), Indices(simple));  // convex, counter-clockwise
  const auto by_x = [](const FootprintPoint& a, const FootprintPoint& b) { return a.x_m < b.x_m; };
  const auto by_y = [](const FootprintPoint& a, const FootprintPoint& b) { return a.y_m < b.y_m; };
  EXPECT_EQ(std::max_element(simple.begin(), simple.end(), by_x)->x_m, std::max_element(hull.begin(), hull.end(), by_x)->x_m);
  EXPECT_EQ(std::min_element(simple.begin(), simple.end(), by_x)->x_m, std::min_element(hull.begin(), hull.end(), by_x)->x_m);
  EXPECT_EQ(std::max_element(simple.begin(), simple.end(), by_y)->y_m, std::max_element(hull.begin(), hull.end(), by_y)->y_m);
  EXPECT_EQ(std::min_element(simple.begin(), simple.end(), by_y)->y_m, std::min_element(hull.begin(), hull.end(), by_y)->y_m);
  // No corner is farther outside than 0.62 % of the edge.
  for (const auto& corner : hull) {
    for (std::size_t i = 0; i < simple.size(); ++i) {
      const auto& a = simple[i];
      const auto& b = simple[(i + 1) % simple.size()];
      const double edge_m = std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
      const double outside_m = -((b.x_m - a.x_m) * (corner.y_m - a.y_m) - (b.y_m - a.y_m) * (corner.x_m - a.x_m)) / edge_m;
      EXPECT_LE(outside_m, 0.0062 * edge_m + 1e-5);
    }
  }
}

TEST(LeastAreaRectangle, OfAPointHasNoSize) {
  const auto rectangle = LeastAreaRectangle(Points({{3, 4}}));
  EXPECT_EQ(rectangle.length_m, 0.0F);
  EXPECT_EQ(rectangle.width_m, 0.0F);
  EXPECT_EQ(rectangle.length_azimuth_rad, 0.0F);
}

TEST(LeastAreaRectangle, OfALineHasItsLengthAndClockwiseDirection) {
  const auto rectangle = LeastAreaRectangle(ConvexHull(Points({{0, 0}, {3, -4}})));
  EXPECT_FLOAT_EQ(rectangle.length_m, 5.0F);
  EXPECT_EQ(rectangle.width_m, 0.0F);
  EXPECT_NEAR(rectangle.length_azimuth_rad, std::atan2(4.0, 3.0), 1e-6);
}

TEST(LeastAreaRectangle, FindsATurnedRectangle) {
  for (int degrees = 0; degrees < 360; degrees += 7) {
    const double angle_rad = DegToRad(degrees);
    std::vector<std::pair<float, float>> places;
    for (const auto& [along_m, across_m] : {std::pair{3.0, 1.0}, {-3.0, 1.0}, {-3.0, -1.0}, {3.0, -1.0}, {1.0, 0.3}}) {
      places.emplace_back(static_cast<float>(20.0 + along_m * std::cos(angle_rad) - across_m * std::sin(angle_rad)),
                          static_cast<float>(5.0 + along_m * std::sin(angle_rad) + across_m * std::cos(angle_rad)));
    }
    const auto rectangle = LeastAreaRectangle(ConvexHull(Points(places)));
    EXPECT_NEAR(rectangle.length_m, 6.0, 1e-4) << degrees;
    EXPECT_NEAR(rectangle.width_m, 2.0, 1e-4) << degrees;
    EXPECT_GE(rectangle.length_azimuth_rad, 0.0F);
    EXPECT_LT(rectangle.length_azimuth_rad, static_cast<float>(kPi));
    EXPECT_NEAR(std::sin(rectangle.length_azimuth_rad + angle_rad), 0.0, 1e-4) << degrees;
  }
}

}  // namespace
}  // namespace lookout::segmenter
