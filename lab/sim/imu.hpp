// A strap-down IMU of the industrial MEMS class at the boat's reference point: x forward, y starboard, z down.
#pragma once

#include <array>

#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "lab/sim/motion.hpp"
#include "lab/sim/nmea.hpp"
#include "lab/sim/random.hpp"

namespace lookout::sim {

/// m/s2 of a thousandth of standard gravity.
inline constexpr double kMilliG = 9.80665e-3;

/// Noise of each axis. Analog Devices ADIS16470, data sheet, page 1 and table 1: gyroscope 0.008 deg/s/sqrt(Hz) and 8 deg/h in-run bias stability,
/// accelerometer 0.037 m/s/sqrt(h) velocity random walk and 13 ug. The bias after a start differs from run to run: 120 deg/h and 1.5 mg, the bias
/// repeatability of Honeywell's HG1125, an IMU of the same class.
struct ImuErrors {
  double gyro_density_radps_rthz = DegToRad(0.008);
  double gyro_start_bias_radps = DegToRad(120.0 / 3600.0);
  double gyro_bias_stability_radps = DegToRad(8.0 / 3600.0);
  double accelerometer_density_mps2_rthz = 0.037 / 60.0;  // 60 = square root of an hour in seconds
  double accelerometer_start_bias_mps2 = 1.5 * kMilliG;
  double accelerometer_bias_stability_mps2 = 0.013 * kMilliG;
  double bias_time_constant_s = 300.0;  // Allan deviations of such devices have their minimum at some hundreds of seconds
};

class Imu {
 public:
  static constexpr std::chrono::milliseconds kPeriod{10};
  /// The first measurement is made so long after the start: it looks back at the motion before.
  static constexpr std::chrono::milliseconds kFirst{20};

  /// @param start  the scene's time 0
  Imu(const OwnMotion& motion, const config::BoatFacts& boat, const ImuErrors& errors, Utime start, std::uint64_t seed);

  /// The mean over the kPeriod before `time`, as a device gives it that samples faster and averages: rates that are integrated give the attitude
  /// exactly, whatever happens between two samples.
  ///
  /// The rate is against the stars: it contains the earth's rate (15 deg/h). Specific force: acceleration minus gravity (WGS84, at the datum); the
  /// Coriolis acceleration (below 0.001 m/s2 at 5 m/s) is not in it. Magnetic field and pressure are the values at the datum, without error.
  ///
  /// @param time  kPeriod after the last one
  ImuMeasurement Measure(Utime time);

  /// Measure without errors.
  ImuMeasurement Truth(Utime time) const;

 private:
  struct Axis {
    double start_bias = 0.0;
    MeasurementError bias;
    double noise_sd = 0.0;
  };
  static Axis MakeAxis(double density, double start_bias, double stability, double time_constant_s, Random& random);
  void AddErrors(std::array<Axis, 3>& axes, Eigen::Vector3d& values);

  OwnMotion motion_;
  double reference_point_above_water_m_;
  Utime start_;
  Eigen::Vector3d gravity_map_mps2_;
  Eigen::Vector3d earth_rate_map_radps_;
  double pressure_kpa_;
  Random random_;
  std::array<Axis, 3> gyro_;
  std::array<Axis, 3> accelerometer_;
};

}  // namespace lookout::sim
