#include "services/odometer/core/motion_uncertainty.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace lookout::odometer {

void MotionUncertainty::Begin(const Eigen::Vector3d& rates_sd) {
  covariance_.setZero();
  covariance_.block<3, 3>(kRates, kRates) = rates_sd.cwiseAbs2().asDiagonal();
  expected_rates_ = rates();
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
  expected_rates_.diagonal() += since_s * since_s * acceleration_variance_;
  expected_place_ = place();
  if (HasExactBegin()) expected_place_ = since_s * since_s * R_map_vessel * expected_rates_ * R_map_vessel.transpose();
}

Eigen::Vector3d MotionUncertainty::Correct(const Eigen::Vector3d& correction, const Eigen::Matrix3d& place_covariance) {
  const Eigen::Matrix3d predicted = place();
  // The share of the error of the prediction that is left, by the weights of the fit.
  const Eigen::Matrix3d left = expected_place_.ldlt().solve(place_covariance).transpose();
  const Eigen::Matrix3d corrected = place_covariance + left * (predicted - expected_place_) * left.transpose();
  // The measurement corrects all other errors by their correlation with the error of the place.
  const Eigen::Matrix<double, 12, 3> gain = predicted.ldlt().solve(covariance_.middleRows<3>(kPlace)).transpose();
  const Eigen::Matrix<double, 12, 3> with_acceleration =
      covariance_.middleCols<3>(kAcceleration) - gain * (Eigen::Matrix3d::Identity() - left) * covariance_.block<3, 3>(kPlace, kAcceleration);
  covariance_ -= gain * (predicted - corrected) * gain.transpose();
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  covariance_.middleCols<3>(kAcceleration) = with_acceleration;
  covariance_.middleRows<3>(kAcceleration) = with_acceleration.transpose();
  HoldAcceleration();
  expected_rates_ = rates();
  if (HasExactBegin()) expected_rates_ = gain.middleRows<3>(kRates) * place_covariance * gain.middleRows<3>(kRates).transpose();
  return gain.middleRows<3>(kBegin) * correction;
}

void MotionUncertainty::BeginAtPlace() {
  covariance_.middleRows<3>(kPlace).setZero();
  covariance_.middleCols<3>(kPlace).setZero();
}

void MotionUncertainty::LimitRates(double speed_sd_mps, double turn_sd_radps) {
  const Eigen::Matrix3d before = rates();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(before.topLeftCorner<2, 2>());
  const auto factor = [](double most, double variance) { return variance > most * most ? most / std::sqrt(variance) : 1.0; };
  // Scaling the errors, with their correlations, keeps the matrix a covariance.
  Matrix12 scale = Matrix12::Identity();
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d direction = solver.eigenvectors().col(i);
    scale.block<2, 2>(kRates, kRates) -= (1.0 - factor(speed_sd_mps, solver.eigenvalues()[i])) * direction * direction.transpose();
  }
  scale(kRates + 2, kRates + 2) = factor(turn_sd_radps, before(2, 2));
  covariance_ = (scale * covariance_ * scale).eval();
}

void MotionUncertainty::HoldAcceleration() { covariance_.block<3, 3>(kAcceleration, kAcceleration) = acceleration_variance_.asDiagonal(); }

}  // namespace lookout::odometer
