// The fit of a scan to the map, by points with a known place.
#include "services/odometer/core/registration.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout::odometer {
namespace {

// Things all around, each of some posts of several heights.
constexpr int kNumThings = 18;
constexpr int kPostsOfThing = 4;

std::vector<MapPoint> ThingAt(int number, double range_m) {
  const double bearing_rad = 2.0 * std::numbers::pi * number / kNumThings;
  std::vector<MapPoint> points;
  for (int post = 0; post < kPostsOfThing; ++post) {
    for (const double height_m : {1.2, 2.4, 3.6}) {
      const Eigen::Vector3d along(-std::sin(bearing_rad), std::cos(bearing_rad), 0.0);
      const Eigen::Vector3d middle_m(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), height_m);
      points.push_back({middle_m + (0.7 * post - 1.0) * along, Eigen::Vector3d::Zero(), Shape::kPost, 0.0});
    }
  }
  return points;
}

Expected NothingExpected() {
  Expected expected;
  expected.information.diagonal().setConstant(1e-3);
  return expected;
}

// In waves a small boat has rolled by more than a degree where it was expected to be: a bank 60 m off is then 1.6 m higher.
TEST(Register, FindsTheAttitudeOfABoatThatRolls) {
  LocalMap map;
  std::vector<MapPoint> points;
  const Eigen::Matrix3d R_map_vessel = RotationBy({DegToRad(1.5), DegToRad(-1.0), 0.0});
  for (int i = 0; i < kNumThings; ++i) {
    for (const auto& point : ThingAt(i, 60.0)) {
      map.Add(point);
      points.push_back({R_map_vessel.transpose() * point.p_m, point.normal, point.shape, 0.0});
    }
  }
  const auto fit = Register(points, NothingExpected(), map);
  EXPECT_EQ(fit.num_matched, static_cast<int>(points.size()));
  const Eigen::Vector3d left_rad = RotationVector(R_map_vessel.transpose() * fit.T_map_vessel.linear());
  EXPECT_LT(RadToDeg(left_rad.head<2>().norm()), 0.1);
  EXPECT_LT(std::abs(RadToDeg(left_rad.z())), 0.02);
  EXPECT_LT(fit.T_map_vessel.translation().head<2>().norm(), 0.02);
}

// All returns of a thing are off alike, as of a boat that swings, or a bank in waves: the fit errs by as many errors as there are things.
TEST(Register, TheScatterOfThingsSaysHowFarTheFitErrs) {
  constexpr double kThingSdM = 0.1;
  constexpr int kRuns = 60;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  double by_scatter = 0.0;
  double by_returns = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    LocalMap map;
    std::vector<MapPoint> points;
    for (int i = 0; i < kNumThings; ++i) {
      const Eigen::Vector3d off_m = kThingSdM * Eigen::Vector3d(normal(random), normal(random), 0.0);
      for (const auto& point : ThingAt(i, 25.0)) {
        map.Add(point);
        points.push_back(point);
        points.back().p_m += off_m;
      }
    }
    const auto fit = Register(points, NothingExpected(), map);
    const Matrix6 inverse = fit.information.ldlt().solve(Matrix6::Identity());
    const Matrix6& scattered = fit.covariance_of_things;
    Vector6 error;
    error << fit.T_map_vessel.translation(), RotationVector(fit.T_map_vessel.linear());
    for (const int planar : {0, 1, 5}) {
      by_scatter += error[planar] * error[planar] / scattered(planar, planar) / (3.0 * kRuns);
      by_returns += error[planar] * error[planar] / inverse(planar, planar) / (3.0 * kRuns);
    }
  }
  EXPECT_GT(by_scatter, 0.5);
  EXPECT_LT(by_scatter, 1.8);
  EXPECT_GT(by_returns, 2.0) << "where each return counts by itself";
}

}  // namespace
}  // namespace lookout::odometer
