// What is not known of the motion, as one covariance: the place where a scan begins and ends, the rates, and an acceleration that lasts.
#pragma once

#include <Eigen/Core>

namespace lookout::odometer {

/// The errors of places are east-like, north-like (m) and of the bearing (rad, counter-clockwise) along the axes of the map; those of rates and
/// accelerations forward, port (m/s, m/s2) and of the turn (rad/s, rad/s2, counter-clockwise) along those of the vessel.
///
/// A boat that brakes does so for seconds. So the acceleration is one unknown number, not a new one for each scan: the deviation of a speed that no
/// scan measures grows linearly with time. The acceleration is never estimated, only its share in the other errors is followed (Schmidt, "consider"
/// filter; Jazwinski, Stochastic Processes and Filtering Theory, 1970, section 8.4).
class MotionUncertainty {
 public:
  /// @param acceleration_sd  forward and port, m/s2; of the turn, rad/s2
  explicit MotionUncertainty(const Eigen::Vector3d& acceleration_sd) : acceleration_variance_(acceleration_sd.cwiseAbs2()) {}

  /// The place is known, the rates to this.
  void Begin(const Eigen::Vector3d& rates_sd);

  /// To the end of the next scan.
  ///
  /// @param R_map_vessel  in the middle of the motion
  void Predict(double since_s, const Eigen::Matrix3d& R_map_vessel);

  /// The place at the end of the scan was measured.
  ///
  /// @param correction        place measured less place predicted
  /// @param place_covariance  of the place now, with what was predicted
  /// @return the correction of the place at the begin of the motion
  Eigen::Vector3d Correct(const Eigen::Vector3d& correction, const Eigen::Matrix3d& place_covariance);

  /// From here on places are meant as seen from this one: it has no error.
  void BeginAtPlace();

  /// No rate is known worse than this: a boat goes only so fast.
  void LimitRates(double speed_sd_mps, double turn_sd_radps);

  Eigen::Matrix3d place() const { return covariance_.block<3, 3>(kPlace, kPlace); }
  Eigen::Matrix3d rates() const { return covariance_.block<3, 3>(kRates, kRates); }

 private:
  static constexpr int kBegin = 0;
  static constexpr int kPlace = 3;
  static constexpr int kRates = 6;
  static constexpr int kAcceleration = 9;
  using Matrix12 = Eigen::Matrix<double, 12, 12>;

  void HoldAcceleration();

  Eigen::Vector3d acceleration_variance_;
  Matrix12 covariance_ = Matrix12::Zero();
};

}  // namespace lookout::odometer
