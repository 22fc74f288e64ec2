// How much time is left, how much this boat needs, and how near is too near.
#include "services/tracker/core/urgency.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "common/core/angles.hpp"
#include "services/tracker/core/limits.hpp"

namespace lookout::tracker {
namespace {

constexpr OwnAbility kBoat{.reaction_s = 5.0, .deceleration_mps2 = 0.5, .turn_rate_radps = DegToRad(10.0)};

TEST(TimeToAct, IsThatOfAStopOrOfATurnWhicheverIsSooner) {
  EXPECT_NEAR(TimeToAct(0.0, kBoat), 6.0, 1e-9);
  EXPECT_NEAR(TimeToAct(1.5, kBoat), 8.0, 1e-9);
  EXPECT_NEAR(TimeToAct(10.0, kBoat), 11.0, 1e-9) << "60 deg at 10 deg/s";
}

// Two points of which the one passes the other at 3 m, at 2 m/s.
ClosestApproach Passing(double tcpa_s) { return {.distance_m = std::hypot(3.0, 2.0 * tcpa_s), .cpa_m = 3.0, .tcpa_s = tcpa_s, .probability = 1.0}; }

TEST(TimeLeft, RunsToWhereTheLimitIsBroken) {
  // 5 m off, 4 m before the nearest point.
  EXPECT_NEAR(TimeLeft(Passing(10.0), 5.0), 8.0, 1e-9);
  EXPECT_NEAR(TimeLeft(Passing(2.5), 5.0), 0.5, 1e-9);
  EXPECT_EQ(TimeLeft(Passing(1.9), 5.0), 0.0) << "nearer already, and coming";
  EXPECT_TRUE(std::isnan(TimeLeft(Passing(10.0), 2.0))) << "it passes outside";
  EXPECT_TRUE(std::isnan(TimeLeft({.distance_m = 3.0, .cpa_m = 3.0}, 5.0))) << "it opens";
}

// Along a quay 2 m off, or beside piles.
TEST(TimeLeft, IsNoneWhereTheDistanceDoesNotShrink) {
  EXPECT_TRUE(std::isnan(TimeLeft({.distance_m = 2.0, .cpa_m = 1.9, .tcpa_s = 20.0}, 5.0)));
  EXPECT_EQ(TimeLeft({.distance_m = 2.0, .cpa_m = 1.0, .tcpa_s = 20.0}, 5.0), 0.0);
}

TEST(Limits, AreThoseOfTheConfigUntilSomebodySetsThem) {
  LimitParams params;
  params.guard_zone = {.range_m = 10.0, .bearing = {0.0, kTwoPi}};
  params.cpa_limit_m = 5.0;
  params.most_guard_zone_m = 50.0;
  const auto limits = LimitsOf(params, {}, 3.0, kBoat);
  EXPECT_EQ(limits.guard_zone.range_m, 10.0);
  EXPECT_EQ(limits.cpa_limit_m, 5.0);
  const auto set =
      LimitsOf(params, {.guard_zone_range_m = 80.0, .guard_zone_from_rad = DegToRad(300.0), .guard_zone_to_rad = DegToRad(60.0)}, 3.0, kBoat);
  EXPECT_EQ(set.guard_zone.range_m, 50.0) << "bounded";
  EXPECT_NEAR(set.guard_zone.bearing.width_rad, DegToRad(120.0), 1e-9);
  EXPECT_EQ(LimitsOf(params, {.guard_zone_range_m = 0.0}, 3.0, kBoat).guard_zone.range_m, 0.0) << "none";
}

// As single precision has it on the wire, 0 to 360 deg is a little more than a turn: the zone was a sector of nothing.
TEST(Limits, OfAWholeTurnAreAllRound) {
  LimitParams params;
  params.guard_zone = {.range_m = 10.0, .bearing = {DegToRad(300.0), DegToRad(120.0)}};
  for (const double to_deg : {360.0, 0.0}) {
    const auto to_rad = static_cast<double>(static_cast<float>(DegToRad(to_deg)));
    const auto limits = LimitsOf(params, {.guard_zone_from_rad = 0.0, .guard_zone_to_rad = to_rad}, 3.0, kBoat);
    EXPECT_EQ(limits.guard_zone.bearing.width_rad, kTwoPi) << to_deg;
    EXPECT_TRUE(limits.guard_zone.bearing.Contains(DegToRad(200.0))) << to_deg;
  }
}

// Within own_vessel all is own boat: such a zone could never ring.
TEST(Limits, ReachBeyondTheOwnBoat) {
  LimitParams params;
  params.guard_zone = {.range_m = 10.0, .bearing = {0.0, kTwoPi}};
  params.own_reach_m = 3.0;
  EXPECT_EQ(LimitsOf(params, {.guard_zone_range_m = 1.0}, 1.0, kBoat).guard_zone.range_m, 3.0);
  EXPECT_NEAR(LimitsOf(params, {.mode = Mode::kHarbour}, 0.0, kBoat).guard_zone.range_m, 5.0, 1e-9);
}

// When nobody knows how fast the boat goes is no time to look less far.
TEST(Limits, DoNotShrinkWhereTheSpeedIsNotKnown) {
  LimitParams params;
  params.guard_zone = {.range_m = 10.0, .bearing = {0.0, kTwoPi}};
  params.cpa_limit_m = 5.0;
  const auto limits = LimitsOf(params, {.mode = Mode::kHarbour}, kNan, kBoat);
  EXPECT_EQ(limits.guard_zone.range_m, 10.0);
  EXPECT_EQ(limits.cpa_limit_m, 5.0);
}

TEST(Limits, ShrinkWithTheOwnSpeedInHarbour) {
  LimitParams params;
  params.guard_zone = {.range_m = 10.0, .bearing = {0.0, kTwoPi}};
  params.cpa_limit_m = 5.0;
  const Settings harbour{.mode = Mode::kHarbour};
  EXPECT_NEAR(LimitsOf(params, harbour, 0.0, kBoat).guard_zone.range_m, 2.0, 1e-9);
  EXPECT_NEAR(LimitsOf(params, harbour, 0.0, kBoat).cpa_limit_m, 1.0, 1e-9);
  EXPECT_NEAR(LimitsOf(params, harbour, 0.6, kBoat).guard_zone.range_m, 0.6 * 6.2 + 2.0, 1e-9);
  EXPECT_NEAR(LimitsOf(params, harbour, 0.6, kBoat).cpa_limit_m, 0.3 * 6.2, 1e-9);
  EXPECT_EQ(LimitsOf(params, harbour, 3.0, kBoat).guard_zone.range_m, 10.0) << "never more than is set";
  EXPECT_EQ(LimitsOf(params, harbour, 3.0, kBoat).cpa_limit_m, 5.0);
}

}  // namespace
}  // namespace lookout::tracker
