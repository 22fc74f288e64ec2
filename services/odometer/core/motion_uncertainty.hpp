// Covariance of the motion: of the places at the begin and the end of a scan, of the rates, and of an acceleration that lasts.
#pragma once

#include <Eigen/Core>

namespace lookout::odometer {

/// Places: east-like, north-like (m), bearing (rad, counter-clockwise), along the axes of the map. Rates and accelerations: forward, port (m/s,
/// m/s2), turn (rad/s, rad/s2, counter-clockwise), along the axes of the vessel.
///
/// A boat brakes for seconds. The acceleration is therefore one unknown constant, not new noise with each scan: the deviation of a speed
/// that no scan measures grows linearly with time. The acceleration is not estimated; its correlation with the other errors is followed (a
/// Schmidt-Kalman or "consider" filter; Jazwinski, Stochastic Processes and Filtering Theory, 1970, section 8.4).
///
/// The fit weighs its prediction as if the acceleration were new with each scan (`expected_place`): a weaker prediction lets through more noise of
/// single scans. The covariance states the errors of this fit for a boat whose acceleration lasts.
class MotionUncertainty {
 public:
  /// @param acceleration_sd  of forward and port, m/s2; of the turn, rad/s2
  explicit MotionUncertainty(const Eigen::Vector3d& acceleration_sd) : acceleration_variance_(acceleration_sd.cwiseAbs2()) {}

  /// The place has no error.
  ///
  /// @param rates_sd  deviations of the rates
  void Begin(const Eigen::Vector3d& rates_sd);

  /// Goes on to the end of the next scan.
  ///
  /// @param R_map_vessel  in the middle of the motion
  void Predict(double since_s, const Eigen::Matrix3d& R_map_vessel);

  /// Uses a measurement of the place at the end of the scan.
  ///
  /// @param correction        measured place less predicted place
  /// @param place_covariance  of the place by measurement and expected_place()
  /// @return the correction of the place at the begin of the motion
  Eigen::Vector3d Correct(const Eigen::Vector3d& correction, const Eigen::Matrix3d& place_covariance);

  /// Measures later places from the present place, which has no error from here on.
  void BeginAtPlace();

  /// Bounds the deviations of the rates, in every direction: a boat goes only so fast.
  void LimitRates(double speed_sd_mps, double turn_sd_radps);

  /// Covariance of the predicted place with which the measurement is to be weighed.
  const Eigen::Matrix3d& expected_place() const { return expected_place_; }
  Eigen::Matrix3d place() const { return covariance_.block<3, 3>(kPlace, kPlace); }
  Eigen::Matrix3d rates() const { return covariance_.block<3, 3>(kRates, kRates); }

 private:
  static constexpr int kBegin = 0;
  static constexpr int kPlace = 3;
  static constexpr int kRates = 6;
  static constexpr int kAcceleration = 9;
  using Matrix12 = Eigen::Matrix<double, 12, 12>;

  void HoldAcceleration();
  bool HasExactBegin() const { return covariance_.block<3, 3>(kBegin, kBegin).isZero(0.0); }

  Eigen::Vector3d acceleration_variance_;
  Matrix12 covariance_ = Matrix12::Zero();
  Eigen::Matrix3d expected_rates_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d expected_place_ = Eigen::Matrix3d::Zero();
};

}  // namespace lookout::odometer
