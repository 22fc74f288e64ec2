// Deviations of places and rates, by hand.
#include "services/odometer/core/motion_uncertainty.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>

namespace lookout::odometer {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double Sd(const Matrix3d& covariance, int i) { return std::sqrt(covariance(i, i)); }

MotionUncertainty AtRest() {
  MotionUncertainty uncertainty({1.0, 1.0, 0.3});
  uncertainty.Begin(Vector3d::Zero());
  return uncertainty;
}

TEST(MotionUncertainty, ASpeedThatIsNotMeasuredIsOffByAnAccelerationThatLasts) {
  for (const double scan_s : {0.05, 0.1}) {
    auto uncertainty = AtRest();
    const int num_scans = static_cast<int>(std::lround(0.7 / scan_s));
    for (int i = 0; i < num_scans; ++i) uncertainty.Predict(scan_s, Matrix3d::Identity());
    EXPECT_NEAR(Sd(uncertainty.rates(), 0), 0.7, 1e-9);
    EXPECT_NEAR(Sd(uncertainty.rates(), 2), 0.21, 1e-9);
    // Each way is that of the speed at its end: a s^2 n (n + 1) / 2.
    EXPECT_NEAR(Sd(uncertainty.place(), 1), scan_s * scan_s * num_scans * (num_scans + 1) / 2, 1e-9);
  }
}

TEST(MotionUncertainty, AMeasuredDirectionIsKnownAsWellAsItIsMeasured) {
  auto uncertainty = AtRest();
  for (int i = 0; i < 10; ++i) {
    uncertainty.Predict(0.1, Matrix3d::Identity());
    Matrix3d measured = uncertainty.expected_place();
    // The north and the bearing; the east says nothing.
    measured.row(1).setZero();
    measured.col(1).setZero();
    measured.row(2).setZero();
    measured.col(2).setZero();
    measured(1, 1) = 1e-6;
    measured(2, 2) = 1e-8;
    uncertainty.Correct(Vector3d::Zero(), measured);
    uncertainty.BeginAtPlace();
  }
  EXPECT_NEAR(Sd(uncertainty.rates(), 0), 1.0, 1e-6);
  EXPECT_NEAR(Sd(uncertainty.rates(), 1), 0.01, 1e-6);
  EXPECT_NEAR(Sd(uncertainty.rates(), 2), 0.001, 1e-6);
}

// Four scans without a fit, then one that says where the boat is: it was accelerating all the time.
TEST(MotionUncertainty, AFitAfterAGapTellsWhereItBegan) {
  auto uncertainty = AtRest();
  for (int i = 0; i < 5; ++i) uncertainty.Predict(0.1, Matrix3d::Identity());
  const Vector3d correction(0.15, 0.0, 0.0);  // 0.01 (1 + 2 + 3 + 4 + 5) m: 1 m/s2
  const Vector3d begin = uncertainty.Correct(correction, 1e-10 * Matrix3d::Identity());
  EXPECT_NEAR(begin.x(), 0.10, 1e-3);
  EXPECT_LT(Sd(uncertainty.rates(), 0), 0.01);
}

TEST(MotionUncertainty, AccelerationsAreAlongTheAxesOfTheVessel) {
  auto uncertainty = MotionUncertainty({1.0, 0.1, 0.3});
  uncertainty.Begin(Vector3d::Zero());
  Matrix3d R_map_vessel;
  R_map_vessel << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  uncertainty.Predict(1.0, R_map_vessel);
  EXPECT_NEAR(Sd(uncertainty.place(), 0), 0.1, 1e-9);
  EXPECT_NEAR(Sd(uncertainty.place(), 1), 1.0, 1e-9);
}

TEST(MotionUncertainty, NoRateIsKnownWorseThanTheLimit) {
  auto uncertainty = MotionUncertainty({1.0, 0.1, 0.3});
  uncertainty.Begin(Vector3d::Zero());
  for (int i = 0; i < 100; ++i) uncertainty.Predict(0.1, Matrix3d::Identity());
  uncertainty.LimitRates(5.0, 0.5);
  EXPECT_NEAR(Sd(uncertainty.rates(), 0), 5.0, 1e-9);
  EXPECT_NEAR(Sd(uncertainty.rates(), 1), 1.0, 1e-9);
  EXPECT_NEAR(Sd(uncertainty.rates(), 2), 0.5, 1e-9);
}

TEST(MotionUncertainty, AnHourAlongAQuayLeavesACovariance) {
  auto uncertainty = AtRest();
  for (int i = 0; i < 36000; ++i) {
    uncertainty.Predict(0.1, Matrix3d::Identity());
    // Across the quay 1 mm, the bearing to 0.1 mrad.
    const Matrix3d information = uncertainty.expected_place().inverse() + Matrix3d(Vector3d(0.0, 1e6, 1e8).asDiagonal());
    uncertainty.Correct(Vector3d::Zero(), information.inverse());
    uncertainty.LimitRates(5.0, 0.5);
    if (uncertainty.place().topLeftCorner<2, 2>().trace() > 4.0) uncertainty.BeginAtPlace();
  }
  EXPECT_NEAR(Sd(uncertainty.rates(), 0), 5.0, 0.2);
  EXPECT_LT(Sd(uncertainty.rates(), 1), 0.02);
  EXPECT_LT(Sd(uncertainty.rates(), 2), 0.002);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix3d>(uncertainty.rates()).eigenvalues()[0], 0.0);
}

}  // namespace
}  // namespace lookout::odometer
