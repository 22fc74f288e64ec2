#include "tools/sim/solid.hpp"

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

}  // namespace
}  // namespace lookout::sim
