// Whether the lidar's own motions are as good as they say.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/core/utime.hpp"
#include "services/navigator/core/filter/params.hpp"
#include "services/navigator/core/odometry.hpp"

namespace lookout::navigator::filter {

struct State;

/// The lidar may see a ship that moves, or a bank in steep waves: its motions are then wrong by more than they state, scan after scan in the same
/// direction, and each motion alone looks right. While position or heading are measured, the sum of the motions over kWindowS is therefore compared
/// with the way or the turn of the state. Where the two differ by more than their stated deviations explain, the ratio is remembered, and the stated
/// deviations of later motions are multiplied by it: also when a receiver or a compass stops, and nothing else tells how far the motions can be
/// trusted (covariance matching: R. K. Mehra, "On the identification of variances and adaptive Kalman filtering", IEEE Transactions on Automatic
/// Control 15, 1970).
class MotionTrial {
 public:
  static constexpr double kWindowS = 3.0;

  /// @param motion  known, from the place of the last scan, not refused
  /// @param noise   its covariance as it counts before these factors: forward, port, turn
  /// @param is_way_measured   fixes come, and none is refused
  /// @param is_turn_measured  headings come, and none is refused
  /// @param state   at the end of the motion, before it is corrected by it
  void Add(const OdometryMotion& motion, const Eigen::Matrix3d& noise, bool is_way_measured, bool is_turn_measured, const FilterParams& params,
           const State& state);
  /// A motion is missing or refused, or the state was set anew: what was found before stays.
  void Break() { begin_.reset(); }

  /// How many times the stated deviation of forward and port, and of the turn, counts: 1 or more.
  double way_factor() const { return way_.Factor(); }
  double turn_factor() const { return turn_.Factor(); }

 private:
  struct Begin {
    Utime time;
    GeodeticPlace origin;  // of the level frame
    Eigen::Vector2d p_level_m = Eigen::Vector2d::Zero();
    double heading_rad = 0.0;
    double place_variance_m2 = 0.0;  // the greater of the variances of east and north
    double heading_variance_rad2 = 0.0;
    bool is_way_measured = false;
    bool is_turn_measured = false;
  };
  static Begin BeginAt(const FilterParams& params, const State& state, bool is_way_measured, bool is_turn_measured);
  // Means over the last windows: of the squared difference, and of the variances by which sensors and motions explain it.
  struct Means {
    double square = 0.0;
    double of_sensors = 0.0;
    double of_motions = 0.0;

    void Add(double new_square, double new_of_sensors, double new_of_motions);
    double Factor() const;
  };

  std::optional<Begin> begin_;
  // Since the begin, by the lidar alone.
  Eigen::Vector2d way_level_m_ = Eigen::Vector2d::Zero();
  double turn_rad_ = 0.0;
  double way_variance_m2_ = 0.0;  // of each axis
  double turn_variance_rad2_ = 0.0;

  Means way_;
  Means turn_;
};

}  // namespace lookout::navigator::filter
