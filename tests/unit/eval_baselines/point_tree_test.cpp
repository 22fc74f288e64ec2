#include "lab/eval/baselines/point_tree.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace lookout::eval {
namespace {

TEST(PointTree, OfNoPointsFindsNone) {
  const PointTree tree({});
  std::vector<std::int32_t> found{7};
  tree.FindWithin({0.0F, 0.0F, 0.0F}, 10.0, found);
  EXPECT_TRUE(found.empty());
  EXPECT_FALSE(tree.FindNearest({0.0F, 0.0F, 0.0F}));
}

TEST(PointTree, FindsWhatLiesWithinTheRadiusAndNothingAtItsEnd) {
  const PointTree tree({{1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}, {-0.5F, 0.0F, 0.0F}});
  std::vector<std::int32_t> found;
  tree.FindWithin({0.0F, 0.0F, 0.0F}, 2.0, found);
  std::ranges::sort(found);
  EXPECT_EQ(found, (std::vector<std::int32_t>{0, 2}));
  const auto nearest = tree.FindNearest({1.6F, 0.0F, 0.0F});
  ASSERT_TRUE(nearest);
  EXPECT_EQ(nearest->index, 1);
  EXPECT_NEAR(nearest->distance_m, 0.4, 1e-6);
}

TEST(PointTree, AgreesWithLookingAtEveryPoint) {
  std::mt19937_64 random(20261121);
  const auto place = [&random] { return static_cast<float>(random() % 20'000) / 1000.0F - 10.0F; };
  std::vector<segmenter::Point> points_m;
  for (int i = 0; i < 1000; ++i) points_m.push_back({place(), place(), place()});
  const PointTree tree(points_m);
  std::vector<std::int32_t> found;
  for (int query = 0; query < 50; ++query) {
    const segmenter::Point p_m{place(), place(), place()};
    tree.FindWithin(p_m, 3.0, found);
    std::ranges::sort(found);
    std::vector<std::int32_t> expected;
    double nearest_m2 = 1e9;
    for (std::int32_t i = 0; i < 1000; ++i) {
      const double squared_m2 = SquaredDistance(p_m, points_m[static_cast<std::size_t>(i)]);
      if (squared_m2 < 9.0) expected.push_back(i);
      nearest_m2 = std::min(nearest_m2, squared_m2);
    }
    EXPECT_EQ(found, expected);
    EXPECT_NEAR(tree.FindNearest(p_m)->distance_m, std::sqrt(nearest_m2), 1e-5);
  }
}

}  // namespace
}  // namespace lookout::eval
