#include "lab/sim/traffic.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

Outline Square(double east_m, double north_m, double half_m) {
  return Rectangle(east_m - half_m, east_m + half_m, north_m - half_m, north_m + half_m);
}

SceneObject Box(const std::string& name, const Track& track) { return {1, name, "buoy", track, {}, Square(0.0, 0.0, 1.0)}; }

TEST(Traffic, FindsWhatMeetsAfterAWhile) {
  OwnMotion still;
  Traffic traffic(60.0);
  traffic.SetOwnBoat(still);
  EXPECT_FALSE(traffic.ToOwnBoat(Box("far", Track{{{0.0, 50.0}}}), 1.5));
  EXPECT_TRUE(traffic.ToOwnBoat(Box("comes", Track{{{0.0, 50.0}, kPi}, 1.0}), 1.5)) << "there after 50 s";
  EXPECT_FALSE(traffic.ToOwnBoat(Box("comes too late", Track{{{0.0, 90.0}, kPi}, 1.0}), 1.5));
  EXPECT_FALSE(traffic.ToOwnBoat(Box("passes", Track{{{-50.0, 8.0}, kPi / 2.0}, 5.0}), 1.5));
  const auto near = traffic.ToOwnBoat(Box("beside", Track{{{3.0, 0.0}}}), 1.5);
  ASSERT_TRUE(near);
  EXPECT_NEAR(near->distance_m, 3.0 - 1.0 - 0.7, 1e-9) << "the hull is 1.4 m wide";
}

TEST(Traffic, AFastBoatDoesNotSlipThroughBetweenTwoSamples) {
  OwnMotion still;
  Traffic traffic(60.0);
  traffic.SetOwnBoat(still);
  // 20 m/s: 4 m in a sample, 2 m long, passing 1 m off for a moment; the limit is wider than its way in a sample.
  EXPECT_TRUE(traffic.ToOwnBoat(Box("fast", Track{{{-300.0, 2.7}, kPi / 2.0}, 20.0}), 1.5));
}

TEST(Traffic, NamesTheFirstThatIsTooNearAmongTheFirstFew) {
  OwnMotion still;
  Traffic traffic(60.0);
  traffic.SetOwnBoat(still);
  traffic.Add(Box("a", Track{{{20.0, 0.0}}}));
  traffic.Add(Box("b", Track{{{30.0, 0.0}}}));
  const auto object = Box("c", Track{{{34.0, 0.0}}});
  const auto near = traffic.ToOthers(object, 3.0, 2);
  ASSERT_TRUE(near);
  EXPECT_EQ(near->name, "b");
  EXPECT_NEAR(near->distance_m, 2.0, 1e-9);
  EXPECT_FALSE(traffic.ToOthers(object, 3.0, 1));
  EXPECT_FALSE(traffic.ToOthers(object, 2.0, 2)) << "not nearer than the limit";
}

}  // namespace
}  // namespace lookout::sim
