#include "common/core/guard_sector.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace lookout {
namespace {

using Line = std::vector<Eigen::Vector2d>;

constexpr Sector kAhead{DegToRad(300.0), DegToRad(120.0)};

TEST(NearestWithin, TellsStarboardFromPort) {
  const auto starboard = NearestWithin(Sector{}, Line{{0.0, -4.0}}, true);
  ASSERT_TRUE(starboard);
  EXPECT_NEAR(starboard->range_m, 4.0, 1e-12);
  EXPECT_NEAR(RadToDeg(starboard->bearing_rad), 90.0, 1e-9);
  EXPECT_NEAR(RadToDeg(NearestWithin(Sector{}, Line{{0.0, 4.0}}, true)->bearing_rad), 270.0, 1e-9);
}

TEST(NearestWithin, LiesBetweenTheCornersOfAWall) {
  const auto nearest = NearestWithin(kAhead, Line{{5.0, -50.0}, {6.0, -50.0}, {6.0, 50.0}, {5.0, 50.0}}, true);
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(nearest->range_m, 5.0, 1e-12);
  EXPECT_NEAR(WrapToPi(nearest->bearing_rad), 0.0, 1e-9);
}

TEST(NearestWithin, OfAnOpenLineHasNoEdgeFromItsEndToItsBegin) {
  const Line bay{{-1.0, 20.0}, {30.0, 0.0}, {-1.0, -20.0}};
  EXPECT_GT(NearestWithin(Sector{}, bay, false)->range_m, 15.0);
  EXPECT_NEAR(NearestWithin(Sector{}, bay, true)->range_m, 1.0, 1e-12);
}

// A quay along the starboard side, from abeam to far ahead: what of it is ahead begins where the sector's side cuts it.
TEST(NearestWithin, IsCutAtTheSidesOfTheSector) {
  const auto nearest = NearestWithin(kAhead, Line{{0.0, -3.0}, {100.0, -3.0}}, false);
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(RadToDeg(nearest->bearing_rad), 60.0, 1e-9);
  EXPECT_NEAR(nearest->range_m, 3.0 / std::sin(DegToRad(60.0)), 1e-9);
  EXPECT_FALSE(NearestWithin(kAhead, Line{{-10.0, -3.0}, {0.0, -3.0}}, false));
}

bool IsInside(double from_deg, double width_deg, double range_m) {
  const Eigen::AlignedBox3d box_m{Eigen::Vector3d(-1.0, -2.0, -1.0), Eigen::Vector3d(14.0, 3.0, 2.0)};
  return IsInsideBox({.range_m = range_m, .bearing = {WrapTo2Pi(DegToRad(from_deg)), DegToRad(width_deg)}}, box_m);
}

TEST(GuardZoneInsideTheHull, IsFoundByTheSidesOfTheBoxThatTheSectorReaches) {
  EXPECT_TRUE(IsInside(355.0, 10.0, 14.0));
  EXPECT_FALSE(IsInside(355.0, 10.0, 14.01));
  EXPECT_TRUE(IsInside(300.0, 120.0, 2.3)) << "2.0 m to starboard at 60 degrees";
  EXPECT_FALSE(IsInside(300.0, 120.0, 2.4));
  EXPECT_TRUE(IsInside(0.0, 360.0, 1.0));
  EXPECT_FALSE(IsInside(0.0, 360.0, 1.1)) << "1.0 m aft";
  EXPECT_TRUE(IsInside(80.0, 20.0, 2.0));
  EXPECT_FALSE(IsInside(80.0, 20.0, 2.1)) << "2.0 m to starboard";
  EXPECT_TRUE(IsInside(260.0, 20.0, 3.0));
  EXPECT_FALSE(IsInside(260.0, 20.0, 3.1)) << "3.0 m to port";
}

TEST(GuardZoneInsideTheHull, IsNotFoundWhereTheReferencePointIsOutside) {
  const Eigen::AlignedBox3d box_m{Eigen::Vector3d(1.0, -2.0, -1.0), Eigen::Vector3d(14.0, 3.0, 2.0)};
  EXPECT_FALSE(IsInsideBox({.range_m = 5.0, .bearing = {0.0, 0.1}}, box_m));
}

}  // namespace
}  // namespace lookout
