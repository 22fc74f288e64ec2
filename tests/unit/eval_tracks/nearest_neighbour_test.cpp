#include "lab/eval/baselines/nearest_neighbour.hpp"

#include <gtest/gtest.h>

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

obstacle_t ObstacleAt(int id, const Vector2d& p_m) {
  obstacle_t obstacle{};
  obstacle.id = id;
  obstacle.status = obstacle_t::STATUS_OK;
  obstacle.confidence = obstacle_t::CONFIDENCE_SURE;
  obstacle.kind = obstacle_t::KIND_OBSTACLE;
  obstacle.position_map_m[0] = p_m.x();
  obstacle.position_map_m[1] = p_m.y();
  for (const double side : {-0.5, 0.5}) {
    obstacle.footprint_east_m.push_back(static_cast<float>(p_m.x() + side));
    obstacle.footprint_north_m.push_back(static_cast<float>(p_m.y()));
  }
  obstacle.num_map = 2;
  return obstacle;
}

class NearestNeighbourTest : public ::testing::Test {
 protected:
  std::vector<TrackState> Update(const std::vector<obstacle_t>& obstacles) {
    messages::ScanMessages scan;
    obstacles_t message{};
    message.num_parts = 1;
    message.end_utime_us = ++num_scans_ * 100'000;
    message.obstacles = obstacles;
    message.num_obstacles = static_cast<std::int32_t>(obstacles.size());
    scan.obstacles[0] = message;
    return tracker_.Update(scan);
  }

  NearestNeighbour tracker_;
  std::int64_t num_scans_ = 0;
};

TEST_F(NearestNeighbourTest, ThreeHitsOfFiveConfirmAndFiveMissesEnd) {
  const auto thing = ObstacleAt(1, {10.0, 0.0});
  EXPECT_EQ(Update({thing}).front().status, TrackStatus::kTentative);
  EXPECT_EQ(Update({}).front().status, TrackStatus::kTentative);
  EXPECT_EQ(Update({thing}).front().status, TrackStatus::kTentative);
  EXPECT_EQ(Update({thing}).front().status, TrackStatus::kConfirmed);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(Update({}).front().status, TrackStatus::kCoasting);
  EXPECT_TRUE(Update({}).empty());
  EXPECT_EQ(Update({thing}).front().id, 2);  // an id is not used twice
}

TEST_F(NearestNeighbourTest, VelocityIsLearntAndCarriesTheOutline) {
  std::vector<TrackState> tracks;
  for (int n = 0; n < 60; ++n) tracks = Update({ObstacleAt(1, {0.3 * n, 5.0})});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_NEAR(tracks[0].velocity_mps.x(), 3.0, 0.05);
  EXPECT_NEAR(tracks[0].velocity_mps.y(), 0.0, 1e-9);
  EXPECT_TRUE(tracks[0].is_moving);
  const auto before = tracks[0];
  tracks = Update({});
  EXPECT_NEAR(tracks[0].position_m.x() - before.position_m.x(), 0.3, 0.01);
  EXPECT_NEAR(tracks[0].outline_m[0].x() - before.outline_m[0].x(), 0.3, 0.01);
  EXPECT_TRUE(tracks[0].segment_ids.empty());
}

TEST_F(NearestNeighbourTest, WhatIsTentativeLandOrNotPlacedIsLeftOut) {
  auto tentative = ObstacleAt(1, {0.0, 0.0});
  tentative.confidence = obstacle_t::CONFIDENCE_TENTATIVE;
  auto land = ObstacleAt(2, {10.0, 0.0});
  land.kind = obstacle_t::KIND_LAND;
  auto unplaced = ObstacleAt(3, {20.0, 0.0});
  unplaced.status = obstacle_t::STATUS_VESSEL_FRAME_ONLY;
  EXPECT_TRUE(Update({tentative, land, unplaced}).empty());
}

TEST_F(NearestNeighbourTest, TheNearestPairGoesFirst) {
  Update({ObstacleAt(1, {0.0, 0.0}), ObstacleAt(2, {2.0, 0.0})});
  const auto tracks = Update({ObstacleAt(1, {1.9, 0.0})});  // the first track may not have what the second is nearer to
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_TRUE(tracks[0].segment_ids.empty());
  EXPECT_EQ(tracks[1].segment_ids, std::vector<std::int32_t>{1});
}

}  // namespace
}  // namespace lookout::eval
