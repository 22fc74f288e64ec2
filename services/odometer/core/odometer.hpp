// Own motion from scan to scan. The method: points of standing things, straightened by the last motion, are registered with a map of earlier points.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/utime.hpp"
#include "services/odometer/core/local_map.hpp"
#include "services/odometer/core/motion_uncertainty.hpp"
#include "services/odometer/core/registration.hpp"
#include "services/odometer/core/standing.hpp"

namespace lookout::odometer {

/// The numbers of lidar_odometry_t.
enum class Reason { kNone = 0, kFirstScan = 1, kGap = 2, kFewReturns = 3, kOneThing = 4, kNoFit = 5, kUndetermined = 6 };

struct OdometerParams {
  StandingParams standing;
  // Deviations of an acceleration that lasts.
  double acceleration_sd_mps2 = 1.0;
  double turn_acceleration_sd_radps2 = 0.3;
};

/// Motion from the end of the scan before to the end of this scan.
struct Motion {
  Utime begin;
  Utime end;
  Reason reason = Reason::kNone;                             // why the motion is unknown; kNone: it is known
  Eigen::Vector2d displacement_m = Eigen::Vector2d::Zero();  // of the reference point, forward and port at `begin`, levelled
  double turn_rad = 0.0;                                     // of the bow, clockwise
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();      // of forward, port, turn
  int num_returns = 0;
  int num_matched = 0;
  double residual_m = 0.0;

  bool is_known() const { return reason == Reason::kNone; }
};

class Odometer {
 public:
  /// Over a longer time than this no motion is measured: scans are missing.
  static constexpr double kMaxGapS = 0.5;

  explicit Odometer(const OdometerParams& params)
      : params_(params), uncertainty_({params.acceleration_sd_mps2, params.acceleration_sd_mps2, params.turn_acceleration_sd_radps2}) {}

  /// @param scan  ends after the scan before, or begins anew
  Motion Consume(const Scan& scan);

  void Reset();

 private:
  using Rates = Eigen::Vector3d;  // forward, port (m/s), turn (rad/s, counter-clockwise as the map's axes have it)

  void Begin(const Scan& scan);
  std::vector<MapPoint> Straightened(const std::vector<TimedPoint>& points) const;
  struct Prediction {
    Expected expected;
    bool are_rates_known = false;                          // the rates by which the scan is straightened are known
    Eigen::Matrix3d distortion = Eigen::Matrix3d::Zero();  // covariance of the place by a distorted scan, map axes
  };
  Prediction Predict(double since_s);
  void Follow(const Fit& fit, const Prediction& predicted, double since_s, Motion& motion);
  void KeepPlace(bool is_first, const Motion& motion);
  void LoseSight(const Scan& scan, const std::vector<MapPoint>& points, const Expected& expected);
  bool IsDetermined() const;
  void AddToMap(const std::vector<MapPoint>& points, const std::vector<std::size_t>& sample, const Fit* fit);
  Reason Judge(const std::vector<MapPoint>& points, const Fit& fit) const;

  OdometerParams params_;
  LocalMap map_;
  std::optional<Utime> time_;  // end of the last scan
  Eigen::Isometry3d T_map_vessel_ = Eigen::Isometry3d::Identity();
  Rates rates_ = Rates::Zero();
  MotionUncertainty uncertainty_;
  // How the boat rolls and pitches: about its x and y axes, rad/s, smoothed.
  Eigen::Vector2d tilt_rates_radps_ = Eigen::Vector2d::Zero();
  int num_known_ = 0;    // scans in a row whose motion is known
  int num_unknown_ = 0;  // or not
  std::int64_t num_scans_ = 0;
};

}  // namespace lookout::odometer
