#include "services/georeferencer/core/guard_zone.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "common/bus/memory_bus.hpp"
#include "services/georeferencer/service.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

constexpr Sector kAhead{DegToRad(300.0), DegToRad(120.0)};

Obstacle MakeOutline(std::vector<Eigen::Vector2d> footprint_m) {
  Obstacle obstacle;
  obstacle.nearest_vessel_m << footprint_m.front(), 0.0;
  obstacle.footprint_vessel_m = std::move(footprint_m);
  return obstacle;
}

ObstaclePart MakeTurn(std::int64_t offset_us, std::vector<Obstacle> obstacles) {
  ObstaclePart part;
  part.head.time = test::At(offset_us);
  part.obstacles = std::move(obstacles);
  return part;
}

TEST(NearestWithin, TellsStarboardFromPort) {
  const auto starboard = NearestWithin(Sector{}, MakeOutline({{0.0, -4.0}}));
  ASSERT_TRUE(starboard);
  EXPECT_NEAR(starboard->range_m, 4.0, 1e-12);
  EXPECT_NEAR(RadToDeg(starboard->bearing_rad), 90.0, 1e-9);
  EXPECT_NEAR(RadToDeg(NearestWithin(Sector{}, MakeOutline({{0.0, 4.0}}))->bearing_rad), 270.0, 1e-9);
}

TEST(NearestWithin, LiesBetweenTheCornersOfAWall) {
  const auto nearest = NearestWithin(kAhead, MakeOutline({{5.0, -50.0}, {6.0, -50.0}, {6.0, 50.0}, {5.0, 50.0}}));
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(nearest->range_m, 5.0, 1e-12);
  EXPECT_NEAR(WrapToPi(nearest->bearing_rad), 0.0, 1e-9);
}

// A quay along the starboard side, from abeam to far ahead: what of it is ahead begins where the sector's side cuts it.
TEST(NearestWithin, IsCutAtTheSidesOfTheSector) {
  auto quay = MakeOutline({{0.0, -3.0}, {100.0, -3.0}});
  const auto nearest = NearestWithin(kAhead, quay);
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(RadToDeg(nearest->bearing_rad), 60.0, 1e-9);
  EXPECT_NEAR(nearest->range_m, 3.0 / std::sin(DegToRad(60.0)), 1e-9);
  EXPECT_FALSE(NearestWithin(kAhead, MakeOutline({{-10.0, -3.0}, {0.0, -3.0}})));
}

// The footprint of a bay is closed behind the boat; its water's edge is not.
TEST(NearestWithin, OfLandTakesTheWaterlineAlone) {
  auto bay = MakeOutline({{30.0, 0.0}, {-1.0, 20.0}, {-1.0, -20.0}});
  bay.waterline_vessel_m = {{-1.0, 20.0}, {30.0, 0.0}, {-1.0, -20.0}};
  const auto nearest = NearestWithin(Sector{}, bay);
  ASSERT_TRUE(nearest);
  EXPECT_GT(nearest->range_m, 15.0);
}

TEST(GuardZone, CountsAnAlarmWhenItComesUp) {
  GuardZone zone({.range_m = 10.0, .bearing = kAhead});
  zone.Add(MakeTurn(0, {MakeOutline({{11.0, 0.0}})}));
  EXPECT_FALSE(zone.nearest());
  zone.Add(MakeTurn(100'000, {MakeOutline({{9.0, 0.0}}), MakeOutline({{0.0, 2.0}})}));
  ASSERT_TRUE(zone.nearest());
  EXPECT_NEAR(zone.nearest()->range_m, 9.0, 1e-12);
  zone.Add(MakeTurn(200'000, {MakeOutline({{8.0, 0.0}})}));
  EXPECT_EQ(zone.num_alarms(), 1);
  zone.Add(MakeTurn(300'000, {}));
  EXPECT_TRUE(zone.nearest()) << "parts of this turn may be on their way";
  zone.Add(MakeTurn(400'000, {}));
  EXPECT_FALSE(zone.nearest());
  zone.Add(MakeTurn(500'000, {MakeOutline({{8.0, 0.0}})}));
  EXPECT_EQ(zone.num_alarms(), 2);
}

TEST(GuardZone, TakesTheTentativeWhereItIsAskedTo) {
  auto drop = MakeOutline({{5.0, 0.0}});
  drop.judgement.confidence = Confidence::kTentative;
  GuardZone sure({.range_m = 10.0, .bearing = kAhead});
  sure.Add(MakeTurn(0, {drop}));
  EXPECT_FALSE(sure.nearest());
  GuardZone all({.range_m = 10.0, .bearing = kAhead, .takes_tentative = true});
  all.Add(MakeTurn(0, {drop}));
  EXPECT_TRUE(all.nearest());
  GuardZone off({});
  off.Add(MakeTurn(0, {MakeOutline({{0.5, 0.0}})}));
  EXPECT_FALSE(off.nearest());
}

TEST(GuardZone, IsToldOfInHealth) {
  bus::MemoryBus bus;
  Params params;
  params.pose_timeout = std::chrono::milliseconds(500);
  params.guard_zone.range_m = 20.0;
  Service service(bus, params);
  EXPECT_EQ(service.Report().state, HealthState::kOk);
  bus::Publish(bus, bus::kSegments, test::MakeSegmentsMessage(0, 0, {test::MakeSegmentMessage(1, 0)}));  // 10 m ahead
  for (std::int64_t offset_us = 0; offset_us <= 120'000; offset_us += 20'000) {
    bus::Publish(bus, bus::kPose, test::MakePoseMessage(offset_us, offset_us / 20'000));
  }
  while (bus.HandleOnce()) {
  }
  const auto report = service.Report();
  EXPECT_EQ(report.state, HealthState::kDegraded);
  EXPECT_EQ(report.reason, "obstacle within 20.0 m: 10.0 m, 0 deg to starboard");
  const auto alarm = std::ranges::find(report.counters, "alarm_active", &Counter::name);
  ASSERT_NE(alarm, report.counters.end());
  EXPECT_EQ(alarm->count, 1);
}

}  // namespace
}  // namespace lookout::georeferencer
