#include "services/tracker/core/clutter.hpp"

#include <gtest/gtest.h>

namespace lookout::tracker {
namespace {

const Eigen::Vector2d kNear(6.0, 1.0);
const Eigen::Vector2d kAbeam(1.0, 6.0);

ClutterMap AfterRain(int num_drops) {
  ClutterMap clutter;
  for (int scan = 0; scan < 300; ++scan) {
    clutter.Begin();
    for (int i = 0; i < num_drops; ++i) clutter.Add(kNear, 1);
    clutter.End(0.1);
  }
  return clutter;
}

TEST(Clutter, IsAsDenseAsItWasSeen) {
  const double area_m2 = 3.14159 * 100.0 / 12.0;
  const auto clutter = AfterRain(52);
  EXPECT_NEAR(clutter.DensityAt(kNear, 1), 52.0 / area_m2, 0.02);
  EXPECT_LT(clutter.DensityAt(kAbeam, 1), 1e-5);
  EXPECT_NEAR(clutter.total(), 52.0, 0.5);
}

TEST(Clutter, OfDropsSaysNothingOfWhatShowsMore) {
  const auto clutter = AfterRain(52);
  for (const int num_returns : {4, 50, 100'000}) EXPECT_LT(clutter.DensityAt(kNear, num_returns), 1e-5) << num_returns;
  EXPECT_GT(clutter.DensityAt(kNear, 3), 1.0) << "what shows two or three may be drops";
}

TEST(Clutter, OfWhatShowsMuchCountsForDropsToo) {
  ClutterMap clutter;
  clutter.Begin();
  clutter.Add(kNear, 40);
  clutter.End(5.0);
  EXPECT_DOUBLE_EQ(clutter.DensityAt(kNear, 40), clutter.DensityAt(kNear, 1));
  EXPECT_DOUBLE_EQ(clutter.DensityAt(kNear, 20), clutter.DensityAt(kNear, 1));
}

}  // namespace
}  // namespace lookout::tracker
