// What each kind of measurement tells the state, and what is done when it contradicts it.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "services/navigator/core/filter/motion.hpp"
#include "services/navigator/core/filter/params.hpp"
#include "services/navigator/core/filter/state.hpp"

namespace lookout::navigator::filter {

/// Velocity of the antenna over ground, against east and north where the boat is.
struct VelocityMeasurement {
  Eigen::Vector2d east_north_mps = Eigen::Vector2d::Zero();
  double sd_mps = 0.0;  // per axis
  double course_rad = kNan;
  double speed_mps = 0.0;
  bool has_own_time = false;  // else it counts as measured when it came
};

/// All that a receiver says of one epoch.
struct FixMeasurement {
  std::string source;
  bool is_gga = false;
  bool begins_time_scale = false;  // as in GnssFix: it says where the boat is, whatever was known
  GeodeticPlace antenna;           // where the height is not said, that of the datum
  bool has_height = false;
  double horizontal_sd_m = 0.0;  // per axis
  double vertical_sd_m = 0.0;
  std::optional<VelocityMeasurement> velocity;
};

/// Of the vessel frame, against north and up where the boat is; NaN = not said.
struct AttitudeMeasurement {
  double heading_rad = kNan;
  double heading_sd_rad = 0.0;
  double roll_rad = kNan;
  double pitch_rad = kNan;
  double roll_sd_rad = 0.0;
  double pitch_sd_rad = 0.0;
  double heave_m = kNan;

  bool has_tilt() const { return !std::isnan(roll_rad) && !std::isnan(pitch_rad); }
};

/// What became of the numbers of a measurement.
struct Verdict {
  std::int64_t num_taken = 0;
  std::int64_t num_gated = 0;    // contradict the state by more than chance
  std::int64_t num_renewed = 0;  // contradicted it for so long, and so evenly, that the state was given up
  // Of those that were judged: sum of normalised innovations squared, and of their degrees of freedom.
  double nis_sum = 0.0;
  std::int64_t num_degrees = 0;
};

/// Each precondition: the state has been carried on to the time of the measurement.
void Apply(const FixMeasurement& fix, const FilterParams& params, State& state, Verdict& verdict);
void Apply(const VelocityMeasurement& velocity, const FilterParams& params, State& state, Verdict& verdict);
void Apply(const AttitudeMeasurement& attitude, const FilterParams& params, State& state, Verdict& verdict);

/// Gravity as the IMU feels it: levels the attitude while accelerometers do not carry the motion.
void Apply(const InertialSample& sample, State& state);

/// The vessel floats: its up is that of the water, in the mean. At most once a second.
void ApplyWater(State& state);

}  // namespace lookout::navigator::filter
