// The mounting of the lidar out of a recording: the steps of the method, one after the other.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/config/boat.hpp"
#include "services/odometer/core/odometer.hpp"
#include "tools/calibrate/hand_eye.hpp"
#include "tools/calibrate/orientation.hpp"
#include "tools/calibrate/recording.hpp"

namespace lookout::calibrate {

/// A number with its deviation.
struct Found {
  double value = 0.0;
  double sd = 0.0;
  bool is_found = false;  // its deviation is small enough to be of use
};

/// What the boat did while it was recorded.
struct Manoeuvres {
  double seconds = 0.0;
  double turned_rad = 0.0;      // between the two headings farthest apart, unwrapped
  double way_m = 0.0;           // length of the way
  double turn_changes_radps = 0.0;  // root mean square of the rate of turn about its mean
  double share_in_sight = 0.0;  // of the scans with enough of what stands
};

struct Calibration {
  /// Why nothing is told, in words; empty where the result counts.
  std::string refusal;
  std::vector<std::string> warnings;
  std::vector<std::string> missing;  // motions that would help, in words
  Manoeuvres manoeuvres;

  std::string turned_in_words;  // by right angles against boat.txtpb; empty where it is not

  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();  // found
  Found roll_rad;
  Found pitch_rad;
  Found yaw_rad;
  Found latency_s;
  Found lidar_above_water_m;
  double latency_by_turning_s = 0.0;
  std::size_t num_pairs = 0;
  // Root mean square of what pairs of scans disagree by, with boat.txtpb and with the result.
  double before_m = 0.0;
  double before_rad = 0.0;
  double after_m = 0.0;
  double after_rad = 0.0;
};

struct CalibrationParams {
  config::BoatFacts boat;
  odometer::OdometerParams odometer;
};

Calibration Calibrate(const Recording& recording, const CalibrationParams& params);

/// The motions of the last pass, for checks by other programs.
struct LastPass {
  std::vector<RelativeMotion> motions;
  Correction start;
};

}  // namespace lookout::calibrate
