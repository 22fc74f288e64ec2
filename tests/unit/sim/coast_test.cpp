// Land along a line: its edges, bends and outlines.
#include "lab/sim/coast.hpp"

#include <gtest/gtest.h>

#include "common/config/text_config.hpp"
#include "lab/sim/ground.hpp"
#include "lab/sim/traffic.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

config::Scene::Land LandOf(const std::string& text) {
  config::Scene::Land land;
  config::ParseText(text, "land", land);
  return land;
}

// Where a level ray from the water hits it, seen from (0, -20).
std::optional<double> RangeAt(const Coast& coast, double height_m) {
  std::optional<double> nearest_m;
  for (const auto& part : coast.object.parts) {
    const auto hit = Intersect(part.solid, {Vector3d(0.3, -20.0, height_m), Vector3d::UnitY()});
    if (hit && (!nearest_m || hit->range_m < *nearest_m)) nearest_m = hit->range_m;
  }
  return nearest_m;
}

TEST(Coast, AFaceStandsUprightToItsHeight) {
  Random random(1, 1);
  const Coast coast = MakeCoast("quay", LandOf("edge: FACE edge_height_m: 2 hill_slope: 0"), 80.0, random);
  for (const double height_m : {0.1, 1.0, 1.9}) EXPECT_NEAR(RangeAt(coast, height_m).value_or(0.0), 20.0, 1e-6) << height_m;
  EXPECT_FALSE(RangeAt(coast, 2.1));
  EXPECT_EQ(coast.object.kind, "quay");
  EXPECT_TRUE(Contains(coast.object.outline_m, {0.3, 5.0}));
  EXPECT_FALSE(Contains(coast.object.outline_m, {0.3, -0.5}));
}

TEST(Coast, SheetPilesStandInFoldsWithinTheOutline) {
  constexpr double kLevelM = 0.7;
  Random random(1, 1);
  const Coast coast = MakeCoast("quay", LandOf("edge: SHEET_PILES edge_height_m: 2 hill_slope: 0 stretch_m: 100"), 60.0, random);
  int num_folds = 0;
  int num_hollows = 0;
  for (double x_m = -25.0; x_m < 25.0; x_m += 0.05) {
    double nearest_m = 1e3;
    for (const auto& part : coast.object.parts) {
      if (std::holds_alternative<Cylinder>(part.solid)) continue;  // fenders and ladders
      const auto hit = Intersect(part.solid, {Vector3d(x_m, -20.0, kLevelM), Vector3d::UnitY()});
      if (hit) nearest_m = std::min(nearest_m, hit->range_m);
    }
    ASSERT_LE(nearest_m, 20.001) << x_m;
    EXPECT_TRUE(nearest_m > 19.999 || (nearest_m > 19.6 && nearest_m < 19.9)) << nearest_m;
    ++(nearest_m > 19.999 ? num_hollows : num_folds);
  }
  EXPECT_GT(num_folds, 250);
  EXPECT_GT(num_hollows, 250);
  for (const auto& part : coast.object.parts) {
    const auto* post = std::get_if<Cylinder>(&part.solid);
    if (post == nullptr) continue;
    EXPECT_GT(post->center_m.y() - post->radius_m, -kSheetPileReachM - 1e-6);
  }
}

TEST(Coast, ABeachRisesAsItsSlopeSays) {
  for (const double slope : {0.05, 0.3}) {
    Random random(2, 1);
    const Coast coast = MakeCoast("shore", LandOf("edge: BEACH edge_height_m: 1 slope: " + std::to_string(slope)), 80.0, random);
    for (const double height_m : {0.1, 0.3}) {
      const auto range_m = RangeAt(coast, height_m);
      ASSERT_TRUE(range_m);
      EXPECT_NEAR(*range_m - 20.0, height_m / slope, 0.25 * height_m / slope) << slope << ' ' << height_m;
    }
  }
}

TEST(Coast, ReedsStandInTheWaterAndInsideOfTheOutline) {
  Random random(3, 1);
  const Coast coast = MakeCoast("shore", LandOf("edge: REEDS stretch_m: 100"), 60.0, random);
  int num_in_water = 0;
  for (const auto& part : coast.object.parts) {
    const auto* stalk = std::get_if<Cylinder>(&part.solid);
    if (stalk == nullptr || stalk->center_m.y() > 0.0) continue;
    ++num_in_water;
    EXPECT_TRUE(part.material.is_porous);
    EXPECT_TRUE(Contains(coast.object.outline_m, stalk->center_m));
  }
  EXPECT_GT(num_in_water, 40);
}

TEST(Coast, ThreeBendsTowardsTheWaterAreABasin) {
  Random random(4, 1);
  const Coast coast = MakeCoast("quay", LandOf("edge: FACE bends: 3 bend_deg: 80"), 240.0, random);
  const Vector2d first_m = coast.object.outline_m.front();
  const Vector2d last_m = coast.object.outline_m[coast.num_front - 1];
  EXPECT_LT((first_m - last_m).norm(), 120.0) << "its ends come round to each other";
  for (std::size_t i = 0; i < coast.num_front; ++i) EXPECT_LT(coast.object.outline_m[i].y(), 1e-6) << "all of it on the side of the water";
}

TEST(Coast, LandIsOnThePortSideWhateverTheBays) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed, 1);
    const auto land = LandOf("edge: BANK bay_m: [0, 20] bay_length_m: [20, 100] bends: [0, 3] bend_deg: [-60, 60] bend_radius_m: [0, 30]");
    const Coast coast = MakeCoast("shore", land, 200.0, random);
    const auto& outline_m = coast.object.outline_m;
    const std::size_t middle = coast.num_front / 2;
    const Vector2d along = (outline_m[middle + 1] - outline_m[middle]).normalized();
    const Vector2d left(-along.y(), along.x());
    const Vector2d between_m = (outline_m[middle] + outline_m[middle + 1]) / 2.0;
    EXPECT_TRUE(Contains(outline_m, between_m + 0.3 * left)) << seed << ": land on the port side";
    EXPECT_FALSE(Contains(outline_m, between_m - 0.3 * left)) << seed << ": water to starboard";
  }
}

TEST(Island, HoldsItsMiddleAndIsAboutAsLargeAsAsked) {
  Random random(5, 1);
  const Coast island = MakeIslandOf("island", LandOf("edge: CLIFF edge_height_m: 3 bay_m: 2"), 40.0, 20.0, random);
  EXPECT_TRUE(Contains(island.object.outline_m, Vector2d::Zero()));
  double greatest_m = 0.0;
  for (const auto& p_m : island.object.outline_m) greatest_m = std::max(greatest_m, p_m.norm());
  EXPECT_NEAR(greatest_m, 20.0, 3.5);
  EXPECT_EQ(island.num_front, island.object.outline_m.size());
}

}  // namespace
}  // namespace lookout::sim
