#include "lab/sim/solid.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace lookout::sim {
namespace {

const Ray kAhead{{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}};

TEST(Solid, PrismIsMetOnItsNearWall) {
  const auto hit = Intersect(Prism{Rectangle(5.0, 7.0, -1.0, 1.0), 0.0, 2.0}, kAhead);
  ASSERT_TRUE(hit);
  EXPECT_DOUBLE_EQ(hit->range_m, 5.0);
  EXPECT_DOUBLE_EQ(hit->incidence_cosine, 1.0);
}

TEST(Solid, PrismIsMetOnItsTopFromAbove) {
  const double slope = std::sqrt(0.5);
  const auto hit = Intersect(Prism{Rectangle(1.0, 9.0, -1.0, 1.0), -1.0, 0.0}, Ray{{0.0, 0.0, 3.0}, {slope, 0.0, -slope}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->range_m, 3.0 / slope, 1e-12);
  EXPECT_NEAR(hit->incidence_cosine, slope, 1e-12);
}

TEST(Solid, NothingIsMetBesideOverBehindOrFromInside) {
  const Prism ahead{Rectangle(5.0, 7.0, -1.0, 1.0), 0.0, 2.0};
  EXPECT_FALSE(Intersect(ahead, Ray{{0.0, 1.5, 1.0}, {1.0, 0.0, 0.0}}));
  EXPECT_FALSE(Intersect(ahead, Ray{{0.0, 0.0, 2.5}, {1.0, 0.0, 0.0}}));
  EXPECT_FALSE(Intersect(ahead, Ray{{8.0, 0.0, 1.0}, {1.0, 0.0, 0.0}}));
  EXPECT_FALSE(Intersect(ahead, Ray{{6.0, 0.0, 1.0}, {1.0, 0.0, 0.0}}));
  EXPECT_FALSE(Intersect(Cylinder{{0.0, 0.0}, 2.0, 0.0, 2.0}, kAhead));
  EXPECT_FALSE(Intersect(Ellipsoid{{0.0, 0.0, 1.0}, {2.0, 2.0, 2.0}}, kAhead));
  EXPECT_FALSE(Intersect(Ellipsoid{{-9.0, 0.0, 1.0}, {2.0, 2.0, 2.0}}, kAhead));
  EXPECT_FALSE(Intersect(Cone{{0.0, 0.0}, 2.0, 1.0, 0.0, 2.0}, kAhead));
  EXPECT_FALSE(Intersect(Rod{{-1.0, 0.1, 1.0}, {3.0, 0.1, 1.0}, 0.25}, kAhead));
  EXPECT_FALSE(Intersect(Rod{{0.1, 0.0, 1.0}, {3.0, 0.0, 1.0}, 0.25}, kAhead)) << "from inside of its round end";
}

TEST(Solid, CylinderGivesItsAngleOfIncidence) {
  const Cylinder cylinder{{10.0, 0.0}, 1.0, 0.0, 2.0};
  const auto middle = Intersect(cylinder, kAhead);
  ASSERT_TRUE(middle);
  EXPECT_DOUBLE_EQ(middle->range_m, 9.0);
  EXPECT_DOUBLE_EQ(middle->incidence_cosine, 1.0);
  const auto side = Intersect(cylinder, Ray{{0.0, 0.6, 1.0}, {1.0, 0.0, 0.0}});
  ASSERT_TRUE(side);
  EXPECT_NEAR(side->range_m, 9.2, 1e-12);
  EXPECT_NEAR(side->incidence_cosine, 0.8, 1e-12);
}

TEST(Solid, EllipsoidIsMetAtItsSemiAxis) {
  const auto hit = Intersect(Ellipsoid{{10.0, 0.0, 1.0}, {3.0, 1.0, 0.5}}, kAhead);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->range_m, 7.0, 1e-12);
  EXPECT_NEAR(hit->incidence_cosine, 1.0, 1e-12);
}

TEST(Solid, TriangleIsSeenFromBothSides) {
  const Triangle triangle{{5.0, -1.0, 0.0}, {5.0, 1.0, 0.0}, {5.0, 0.0, 3.0}};
  EXPECT_NEAR(Intersect(triangle, kAhead).value_or(Hit{}).range_m, 5.0, 1e-12);
  EXPECT_NEAR(Intersect(triangle, Ray{{9.0, 0.0, 1.0}, {-1.0, 0.0, 0.0}}).value_or(Hit{}).range_m, 4.0, 1e-12);
  EXPECT_FALSE(Intersect(triangle, Ray{{0.0, 0.9, 1.0}, {1.0, 0.0, 0.0}}));
}

TEST(Solid, LevelRaysMeetLevelFacesNever) {
  // Parallel to top and bottom: inside of the slab it goes on, outside it misses, and nothing divides by zero into a hit.
  EXPECT_TRUE(Intersect(Prism{Rectangle(5.0, 7.0, -1.0, 1.0), 1.0, 2.0}, kAhead));
  EXPECT_FALSE(Intersect(Prism{Rectangle(5.0, 7.0, -1.0, 1.0), 1.1, 2.0}, kAhead));
}

TEST(Solid, ConeIsMetOnItsWallItsTopAndNotBeyondItsTip) {
  const Cone cone{{10.0, 0.0}, 2.0, 0.0, 0.0, 2.0};
  const auto hit = Intersect(cone, kAhead);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->range_m, 9.0, 1e-12);
  EXPECT_NEAR(hit->incidence_cosine, std::sqrt(0.5), 1e-12);
  EXPECT_FALSE(Intersect(cone, Ray{{0.0, 0.0, 2.5}, {1.0, 0.0, 0.0}})) << "the cone beyond its tip";
  const auto top = Intersect(Cone{{10.0, 0.0}, 1.0, 2.0, 0.0, 1.0}, Ray{{10.5, 0.5, 5.0}, {0.0, 0.0, -1.0}});
  ASSERT_TRUE(top);
  EXPECT_NEAR(top->range_m, 4.0, 1e-12);
}

