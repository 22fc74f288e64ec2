// The step by which a measurement corrects the state.
#pragma once

#include <Eigen/LU>

#include "services/navigator/core/filter/state.hpp"

namespace lookout::navigator::filter {

/// Numbers of a measurement that are gated together.
template <int kSize>
struct Innovation {
  Eigen::Matrix<double, kSize, 1> residual;            // measured minus predicted
  Eigen::Matrix<double, kSize, kNumErrors> jacobian =  // of the prediction by the error
      Eigen::Matrix<double, kSize, kNumErrors>::Zero();
  Eigen::Matrix<double, kSize, kSize> noise = Eigen::Matrix<double, kSize, kSize>::Zero();  // covariance
};

struct Correction {
  bool is_accepted = false;
  double nis = 0.0;  // normalised innovation squared: of chi-square distribution with as many degrees of freedom as there are numbers
};

/// Chi-square that a right measurement exceeds once in 10 000, for one, two and three numbers (Abramowitz and Stegun,
/// table 26.8: 15.14, 18.42, 21.11).
template <int kSize>
constexpr double GateThreshold() {
  static_assert(kSize >= 1 && kSize <= 3);
  return kSize == 1 ? 15.14 : kSize == 2 ? 18.42 : 21.11;
}

/// Kalman's update. A measurement beyond the gate changes nothing, unless it is forced.
///
/// Precondition: `noise` is positive definite.
template <int kSize>
Correction Correct(const Innovation<kSize>& innovation, bool is_forced, State& state) {
  const Eigen::Matrix<double, kNumErrors, kSize> cross = state.covariance * innovation.jacobian.transpose();
  const Eigen::Matrix<double, kSize, kSize> covariance = innovation.jacobian * cross + innovation.noise;
  const Eigen::Matrix<double, kSize, kSize> inverse = covariance.inverse();
  Correction correction;
  correction.nis = innovation.residual.dot(inverse * innovation.residual);
  correction.is_accepted = is_forced || correction.nis <= GateThreshold<kSize>();
  if (!correction.is_accepted) return correction;
  const Eigen::Matrix<double, kNumErrors, kSize> gain = cross * inverse;
  state.covariance -= gain * cross.transpose();
  // Rounding only: the two halves stay the same, and a variance stays above 0.
  state.covariance = (0.5 * (state.covariance + state.covariance.transpose())).eval();
  state.covariance.diagonal() = state.covariance.diagonal().cwiseMax(0.0);
  Inject(gain * innovation.residual, state);
  return correction;
}

}  // namespace lookout::navigator::filter
