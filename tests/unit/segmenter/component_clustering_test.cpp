#include "services/segmenter/core/paper/component_clustering.hpp"

#include <gtest/gtest.h>
#include <random>

namespace lookout::segmenter {
namespace {

ComponentCentroid ComponentAt(double range_m, double azimuth_deg, double z_m = 0.0) {
  return ComponentCentroid({range_m * std::cos(DegToRad(azimuth_deg)), -range_m * std::sin(DegToRad(azimuth_deg)), z_m});
}

bool AreCompatible(const ComponentCentroid& one, const ComponentCentroid& other, const ClusteringParams& params = {}) {
  return CompatibilityRule(params).AreCompatible(one, other);
}

TEST(CompatibilityRule, IsThePapersFormula) {
  constexpr std::uint64_t kSeed = 5;
  std::mt19937_64 random(kSeed);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  int num_compatible = 0;
  for (int i = 0; i < 100'000; ++i) {
    const ClusteringParams params{.e1_cosine = uniform(0.5, 1.0),
                                  .e2_angle_rad = DegToRad(uniform(1.0, 89.0)),
                                  .e3_distance_m = uniform(0.0, 10.0),
                                  .e2_max_distance_m = i % 2 == 0 ? 0.0 : uniform(0.1, 20.0)};
    const auto one = ComponentAt(uniform(1.0, 40.0), uniform(0.0, 60.0), uniform(-3.0, 3.0));
    const auto other = ComponentAt(uniform(1.0, 40.0), uniform(0.0, 60.0), uniform(-3.0, 3.0));
    const double cosine = one.p_m.dot(other.p_m) / (one.p_m.norm() * other.p_m.norm());
    const double between_rad = std::acos(std::min(1.0, cosine));
    const double short_m = std::min(one.p_m.norm(), other.p_m.norm());
    const double long_m = std::max(one.p_m.norm(), other.p_m.norm());
    const double distance_m = (one.p_m - other.p_m).norm();
    const bool is_b = std::atan2(short_m * std::sin(between_rad), long_m - short_m * std::cos(between_rad)) >= params.e2_angle_rad &&
                      (params.e2_max_distance_m == 0.0 || distance_m <= params.e2_max_distance_m);
    const bool expected = cosine >= params.e1_cosine && (is_b || distance_m <= params.e3_distance_m);
    ASSERT_EQ(AreCompatible(one, other, params), expected) << "seed " << kSeed << ", case " << i;
    ASSERT_EQ(AreCompatible(other, one, params), expected) << "seed " << kSeed << ", case " << i;
    num_compatible += expected ? 1 : 0;
  }
  EXPECT_GT(num_compatible, 1'000);
}

TEST(CompatibilityRule, DoesNotJoinAheadWithAstern) {
  EXPECT_FALSE(AreCompatible(ComponentAt(10.0, 0.0), ComponentAt(10.0, 180.0)));
  EXPECT_FALSE(AreCompatible(ComponentAt(1.0, 0.0), ComponentAt(1.0, 180.0)));
}

TEST(CompatibilityRule, JoinsSideBySideAtAnyDistanceUnlessItIsLimited) {
  // Two boats 10 m apart at 40 m.
  EXPECT_TRUE(AreCompatible(ComponentAt(40.0, 0.0), ComponentAt(40.0, 14.4)));
  EXPECT_FALSE(AreCompatible(ComponentAt(40.0, 0.0), ComponentAt(40.0, 14.4), {.e2_max_distance_m = 8.0}));
}

TEST(CompatibilityRule, HoldsNoDirectionInCommonWithTheSensorItself) {
  EXPECT_FALSE(AreCompatible(ComponentCentroid(Eigen::Vector3d::Zero()), ComponentAt(1.0, 0.0)));
  EXPECT_FALSE(AreCompatible(ComponentCentroid(Eigen::Vector3d::Zero()), ComponentCentroid(Eigen::Vector3d::Zero())));
}

TEST(ClusterComponents, OfNothingAreNone) { EXPECT_TRUE(ClusterComponents({}, {}).empty()); }

TEST(ClusterComponents, OfOneIsOne) {
  EXPECT_EQ(ClusterComponents(std::vector{ComponentAt(10.0, 0.0)}, {}), std::vector<std::int32_t>{0});
  EXPECT_EQ(ClusterComponents(std::vector{ComponentCentroid(Eigen::Vector3d::Zero())}, {}), std::vector<std::int32_t>{0});
}

TEST(ClusterComponents, AreNumberedInTheOrderOfTheirFirstComponent) {
  const std::vector components{ComponentAt(30.0, 0.0), ComponentAt(10.0, 90.0), ComponentAt(30.0, 2.0), ComponentAt(10.0, 200.0),
                               ComponentAt(10.0, 92.0)};
  EXPECT_EQ(ClusterComponents(components, {}), (std::vector<std::int32_t>{0, 1, 0, 2, 1}));
}

TEST(ClusterComponents, ChainAcrossAzimuthZero) {
  const std::vector components{ComponentAt(30.0, 354.0), ComponentAt(30.0, 6.0)};
  EXPECT_EQ(ClusterComponents(components, {}), (std::vector<std::int32_t>{0, 0}));
}

TEST(ClusterComponents, AreConnectedThroughOthers) {
  // A shore: its ends are 90 degrees apart and compatible with their neighbours only.
  std::vector<ComponentCentroid> components;
  for (int i = 0; i < 10; ++i) components.push_back(ComponentAt(20.0, 10.0 * i));
  EXPECT_EQ(ClusterComponents(components, {}), std::vector<std::int32_t>(10, 0));
}

TEST(Centroids, AreMeansAndLeaveOutReturnsInNoComponent) {
  const std::vector<Return> returns{{.point = {1.0F, 2.0F, 3.0F}}, {.point = {100.0F, 0.0F, 0.0F}}, {.point = {3.0F, 4.0F, 7.0F}}};
  const auto centroids = Centroids(returns, {{0, Groups::kNone, 0}, 1});
  ASSERT_EQ(centroids.size(), 1U);
  EXPECT_EQ(centroids[0].p_m, Eigen::Vector3d(2.0, 3.0, 5.0));
}

}  // namespace
}  // namespace lookout::segmenter
