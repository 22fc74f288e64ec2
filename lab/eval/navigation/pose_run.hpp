// The navigator on the sensors of a simulated boat, some of which are silent for a while, against the truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/eval/navigation/own_motion.hpp"
#include "lab/sim/navigation.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::eval {

/// The sensors that the navigator hears.
struct PoseCase {
  std::string sensors;  // for people: "RTK, IMU"
  sim::NavigationParams navigation;
  bool has_imu = true;
  bool has_odometry = true;
  double gap_begin_s = 0.0;  // from here to the end of the gap only an IMU sends sentences; both 0 = no gap
  double gap_end_s = 0.0;

  bool has_gap() const { return gap_end_s > gap_begin_s; }
};

/// Errors of POSE; of several runs too.
struct PoseScores {
  // In the gap, or from kSettleS on where there is none: of poses on the earth.
  std::vector<double> heading_errors_rad;  // without sign
  std::vector<double> position_errors_m;
  std::vector<double> velocity_errors_mps;
  std::int64_t num_poses = 0;        // poses of that time, on the earth or not
  std::int64_t num_in_ellipse = 0;   // of 95 %
  std::vector<double> end_errors_m;  // of position at the end of the gap, of each run that knew it
  std::vector<double> end_headings_rad;
  std::vector<double> jumps_m;  // greatest from one pose to the next behind the gap, beyond the true way
  std::int64_t num_gated = 0;   // fixes and attitudes that the gate refused
  std::int64_t num_renewed = 0;
  std::int64_t num_gated_odometry = 0;

  static constexpr double kSettleS = 5.0;
  static constexpr double kBehindGapS = 5.0;  // in which jumps count

  void Add(const PoseScores& other);
};

/// @param motions  of the same scene, seed and length
PoseScores RunPose(const std::filesystem::path& config_folder, const sim::Scene& scene, const config::BoatFacts& boat, std::uint64_t seed,
                   double seconds, const std::vector<OdometryMessage>& motions, const PoseCase& pose_case);

/// @return nearest rank; NaN of none
double PercentileOf(std::vector<double> values, double share);
double RmsOf(const std::vector<double>& values);

}  // namespace lookout::eval