TEST(Solid, RodIsMetAcrossAndAtItsRoundEnds) {
  const Rod across{{5.0, -1.0, 1.0}, {5.0, 1.0, 1.0}, 0.25};
  EXPECT_NEAR(Intersect(across, kAhead).value_or(Hit{}).range_m, 4.75, 1e-12);
  EXPECT_NEAR(Intersect(across, Ray{{0.0, 1.2, 1.0}, {1.0, 0.0, 0.0}}).value_or(Hit{}).range_m, 5.0 - 0.15, 1e-12);
  EXPECT_FALSE(Intersect(across, Ray{{0.0, 1.3, 1.0}, {1.0, 0.0, 0.0}}));
  const Rod along{{5.0, 0.0, 1.0}, {8.0, 0.0, 1.0}, 0.25};
  EXPECT_NEAR(Intersect(along, kAhead).value_or(Hit{}).range_m, 4.75, 1e-12);
}

TEST(Solid, LeaningWallsAreNarrowerAwayFromWhereTheyAreWidest) {
  LeaningWalls hull;
  hull.footprint_m = Rectangle(5.0, 9.0, -2.0, 2.0);
  hull.lean = {0.5};
  hull.is_widest_on_top = true;
  hull.top_m = 2.0;
  EXPECT_NEAR(Intersect(ToConvex(hull), kAhead).value_or(Hit{}).range_m, 5.5, 1e-12) << "1 m under the top";
  hull.is_widest_on_top = false;
  EXPECT_NEAR(Intersect(ToConvex(hull), kAhead).value_or(Hit{}).range_m, 5.5, 1e-12) << "1 m over the bottom";
}

TEST(Solid, AnOpenHullIsSeenFromInsideWhereTheRayComesOverItsSide) {
  LeaningWalls hull;
  hull.footprint_m = Rectangle(5.0, 9.0, -2.0, 2.0);
  hull.lean = {0.0};
  hull.top_m = 1.0;
  hull.wall_m = 0.1;
  hull.hollow_bottom_m = 0.2;
  const Convex open = ToConvex(hull);
  EXPECT_NEAR(Intersect(open, Ray{{0.0, 0.0, 0.5}, {1.0, 0.0, 0.0}}).value_or(Hit{}).range_m, 5.0, 1e-12) << "the side that is near";
  const double slope = 0.1;
  const Ray down{{0.0, 0.0, 1.55}, Eigen::Vector3d(1.0, 0.0, -slope).normalized()};
  EXPECT_NEAR(Intersect(open, down).value_or(Hit{}).range_m / std::sqrt(1.0 + slope * slope), 8.9, 1e-9) << "the inner side that is far";
  const Ray steep{{4.5, 0.0, 3.0}, Eigen::Vector3d(1.0, 0.0, -1.0).normalized()};
  EXPECT_NEAR(Intersect(open, steep).value_or(Hit{}).range_m, 2.8 * std::sqrt(2.0), 1e-9) << "the floor";
}

}  // namespace
}  // namespace lookout::sim
