#include "lab/sim/clutter.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <optional>

#include "common/core/angles.hpp"
#include "tests/unit/sim/effects_fixture.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector3d;

TEST(RangeToSea, IsWhereAFineSearchFindsTheSurface) {
  const Sea sea = ChoppySea();
  int num_met = 0;
  for (int i = 0; i < 200; ++i) {
    const double down_rad = DegToRad(1.0 + 0.1 * i);
    const Ray ray{{0.0, 0.0, 2.0}, {std::cos(down_rad) * std::sin(0.1 * i), std::cos(down_rad) * std::cos(0.1 * i), -std::sin(down_rad)}};
    std::optional<double> expected_m;
    for (double range_m = 1.0; range_m < 100.0 && !expected_m; range_m += 0.002) {
      const Vector3d p_m = ray.origin_m + range_m * ray.direction;
      if (p_m.z() <= sea.HeightM(p_m.head<2>(), 1.5)) expected_m = range_m;
    }
    const auto range_m = RangeToSea(sea, ray, 1.5, 1.0, 100.0);
    ASSERT_EQ(range_m.has_value(), expected_m.has_value()) << i;
    if (!range_m) continue;
    // A crest that is only grazed may be stepped over; then the next one is found.
    EXPECT_GT(*range_m, *expected_m - 0.02);
    if (std::abs(*range_m - *expected_m) < 0.02) ++num_met;
  }
  EXPECT_GT(num_met, 180);
}

TEST(FresnelReflectance, HasTheValuesOfTextbooks) {
  EXPECT_NEAR(FresnelReflectance(1.0), 0.0198, 0.0005);  // ((n - 1) / (n + 1))^2
  EXPECT_NEAR(FresnelReflectance(0.0), 1.0, 1e-12);
  EXPECT_NEAR(FresnelReflectance(std::sin(DegToRad(30.0))), 0.059, 0.003);
}

}  // namespace
}  // namespace lookout::sim
