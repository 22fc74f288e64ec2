#include "services/tracker/core/land_approach.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout::tracker::land_approach {
namespace {

constexpr EncounterParams kEncounterParams{.limit_m = 5.0, .look_ahead_s = 30.0};
constexpr double kVelocitySdMps = 0.15;

// At (100, 50), northward.
class LandApproachTest : public ::testing::Test {
 protected:
  std::optional<LandApproach> At(double speed_mps, double turn_rate_degps = 0.0) const {
    Pose own;
    own.is_placed = true;
    own.position_map_m = {100.0, 50.0, 0.0};
    own.velocity_map_mps = {0.0, speed_mps};
    const Moving self{{{99.3, 48.8}, {100.7, 48.8}, {100.7, 51.2}, {99.3, 51.2}}, own.velocity_map_mps, DegToRad(turn_rate_degps)};
    return ApproachToLand(own, self, shore_m_, kEncounterParams, kVelocitySdMps);
  }
  // Cells of half a metre along a line.
  void Shore(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    const int num = static_cast<int>((to_m - from_m).norm() / 0.5);
    for (int i = 0; i <= num; ++i) shore_m_.emplace_back(Eigen::Vector2d(100.0, 50.0) + from_m + (to_m - from_m) * i / num);
  }

  std::vector<Eigen::Vector2d> shore_m_;
};

TEST_F(LandApproachTest, OfAWallAheadIsADanger) {
  Shore({-30.0, 40.0}, {30.0, 40.0});
  const auto land = At(2.0);
  ASSERT_TRUE(land);
  EXPECT_GT(land->approach.probability, 0.9);
  EXPECT_NEAR(land->approach.tcpa_s, (40.0 - 1.2) / 2.0, 0.3);
  EXPECT_NEAR(land->approach.cpa_m, 0.0, 0.1);
  EXPECT_NEAR(land->approach.distance_m, 38.8, 0.1);
  EXPECT_NEAR(WrapToPi(land->bearing_rad), 0.0, DegToRad(5.0));
  ASSERT_FALSE(land->places.empty());
  for (const auto& place : land->places) EXPECT_LT(std::fabs(WrapToPi(place.bearing_rad)), DegToRad(25.0));
}

TEST_F(LandApproachTest, OfLandThatIsReachedLaterIsNone) {
  Shore({-30.0, 80.0}, {30.0, 80.0});
  const auto land = At(2.0);
  EXPECT_TRUE(!land || land->approach.probability < 0.5) << "in 40 s";
}

TEST_F(LandApproachTest, OfAQuayAlongsideIsNone) {
  Shore({-4.0, -60.0}, {-4.0, 60.0});
  const auto land = At(1.0);
  EXPECT_TRUE(!land || land->approach.probability < 0.5) << land->approach.probability;
}

TEST_F(LandApproachTest, OfAQuayThatTheWayLeadsToIsADanger) {
  Shore({-12.0, -10.0}, {8.0, 30.0});
  const auto land = At(2.0);
  ASSERT_TRUE(land);
  EXPECT_GT(land->approach.probability, 0.5);
}

TEST_F(LandApproachTest, OfLandAsternOrFarAsideIsNone) {
  Shore({-30.0, -20.0}, {30.0, -20.0});
  Shore({40.0, 0.0}, {40.0, 60.0});
  EXPECT_FALSE(At(2.0));
}

TEST_F(LandApproachTest, OfAWallThatTheBoatTurnsAwayFromIsNone) {
  Shore({-30.0, 40.0}, {-5.0, 40.0});
  const auto straight = At(3.0);
  ASSERT_TRUE(straight);
  EXPECT_GT(straight->approach.probability, 0.5);
  const auto turning = At(3.0, 15.0);
  EXPECT_TRUE(!turning || turning->approach.probability < 0.5);
}

TEST_F(LandApproachTest, OfNoLandIsNone) { EXPECT_FALSE(At(2.0)); }

}  // namespace
}  // namespace lookout::tracker::land_approach
