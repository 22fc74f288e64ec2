// Own motion by the lidar on simulated runs, and how far off it is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/utime.hpp"
#include "lab/eval/tracks/track_sources.hpp"
#include "lab/sim/scene.hpp"
#include "lookout/lidar_odometry_t.hpp"

namespace lookout::eval {

/// A LIDAR_ODOMETRY, and when it came.
struct OdometryMessage {
  Utime time;
  lidar_odometry_t message{};
};

/// Simulates the lidar and runs the services lidar and odometer.
///
/// @param kept  a file in which the motions of an earlier call stand, or into which they are written; empty: none
/// @throws config::ConfigError; std::runtime_error for the file
std::vector<OdometryMessage> OdometryOf(const std::filesystem::path& config_folder, const sim::Scene& scene, std::uint64_t seed, double seconds,
                                        const std::filesystem::path& kept);

/// LIDAR_ODOMETRY and the motions of KISS-ICP on the same scans, one of each a scan, and the time of both.
struct ComparedMotions {
  std::vector<OdometryMessage> odometer;
  std::vector<OdometryMessage> kiss_icp;
  double odometer_s = 0.0;  // from the message LIDAR_SCAN to the motion, summed over the scans
  double kiss_icp_s = 0.0;
};

/// As OdometryOf, and KISS-ICP beside the odometer. @throws config::ConfigError
ComparedMotions CompareWithKissIcp(const std::filesystem::path& config_folder, const sim::Scene& scene, std::uint64_t seed, double seconds);

/// Motions against the truth; sums, of several runs too.
struct OdometryScores {
  std::int64_t num_scans = 0;
  std::int64_t num_known = 0;
  double way_m = 0.0;       // true, of the known motions
  double known_s = 0.0;     // their time
  double drift_m = 0.0;     // error of all known motions of a run, one after the other
  double turned_rad = 0.0;  // error of heading of all these motions, without sign
  double forward_m2 = 0.0;  // squares of the errors of each motion
  double port_m2 = 0.0;
  double turn_rad2 = 0.0;
  double nees = 0.0;             // squared errors over the stated covariance
  double longest_wrong_s = 0.0;  // known motions one after the other that are off by more than kWrongM or kWrongTurnRad each

  static constexpr double kWrongM = 0.2;
  static constexpr double kWrongTurnRad = 0.0175;

  void Add(const OdometryScores& other);
};

OdometryScores ScoreOdometry(const std::vector<OdometryMessage>& motions, const sim::Scene& scene, const config::BoatFacts& boat);

}  // namespace lookout::eval
