// The covariance of an obstacle's position against drawing all its errors many times.
#include <Eigen/Cholesky>
#include <gtest/gtest.h>
#include <random>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "services/georeferencer/core/placement.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Noise = Eigen::Matrix<double, 5, 1>;
using Covariance = Eigen::Matrix<double, 5, 5>;

constexpr int kNumDraws = 20'000;

Matrix2d Drawn(const Vector3d& p_vessel_m, const Pose& pose, const PlacementParams& params, std::mt19937& random) {
  std::normal_distribution<double> normal;
  // A position that is known has no variance: of the rest alone there is a root.
  Covariance root = Covariance::Zero();
  if (pose.covariance(0, 0) > 0.0) {
    root = pose.covariance.llt().matrixL();
  } else {
    root.bottomRightCorner<3, 3>() = pose.covariance.bottomRightCorner<3, 3>().llt().matrixL();
  }
  const Vector3d p_lidar_m = params.T_vessel_lidar.inverse() * p_vessel_m;
  std::vector<Vector2d> positions;
  Vector2d mean = Vector2d::Zero();
  for (int i = 0; i < kNumDraws; ++i) {
    Noise noise;
    for (auto& number : noise) number = normal(random);
    noise = root * noise;
    const Vector3d turn(normal(random), normal(random), normal(random));
    const Vector3d seen_m = (1.0 + params.range_sd_m * normal(random) / p_lidar_m.norm()) * p_lidar_m;
    const Eigen::AngleAxisd by_azimuth(params.azimuth_sd_rad * normal(random), Vector3d::UnitZ());
    // The mounting's error turns the lidar about the vessel's axes.
    const double angle_rad = params.mounting_sd_rad * turn.norm();
    const Vector3d turned_m = Eigen::AngleAxisd(angle_rad, turn.normalized()) * (params.T_vessel_lidar.linear() * (by_azimuth * seen_m));
    const Vector3d p_m = RotationMapVessel(pose.heading_rad + noise[4], pose.pitch_rad + noise[3], pose.roll_rad + noise[2]) *
                         (turned_m + params.T_vessel_lidar.translation());
    positions.push_back(p_m.head<2>() + noise.head<2>());
    mean += positions.back() / kNumDraws;
  }
  Matrix2d covariance = Matrix2d::Zero();
  for (const auto& position : positions) covariance += (position - mean) * (position - mean).transpose() / (kNumDraws - 1);
  return covariance;
}

TEST(GeoreferencerCovariance, AgreesWithAMonteCarloRunWithin5Percent) {
  double worst = 0.0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto between = [&random](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    Pose pose = test::MakePose(0);
    pose.heading_rad = between(0, kTwoPi);
    pose.pitch_rad = between(-0.2, 0.2);
    pose.roll_rad = between(-0.2, 0.2);
    // Some correlation of everything with everything; angles up to 5 degrees.
    Covariance mixing = Covariance::Identity();
    for (auto& number : mixing.reshaped()) number += between(-0.3, 0.3);
    const double angle_sd_rad = DegToRad(between(0.2, 5.0));
    Noise scale;
    scale << between(0.01, 3), between(0.01, 3), angle_sd_rad, angle_sd_rad, angle_sd_rad;
    scale.tail<3>() /= std::sqrt(1.0 + 4.0 * 0.3 * 0.3);
    pose.covariance = scale.asDiagonal() * mixing * mixing.transpose() * scale.asDiagonal();
    PlacementParams params;
    Mounting mounting;
    mounting.p_vessel_m = {between(-2, 2), between(-1, 1), between(0, 2)};
    mounting.yaw_rad = between(-kPi, kPi);
    mounting.pitch_rad = between(-0.1, 0.1);
    params.T_vessel_lidar = TransformVesselSensor(mounting);
    params.range_sd_m = between(0.01, 1);
    params.mounting_sd_rad = DegToRad(between(0, 2));
    params.azimuth_sd_rad = DegToRad(between(0, 2));
    const Vector3d p_vessel_m(between(-100, 100), between(-100, 100), between(-3, 3));

    const Matrix2d expected = Drawn(p_vessel_m, pose, params, random);
    const Matrix2d covariance = PositionCovariance(p_vessel_m, pose, params);
    EXPECT_NEAR(covariance(0, 1), covariance(1, 0), 1e-12 * covariance.norm());
    EXPECT_GT(covariance.determinant(), 0.0);
    const double error = (covariance - expected).norm() / expected.norm();
    EXPECT_LT(error, 0.05) << "seed " << seed << "\n" << covariance << "\nagainst\n" << expected;
    worst = std::max(worst, error);

    // Relative to the boat: drawn with a position that is known.
    const Matrix2d relative = RelativeCovariance(p_vessel_m, pose, params);
    pose.covariance.topRows<2>().setZero();
    pose.covariance.leftCols<2>().setZero();
    const Matrix2d expected_relative = Drawn(p_vessel_m, pose, params, random);
    EXPECT_LT((relative - expected_relative).norm(), 0.05 * expected_relative.norm()) << "seed " << seed << "\n"
                                                                                      << relative << "\nagainst\n"
                                                                                      << expected_relative;
  }
  std::printf("worst relative error %.3f\n", worst);
}

}  // namespace
}  // namespace lookout::georeferencer
