// The mounting of the lidar out of a recording: the steps of the method, one after the other.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/config/boat.hpp"
#include "services/odometer/core/odometer.hpp"
#include "tools/calibrate/hand_eye.hpp"
#include "tools/calibrate/orientation.hpp"
#include "tools/calibrate/recording.hpp"
#include "tools/calibrate/surroundings.hpp"
#include "tools/calibrate/waterline.hpp"

namespace lookout::calibrate {

/// A number with its deviation.
struct Found {
  double value = 0.0;
  double sd = 0.0;
  bool is_found = false;  // the deviation is small enough to use the value
};

/// Deviations above which a number is not told: twice what a boat needs.
inline constexpr double kMaxYawSdDeg = 0.25;
inline constexpr double kMaxTiltSdDeg = 0.4;
inline constexpr double kMaxLatencySdS = 0.010;

/// Motions of the boat in the recording.
struct Manoeuvres {
  double seconds = 0.0;
  double turned_rad = 0.0;  // between the two headings farthest apart, not wrapped: two full circles are 4 pi
  double way_m = 0.0;
  double turn_changes_radps = 0.0;  // root mean square of the rate of turn about its mean
  double share_in_sight = 0.0;      // of the scans whose motion LIDAR_ODOMETRY would know
};

struct Calibration {
  /// Why no result is told, in words; empty where the result counts.
  std::string refusal;
  bool is_only_weak = false;         // refused only for too large deviations: each angle still counts, with its own deviation
  std::vector<std::string> missing;  // motions that would help, in words
  Manoeuvres manoeuvres;
  std::string turned_in_words;  // how the lidar is turned by right angles against boat.txtpb; empty where it is not

  // Meaningful where has_fit.
  bool has_fit = false;
  Assumed found;  // the mounting and latency that were found
  Angles angles;
  Found roll;  // rad
  Found pitch;
  Found yaw;
  Found latency;  // of heading and position, s
  Found tilt_latency;
  /// The rotation from the mounting of boat.txtpb to the one that was found, about the axes of the vessel (forward, port, up), and its deviations.
  Eigen::Vector3d turned_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d turned_sd_rad = Eigen::Vector3d::Zero();
  std::optional<double> latency_by_turning_s;
  std::optional<WaterHeight> height;
  Eigen::Vector3d boat_place_m = Eigen::Vector3d::Zero();  // of the lidar, by boat.txtpb
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();       // where the fit places the lidar, relative to boat_place_m
  // Disagreement of pairs of scans, root mean square, with boat.txtpb and with the result.
  std::size_t num_pairs = 0;
  double before_m = 0.0;
  double before_rad = 0.0;
  double after_m = 0.0;
  double after_rad = 0.0;

  // Inputs of the last fit, for checks by other programs.
  std::vector<RelativeMotion> motions;
  std::vector<Matrix6> weights;   // [motions]
  Correction motions_correction;  // of the mounting with which the motions were measured
  Eigen::Matrix3d motions_R_vessel_lidar = Eigen::Matrix3d::Identity();

  bool IsRefused() const { return !refusal.empty(); }
};

struct CalibrationParams {
  config::BoatFacts boat;
  odometer::OdometerParams odometer;
};

/// @param tell  is told which step is done; may be empty
Calibration Calibrate(const Recording& recording, const CalibrationParams& params, const std::function<void(const std::string&)>& tell = {});

}  // namespace lookout::calibrate
