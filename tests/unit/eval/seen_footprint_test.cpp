#include "lab/eval/report/seen_footprint.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/eval/truth_fixture.hpp"

namespace lookout::eval {
namespace {

// A boat that goes north by 1 m in 20 ms from the datum and turns from 350 to 10 degrees meanwhile.
class SeenFootprint : public testing::Test {
 protected:
  SeenFootprint() {
    WriteTruth(folder_);
    const GeographicLib::LocalCartesian map(kDatumLatitudeDeg, kDatumLongitudeDeg, kDatumHeightM);
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double height_m = 0.0;
    map.Reverse(0.0, 1.0, 0.0, latitude_deg, longitude_deg, height_m);
    char rows[256];
    std::snprintf(rows, sizeof(rows), "%lld,43.63,-72.15,350,0,0\n%lld,%.10f,%.10f,10,0,0\n", kStartUs, kStartUs + 20'000, latitude_deg,
                  longitude_deg);
    WriteFile(folder_ / "pose.csv", std::string("utime_us,latitude_deg,longitude_deg,heading_deg,roll_deg,pitch_deg\n") + rows);
  }
  TruePoses Poses() const { return {Truth(folder_), {kDatumLatitudeDeg, kDatumLongitudeDeg, kDatumHeightM}}; }

  support::TempDir folder_;
};

TEST_F(SeenFootprint, PosesLieBetweenTheirNeighboursAndHeadingGoesTheShortWay) {
  const auto poses = Poses();
  const auto middle = poses.At(kStartUs + 10'000);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->translation().y(), 0.5, 1e-3);
  const Eigen::Vector3d ahead = middle->linear() * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(ahead.y(), 1.0, 1e-9) << "north";
  EXPECT_FALSE(poses.At(kStartUs - 1));
  EXPECT_FALSE(poses.At(kStartUs + 20'001));
}

// Four corners of a square of 2 m and many points along one side: the centre of the area, not the mean of the points.
TEST_F(SeenFootprint, CentreIsThatOfTheHullOnTheMapByThePoseOfEachReturn) {
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  T_vessel_lidar.translation() = Eigen::Vector3d(0.5, 0.0, 1.0);
  const auto poses = Poses();
  std::vector<SeenReturn> returns;
  const auto see = [&](double east_m, double north_m, std::int64_t after_us) {
    const Eigen::Isometry3d T_map_lidar = *poses.At(kStartUs + after_us) * T_vessel_lidar;
    returns.push_back({kStartUs + after_us, T_map_lidar.inverse() * Eigen::Vector3d(east_m, north_m, 3.0)});
  };
  see(10.0, 20.0, 0);
  see(12.0, 20.0, 5'000);
  see(12.0, 22.0, 15'000);
  see(10.0, 22.0, 20'000);
  for (int i = 1; i < 20; ++i) see(10.0 + 0.1 * i, 20.0, 700 * i);
  const auto center_m = TrueCenter(returns, T_vessel_lidar, poses);
  ASSERT_TRUE(center_m);
  EXPECT_NEAR((*center_m - Eigen::Vector2d(11.0, 21.0)).norm(), 0.0, 1e-6);
  EXPECT_FALSE(TrueCenter({}, T_vessel_lidar, poses));
  returns.push_back({kStartUs + 30'000, Eigen::Vector3d::Zero()});
  EXPECT_FALSE(TrueCenter(returns, T_vessel_lidar, poses)) << "a return without a pose";
}

TEST_F(SeenFootprint, CentreOfALineIsItsMiddleAndOfAPointThePoint) {
  const Eigen::Isometry3d level = Eigen::Isometry3d::Identity();
  const auto poses = Poses();
  const auto seen_from_start = [&](double east_m) { return SeenReturn{kStartUs, poses.At(kStartUs)->inverse() * Eigen::Vector3d(east_m, 7.0, 0.0)}; };
  const std::vector<SeenReturn> line{seen_from_start(1.0), seen_from_start(2.0), seen_from_start(2.2), seen_from_start(5.0)};
  EXPECT_NEAR((*TrueCenter(line, level, poses) - Eigen::Vector2d(3.0, 7.0)).norm(), 0.0, 1.0) << "somewhere on it";
  EXPECT_NEAR(TrueCenter(line, level, poses)->y(), 7.0, 1e-6);
  const std::vector<SeenReturn> point{seen_from_start(4.0)};
  EXPECT_NEAR((*TrueCenter(point, level, poses) - Eigen::Vector2d(4.0, 7.0)).norm(), 0.0, 1e-6);
}

SeenObstacle At(std::int64_t turn, int object_id, double east_error_m) {
  SeenObstacle obstacle;
  obstacle.scan_utime_us = kStartUs + 100'000 * turn;
  obstacle.object_id = object_id;
  obstacle.num_points = 10;
  obstacle.error_m = {east_error_m, 0.0};
  obstacle.covariance_m2 = 0.01 * Eigen::Matrix2d::Identity();
  return obstacle;
}

TEST(Summarise, CountsWhatLiesInTheEllipse) {
  // 5.991 is the square of 2.4477 deviations.
  const std::vector<SeenObstacle> seen{At(0, 1, 0.2447), At(0, 2, 0.2448), At(0, 3, 9.0)};
  const auto summary = Summarise(seen, [](const SeenObstacle& obstacle) { return obstacle.object_id != 3; });
  EXPECT_EQ(summary.distance_m.count(), 2U);
  EXPECT_EQ(summary.in_ellipse, (Mean{2, 1.0}));
  EXPECT_NEAR(summary.stated_sd_m.Median(), std::sqrt(0.02), 1e-12);
  EXPECT_NEAR(summary.nees.sum, (0.2447 * 0.2447 + 0.2448 * 0.2448) / 0.01 / 2.0, 1e-9);
}

TEST(Summarise, AJumpIsWhatAllObjectsMakeTogether) {
  std::vector<SeenObstacle> seen;
  for (const int object_id : {1, 2, 3}) seen.push_back(At(0, object_id, 0.0));
  for (const int object_id : {1, 2, 3}) seen.push_back(At(1, object_id, object_id == 2 ? 5.0 : 0.3));  // one changes its shape
  seen.push_back(At(1, 1, 7.0));
  seen.back().num_points = 3;                                                     // a small piece of object 1
  for (const int object_id : {1, 2, 3}) seen.push_back(At(9, object_id, 100.0));  // turns are missing
  const auto summary = Summarise(seen, [](const SeenObstacle&) { return true; });
  ASSERT_EQ(summary.jump_m.count(), 1U);
  EXPECT_NEAR(summary.jump_m.Max(), 0.3, 1e-12);
  EXPECT_NEAR(summary.jump_sds.Max(), 0.3 / std::sqrt(0.02), 1e-9);
}

// Two kayaks came out of a wave in one scan, heads first and then hulls: of five objects seen, that looked like a jump of all.
TEST(Summarise, AnObjectOfWhichMoreIsSeenIsNoPartOfAJump) {
  std::vector<SeenObstacle> seen;
  for (const int object_id : {1, 2, 3, 4, 5}) seen.push_back(At(0, object_id, 0.0));
  for (const int object_id : {1, 2, 3, 4, 5}) seen.push_back(At(1, object_id, object_id <= 3 ? 0.01 * object_id : 0.5));
  seen[3].num_points = 4;
  seen[4].num_points = 21;
  const auto summary = Summarise(seen, [](const SeenObstacle&) { return true; });
  ASSERT_EQ(summary.jump_m.count(), 1U);
  EXPECT_NEAR(summary.jump_m.Max(), 0.02, 1e-12);
  seen[2].num_points = 30;  // two are left
  EXPECT_EQ(Summarise(seen, [](const SeenObstacle&) { return true; }).jump_m.count(), 0U);
}

}  // namespace
}  // namespace lookout::eval
