#include "services/odometer/core/motion_uncertainty.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace lookout::odometer {

void MotionUncertainty::Begin(const Eigen::Vector3d& rates_sd) {
  covariance_.setZero();
  covariance_.block<3, 3>(kRates, kRates) = rates_sd.cwiseAbs2().asDiagonal();
  HoldAcceleration();
}

void MotionUncertainty::Predict(double since_s, const Eigen::Matrix3d& R_map_vessel) {
  Matrix12 transition = Matrix12::Identity();
  transition.block<3, 6>(kBegin, kBegin) << Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Identity();
  transition.block<3, 3>(kRates, kAcceleration) = since_s * Eigen::Matrix3d::Identity();
  // The rates are the means between two scans: those after the acceleration make the way.
  transition.block<3, 3>(kPlace, kRates) = since_s * R_map_vessel;
  transition.block<3, 3>(kPlace, kAcceleration) = since_s * since_s * R_map_vessel;
  covariance_ = (transition * covariance_ * transition.transpose()).eval();
}

Eigen::Vector3d MotionUncertainty::Correct(const Eigen::Vector3d& correction, const Eigen::Matrix3d& place_covariance) {
  const Eigen::Matrix3d predicted = place();
  // The measurement corrects all other errors by their correlation with that of the place.
  const Eigen::Matrix<double, 12, 3> gain = predicted.ldlt().solve(covariance_.middleRows<3>(kPlace)).transpose();
  covariance_ -= gain * (predicted - place_covariance) * gain.transpose();
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  HoldAcceleration();
  return gain.middleRows<3>(kBegin) * correction;
}

void MotionUncertainty::BeginAtPlace() {
  covariance_.middleRows<3>(kPlace).setZero();
  covariance_.middleCols<3>(kPlace).setZero();
}

void MotionUncertainty::LimitRates(double speed_sd_mps, double turn_sd_radps) {
  const Eigen::Matrix3d before = rates();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(before.topLeftCorner<2, 2>());
  const Eigen::Vector2d worst = solver.eigenvectors().col(1);
  const auto factor = [](double most, double variance) { return variance > most * most ? most / std::sqrt(variance) : 1.0; };
  // Scaling the errors, with their correlations, keeps the matrix a covariance.
  Matrix12 scale = Matrix12::Identity();
  scale.block<2, 2>(kRates, kRates) -= (1.0 - factor(speed_sd_mps, solver.eigenvalues()[1])) * worst * worst.transpose();
  scale(kRates + 2, kRates + 2) = factor(turn_sd_radps, before(2, 2));
  covariance_ = (scale * covariance_ * scale).eval();
}

void MotionUncertainty::HoldAcceleration() { covariance_.block<3, 3>(kAcceleration, kAcceleration) = acceleration_variance_.asDiagonal(); }

}  // namespace lookout::odometer
