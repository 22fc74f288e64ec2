#include "lab/sim/clouds.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "lab/sim/birds.hpp"
#include "lab/sim/breakers.hpp"
#include "tests/unit/sim/effects_fixture.hpp"

namespace lookout::sim {
namespace {

constexpr int kNumScans = 8;

TEST(Breakers, AreAsManyAsTheyShouldBe) {
  const Sea calm;
  double area_m2 = 0.0;
  Breakers few(20.0, calm, 3);
  Breakers many(60.0, calm, 3);
  double foam_of_few = 0.0;
  double foam_of_many = 0.0;
  for (int instant = 0; instant < 20; ++instant) {
    few.MoveTo(10.0 * instant, {0.0, 0.0});
    many.MoveTo(10.0 * instant, {0.0, 0.0});
    for (double x_m = -40.0; x_m < 40.0; x_m += 0.5) {
      for (double y_m = -40.0; y_m < 40.0; y_m += 0.5) {
        foam_of_few += few.FoamAt({x_m, y_m}) > 0.0 ? 0.25 : 0.0;
        foam_of_many += many.FoamAt({x_m, y_m}) > 0.0 ? 0.25 : 0.0;
        area_m2 += 0.25;
      }
    }
  }
  // 12 s (3 s of breaking, 9 s of fading) for 3 s, each some 2.6 m long and 2 to 10 m deep.
  EXPECT_GT(foam_of_few / area_m2, 0.02);
  EXPECT_LT(foam_of_few / area_m2, 0.2);
  EXPECT_NEAR(foam_of_many / foam_of_few, 3.0, 0.6);
}

TEST(Breakers, DoNotDependOnWhoLooks) {
  const Sea calm;
  Breakers here(60.0, calm, 3);
  Breakers there(60.0, calm, 3);
  here.MoveTo(12.0, {0.0, 0.0});
  there.MoveTo(1.0, {7.0, 80.0});
  there.MoveTo(12.0, {18.0, -11.0});
  for (double x_m = -20.0; x_m < 20.0; x_m += 0.5) {
    for (double y_m = -20.0; y_m < 20.0; y_m += 0.5) ASSERT_EQ(here.FoamAt({x_m, y_m}), there.FoamAt({x_m, y_m}));
  }
}

// A crest is to look like a thing: neighbouring columns at about one range, also where single drops are rare.
TEST(Breakers, GiveGroupsOfNeighbouringReturnsBeyondTenMetres) {
  Effects effects = QuietEffects();
  effects.set_breakers_per_hectare(60.0);
  const auto returns = Look(OpenWater(effects), kNumScans * kPacketsPerTurn);
  int num_far = 0;
  int num_with_neighbour = 0;
  const auto column_of = [](const TrueReturn& made) {
    return static_cast<int>(std::lround(RadToDeg(std::atan2(made.p_lidar_m.y(), made.p_lidar_m.x())) / 0.4));
  };
  for (std::size_t i = 0; i < returns.size(); ++i) {
    EXPECT_TRUE(returns[i].reason == ReturnReason::kCrest || returns[i].reason == ReturnReason::kOwnVessel);
    const double range_m = returns[i].p_lidar_m.norm();
    if (returns[i].reason != ReturnReason::kCrest || range_m < 10.0) continue;
    EXPECT_LT(range_m, 75.0);
    ++num_far;
    bool has_neighbour = false;
    for (std::size_t k = i + 1; k < std::min(i + 100, returns.size()); ++k) {
      has_neighbour = has_neighbour ||
                      (std::abs(column_of(returns[k]) - column_of(returns[i])) <= 2 && (returns[k].p_lidar_m - returns[i].p_lidar_m).norm() < 1.5);
    }
    num_with_neighbour += has_neighbour ? 1 : 0;
  }
  EXPECT_GT(num_far, 20 * kNumScans);
  EXPECT_GT(num_with_neighbour, 0.4 * num_far) << "the rest is foam that lies flat";
}

TEST(Birds, StayNearAndAreMet) {
  Effects effects = QuietEffects();
  effects.set_flying_birds(50);
  int num_met = 0;
  for (const auto& made : Look(OpenWater(effects), kNumScans * kPacketsPerTurn)) {
    if (made.reason == ReturnReason::kOwnVessel) continue;
    EXPECT_EQ(made.reason, ReturnReason::kBird);
    EXPECT_LT(made.p_lidar_m.head<2>().norm(), std::sqrt(2.0) * Birds::kReachM + 26.0);
    ++num_met;
  }
  EXPECT_GT(num_met, 5 * kNumScans);
}

TEST(Fog, HasItsMeanRangeAndFewReturnsBeyondTwiceIt) {
  Effects effects = QuietEffects();
  effects.set_fog_probability(0.2);
  effects.set_fog_range_m(8.0);
  double sum_m = 0.0;
  int count = 0;
  int num_far = 0;
  for (const auto& made : Look(OpenWater(effects), kNumScans * kPacketsPerTurn)) {
    // Upward: the beams below end in the water.
    if (made.reason != ReturnReason::kFog || made.p_lidar_m.z() < 0.0) continue;
    sum_m += made.p_lidar_m.norm();
    num_far += made.p_lidar_m.norm() > 16.0 ? 1 : 0;
    ++count;
  }
  ASSERT_GT(count, 100 * kNumScans);
  EXPECT_NEAR(sum_m / count, 8.0, 0.4);
  EXPECT_LT(num_far, 0.08 * count);
}

Scene WithBoatAt(double speed_mps) {
  Effects effects = QuietEffects();
  effects.set_churn_probability_per_m(2.0);
  Scene scene = StillScene(0.0, {{Prism{Rectangle(-3.0, 3.0, -1.0, 1.0), -0.2, 1.0}, {0.6}}});
  scene.effects = effects;
  auto& boat = scene.objects.front();
  boat.is_in_water = true;
  boat.outline_m = Rectangle(-3.0, 3.0, -1.0, 1.0);
  boat.waterline_m = {6.0, 2.0};
  boat.track = Track{{{10.0, 0.0}, 0.0}, speed_mps};
  return scene;
}

TEST(Churn, TouchesTheBoatThatMakesIt) {
  const Scene scene = WithBoatAt(4.0);
  int count = 0;
  for (const auto& made : Look(scene, 2 * kPacketsPerTurn)) {
    if (made.reason != ReturnReason::kWake && made.reason != ReturnReason::kSpray) continue;
    ++count;
    const double time_s = ToSeconds(made.time - kEffectsStart);
    const double from_middle_m = made.p_lidar_m.x() - 4.0 * time_s;  // the lidar looks north
    EXPECT_GT(from_middle_m, -3.0 - 5.0);
    EXPECT_LT(from_middle_m, 3.2);
  }
  EXPECT_GT(count, 20);
}

TEST(Churn, IsAbsentWhereABoatGoesQuietly) { EXPECT_EQ(CountReasons(WithBoatAt(1.0), 2 * kPacketsPerTurn).count(ReturnReason::kWake), 0U); }

TEST(Plumes, StayAboutTheOwnBoat) {
  Effects effects = QuietEffects();
  effects.set_plumes_per_minute(120.0);
  int count = 0;
  for (const auto& made : Look(OpenWater(effects), 2 * kNumScans * kPacketsPerTurn)) {
    if (made.reason == ReturnReason::kOwnVessel) continue;
    EXPECT_EQ(made.reason, ReturnReason::kSpray);
    EXPECT_LT(made.p_lidar_m.norm(), 9.0);
    ++count;
  }
  EXPECT_GT(count, 50);
}

TEST(OwnGear, StandsPartlyOutsideOfTheBox) {
  const auto box_m = SmallBoat().own_vessel_box_m;
  Effects effects;
  effects.set_own_crew(2);
  effects.set_own_gear(5);
  int num_outside = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SceneObject hull = MakeOwnHull(box_m, 1.5, {-0.8, 0.4, 0.9});
    const auto num_bare = hull.parts.size();
    AddCrewAndGear(effects, box_m, seed, hull);
    EXPECT_GE(hull.parts.size(), num_bare + 2 * 4 + 5);
    for (const auto& part : hull.parts) {
      const Bounds bounds = BoundsOf(part.solid);
      for (const auto& p_m : bounds.points_m) {
        const Eigen::Vector3d at_m(p_m.x(), p_m.y(), 0.5);
        num_outside += box_m.contains(at_m) ? 0 : 1;
        EXPECT_LT(box_m.exteriorDistance(at_m), 1.7);
      }
    }
  }
  EXPECT_GT(num_outside, 20);
}

}  // namespace
}  // namespace lookout::sim
