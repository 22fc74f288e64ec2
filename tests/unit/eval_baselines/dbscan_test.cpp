#include "lab/eval/baselines/dbscan.hpp"

#include <gtest/gtest.h>

namespace lookout::eval {
namespace {

using Clusters = std::vector<std::int32_t>;

// On a line, at these metres.
Clusters OnALine(const std::vector<float>& places_m, const DbscanParams& params) {
  std::vector<segmenter::Point> points_m;
  for (const float place_m : places_m) points_m.push_back({place_m, 0.0F, 0.0F});
  return Dbscan(points_m, params);
}

TEST(Dbscan, OfNothingIsEmpty) { EXPECT_TRUE(OnALine({}, {1.0, 1}).empty()); }

TEST(Dbscan, WithOnePointIsEuclideanClustering) {
  EXPECT_EQ(OnALine({0.0F, 5.0F, 0.9F, 1.8F, 5.9F}, {1.0, 1}), (Clusters{0, 1, 0, 0, 1}));
  EXPECT_EQ(OnALine({0.0F, 5.0F}, {1.0, 1}), (Clusters{0, 1})) << "single points are clusters";
}

TEST(Dbscan, LeavesLonelyPointsToTheNoise) { EXPECT_EQ(OnALine({0.0F, 0.5F, 1.0F, 9.0F}, {0.6, 2}), (Clusters{0, 0, 0, kNoise})); }

// With three points: 0.5 and 1.0 are core points, 0.0 and 1.5 on their border; 2.3 is near a border point alone.
TEST(Dbscan, GrowsOverCorePointsOnly) {
  EXPECT_EQ(OnALine({0.0F, 0.5F, 1.0F, 1.5F, 2.3F}, {0.85, 4}), (Clusters{kNoise, kNoise, kNoise, kNoise, kNoise}));
  EXPECT_EQ(OnALine({0.0F, 0.5F, 1.0F, 1.5F, 2.3F}, {0.85, 3}), (Clusters{0, 0, 0, 0, 0})) << "1.5 has three: itself, 1.0 and 2.3";
  EXPECT_EQ(OnALine({0.0F, 0.5F, 1.0F, 1.5F, 2.2F}, {0.6, 3}), (Clusters{0, 0, 0, 0, kNoise}));
}

// The point between both has one neighbour on each side: with four points it is no core point, and does not join them.
TEST(Dbscan, GivesABorderPointToTheFirstCluster) {
  const std::vector<float> places_m{0.0F, 0.1F, 0.2F, 0.3F, 1.2F, 2.1F, 2.2F, 2.3F, 2.4F};
  EXPECT_EQ(OnALine(places_m, {0.95, 4}), (Clusters{0, 0, 0, 0, 0, 1, 1, 1, 1}));
}

TEST(Dbscan, NumbersClustersInTheOrderOfTheirFirstPoint) { EXPECT_EQ(OnALine({9.0F, 0.0F, 9.1F, 0.1F}, {0.5, 2}), (Clusters{0, 1, 0, 1})); }

}  // namespace
}  // namespace lookout::eval
