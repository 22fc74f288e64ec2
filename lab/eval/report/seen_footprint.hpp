// The true place of the seen part of an obstacle, against the place that was published.
#pragma once

#include <Eigen/Geometry>
#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lab/eval/metrics.hpp"
#include "lab/eval/truth.hpp"

namespace lookout::eval {

/// Poses of the truth in one map frame.
class TruePoses {
 public:
  TruePoses(const Truth& truth, const GeographicLib::LocalCartesian& map);

  /// @return T_map_vessel but for its height, between the two neighbours: linear, heading the short way round; nullopt where they are missing or
  /// more than 100 ms apart. At 20 deg/s on a circle of 2.3 m the line is off by 0.02 mm.
  std::optional<Eigen::Isometry3d> At(std::int64_t utime_us) const;

 private:
  struct Sample {
    std::int64_t utime_us;
    Eigen::Vector2d position_m;
    double heading_rad;
    double roll_rad;
    double pitch_rad;
  };
  std::vector<Sample> samples_;  // by time
};

/// A return, where the beam truly met something.
struct SeenReturn {
  std::int64_t utime_us;
  Eigen::Vector3d p_lidar_m;
};

/// @return centre of the area of the convex hull, seen from above, of returns on the map; of a line or a point (less area than a ten-thousandth of
///         the extent squared) the mean of the hull's corners, as georeferencer has it; nullopt when there is none or a pose is missing
std::optional<Eigen::Vector2d> TrueCenter(std::span<const SeenReturn> returns, const Eigen::Isometry3d& T_vessel_lidar, const TruePoses& poses);

/// One obstacle of one scan, more than half of whose returns are of one object.
struct SeenObstacle {
  std::int64_t scan_utime_us = 0;
  int object_id = 0;
  bool is_moving = false;
  bool is_sure = false;
  bool is_land = false;
  double range_m = 0.0;
  int num_points = 0;
  Eigen::Vector2d error_m;        // stated minus true centre; east, north
  Eigen::Matrix2d covariance_m2;  // stated

  double nees() const { return error_m.dot(covariance_m2.inverse() * error_m) / 2.0; }
  /// Chi-square of two degrees of freedom, 95 %: 5.991.
  bool IsInEllipse() const { return 2.0 * nees() <= 5.991; }
  double sd_m() const { return std::sqrt(covariance_m2.trace()); }  // of the distance
};

/// Distances of some obstacles.
struct SeenSummary {
  Summary distance_m;
  Summary stated_sd_m;
  Mean nees;        // per degree of freedom
  Mean in_ellipse;  // share, 0 to 1
  // From one scan to the next: how far the errors of all objects moved together (median over three objects or more, each by its obstacle with most
  // returns, and none that has less than half of its returns in one of the two: the centre of a hull and that of the head above it are not the same
  // point), and that over the median of the deviations stated before.
  Summary jump_m;
  Summary jump_sds;
};

/// @param obstacles  in the order of their scans
SeenSummary Summarise(std::span<const SeenObstacle> obstacles, const std::function<bool(const SeenObstacle&)>& is_meant);

}  // namespace lookout::eval
