#include "lab/sim/sea.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;

Sea DrawSea(double significant_height_m, double wavelength_m, double from_deg, double spread_deg, std::uint64_t seed) {
  config::Scene::SeaState state;
  state.set_significant_height_m(significant_height_m);
  state.set_wavelength_m(wavelength_m);
  state.set_from_deg(from_deg);
  state.set_spread_deg(spread_deg);
  Random random(seed, 1);
  return Sea::Draw(state, random);
}

TEST(Sea, IsCalmWithoutWaves) {
  const Sea sea;
  EXPECT_TRUE(sea.is_calm());
  EXPECT_EQ(sea.HeightM({3.0, 4.0}, 5.0), 0.0);
  EXPECT_TRUE(sea.Slope({3.0, 4.0}, 5.0).isZero());
  Random random(1, 1);
  EXPECT_TRUE(Sea::Draw({}, random).is_calm());
}

TEST(Sea, SlopeIsTheDerivativeOfTheHeight) {
  const Sea sea = DrawSea(0.8, 10.0, 57.0, 34.0, 7);
  constexpr double kStepM = 1e-5;
  for (double t = 0.0; t < 20.0; t += 1.3) {
    const Vector2d p_m(3.0 * t - 20.0, 11.0 - 2.0 * t);
    const Vector2d slope = sea.Slope(p_m, t);
    EXPECT_NEAR(slope.x(), (sea.HeightM(p_m + Vector2d(kStepM, 0.0), t) - sea.HeightM(p_m - Vector2d(kStepM, 0.0), t)) / (2.0 * kStepM), 1e-8);
    EXPECT_NEAR(slope.y(), (sea.HeightM(p_m + Vector2d(0.0, kStepM), t) - sea.HeightM(p_m - Vector2d(0.0, kStepM), t)) / (2.0 * kStepM), 1e-8);
  }
}

TEST(Sea, AWaveRunsWhereItIsSentAtTheSpeedOfDeepWater) {
  // 10 m long: sqrt(g L / 2 pi) = 3.951 m/s, to the east.
  const Sea sea({{0.5, 10.0, kPi / 2.0, 0.4}});
  const double speed_mps = std::sqrt(9.80665 * 10.0 / kTwoPi);
  for (double t = 0.0; t < 5.0; t += 0.7) {
    EXPECT_NEAR(sea.HeightM({2.0 + speed_mps * t, 3.0}, t), sea.HeightM({2.0, 3.0}, 0.0), 1e-9);
    EXPECT_NEAR(sea.HeightM({2.0, 3.0}, t), sea.HeightM({2.0, -30.0}, t), 1e-9) << "its crests are long";
  }
}

TEST(Sea, SignificantHeightIsFourStandardDeviations) {
  const Sea sea = DrawSea(0.6, 12.0, 229.0, 34.0, 3);
  double sum_squares_m2 = 0.0;
  int count = 0;
  for (double east_m = 0.0; east_m < 600.0; east_m += 3.7) {
    for (double north_m = 0.0; north_m < 600.0; north_m += 3.1) {
      const double height_m = sea.HeightM({east_m, north_m}, 0.5 * count);
      sum_squares_m2 += height_m * height_m;
      ++count;
    }
  }
  EXPECT_NEAR(4.0 * std::sqrt(sum_squares_m2 / count), 0.6, 0.02);
}

TEST(Sea, ComesFromWhereTheFileSays) {
  // From the north without spread: nothing changes to the east, and crests go south.
  const Sea sea = DrawSea(0.6, 12.0, 0.0, 0.0, 3);
  EXPECT_NEAR(sea.Slope({5.0, 6.0}, 7.0).x(), 0.0, 1e-9);
  const Sea one({{0.5, 10.0, kPi, 0.0}});
  EXPECT_NEAR(one.HeightM({0.0, -1.0}, 1.0 / std::sqrt(9.80665 * 10.0 / kTwoPi)), one.HeightM({0.0, 0.0}, 0.0), 1e-9);
}

}  // namespace
}  // namespace lookout::sim
