#include "services/georeferencer/core/guard_zone.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

constexpr Sector kAhead{DegToRad(300.0), DegToRad(120.0)};

VesselOutline MakeOutline(const std::vector<Eigen::Vector2d>& footprint_m) {
  VesselOutline outline;
  for (const auto& corner_m : footprint_m) outline.footprint_m.emplace_back(corner_m.x(), corner_m.y(), 0.0);
  outline.nearest_m = outline.footprint_m.front();
  return outline;
}

// The footprint of a bay is closed behind the boat; its water's edge is not.
TEST(NearestWithin, OfLandTakesTheWaterlineAlone) {
  auto bay = MakeOutline({{30.0, 0.0}, {-1.0, 20.0}, {-1.0, -20.0}});
  bay.waterline_m = {{-1.0, 20.0, 0.0}, {30.0, 0.0, 0.0}, {-1.0, -20.0, 0.0}};
  const auto nearest = NearestWithin(Sector{}, bay);
  ASSERT_TRUE(nearest);
  EXPECT_GT(nearest->range_m, 15.0);
}

SegmentPart MakePart(double x_m, double y_m, Confidence confidence = Confidence::kSure) {
  auto part = test::MakePart(0, 0, {test::MakePoint(0, x_m, y_m, 0.0)});
  part.segments[0].rating.confidence = confidence;
  return part;
}

TEST(NearestInZone, LeavesOutWhatIsTooFarOrAside) {
  const GuardZoneParams zone{.range_m = 10.0, .bearing = kAhead};
  const auto level = Eigen::Isometry3d::Identity();
  EXPECT_FALSE(NearestInZone(zone, MakePart(11.0, 0.0), level));
  EXPECT_FALSE(NearestInZone(zone, MakePart(0.0, 2.0), level));
  ASSERT_TRUE(NearestInZone(zone, MakePart(9.0, 0.0), level));
  EXPECT_NEAR(NearestInZone(zone, MakePart(9.0, 0.0), level)->range_m, 9.0, 1e-12);
}

TEST(NearestInZone, TakesTheTentativeWhereItIsAskedTo) {
  const auto drop = MakePart(5.0, 0.0, Confidence::kTentative);
  EXPECT_FALSE(NearestInZone({.range_m = 10.0, .bearing = kAhead}, drop, Eigen::Isometry3d::Identity()));
  EXPECT_TRUE(NearestInZone({.range_m = 10.0, .bearing = kAhead, .takes_tentative = true}, drop, Eigen::Isometry3d::Identity()));
}

// The lidar sits 2 m forward and looks to port: what is 3 m ahead of it is to port of the boat.
TEST(NearestInZone, IsMeasuredFromTheReferencePointOfTheBoat) {
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  T_vessel_lidar.translation() << 2.0, 0.0, 1.0;
  T_vessel_lidar.linear() << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  const auto nearest = NearestInZone({.range_m = 10.0, .bearing = {}}, MakePart(3.0, 0.0), T_vessel_lidar);
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(nearest->range_m, std::hypot(2.0, 3.0), 1e-12);
}

}  // namespace
}  // namespace lookout::georeferencer
