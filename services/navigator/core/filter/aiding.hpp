// The measurement models: each kind of measurement is gated and applied; the state is given up where measurements contradict it for long.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "services/navigator/core/filter/motion.hpp"
#include "services/navigator/core/filter/params.hpp"
#include "services/navigator/core/filter/state.hpp"
#include "services/navigator/core/odometry.hpp"

namespace lookout::navigator::filter {

/// Velocity of the antenna over ground, against east and north where the boat is.
struct VelocityMeasurement {
  Eigen::Vector2d east_north_mps = Eigen::Vector2d::Zero();
  double sd_mps = 0.0;  // per axis
  double course_rad = kNan;
  double speed_mps = 0.0;
  bool has_own_time = false;  // else the velocity counts as measured when it came
};

/// One epoch of a receiver.
struct FixMeasurement {
  std::string source;
  bool is_gga = false;
  bool begins_anew = false;  // this fix alone decides the place: begins_time_scale of GnssFix, or the first fix at a new place (believed_place.hpp)
  GeodeticPlace antenna;     // without a stated height, at the height of the datum
  bool has_height = false;
  double horizontal_sd_m = 0.0;  // per axis
  double vertical_sd_m = 0.0;
  std::optional<VelocityMeasurement> velocity{};
};

/// Results of gating.
struct GateCounts {
  std::int64_t num_gated = 0;    // measurements that contradict the state by more than chance
  std::int64_t num_renewed = 0;  // measurements that contradicted the state for so long, and so evenly, that the state was given up
  // Of gated measurements: sum of normalised innovations squared, and of their degrees of freedom.
  double nis_sum = 0.0;
  std::int64_t num_degrees = 0;
};

/// Each precondition: the state has been propagated to the time of the measurement.
void Apply(const FixMeasurement& fix, const FilterParams& params, State& state, GateCounts& counts);
void Apply(const VelocityMeasurement& velocity, const FilterParams& params, State& state, GateCounts& counts);
/// @param attitude  with standard deviations of all that it says
void Apply(const AttitudeValues& attitude, const FilterParams& params, State& state, GateCounts& counts);

/// Own motion by the lidar, from the place of the last scan: it corrects what the state has done since then, and never places the boat by itself. The
/// place of this scan, to which the state has been propagated, is kept for the next motion, also where this one is unknown.
void Apply(const OdometryMotion& motion, const FilterParams& params, State& state, GateCounts& counts);

/// Gravity as the IMU feels it: levels the attitude while accelerometers do not propagate the velocity.
void Apply(const ImuSample& sample, const FilterParams& params, State& state, GateCounts& counts);

/// Time has come so far. The vessel floats: on average its height is the water's. At most once a second.
struct Tick {};
void Apply(const Tick& tick, const FilterParams& params, State& state, GateCounts& counts);

}  // namespace lookout::navigator::filter
