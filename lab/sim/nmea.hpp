// NMEA 0183 sentences as receivers and attitude sensors send them, each ended by CR LF.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "common/core/utime.hpp"

namespace lookout::sim {

/// A measurement of a GNSS receiver at its antenna.
struct GnssMeasurement {
  Utime time;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double msl_height_m = 0.0;
  double geoid_separation_m = 0.0;
  double speed_mps = 0.0;
  double course_deg = 0.0;  // from true north, clockwise
  int quality = 0;          // as in GGA; 0 = no fix: then only the time is said
  double sd_m = 0.0;        // of a position per axis, as the receiver states it
};

/// A measurement of an attitude sensor. Signs as in POSE.
struct AttitudeMeasurement {
  Utime time;
  double heading_deg = 0.0;
  double roll_deg = 0.0;   // positive starboard down
  double pitch_deg = 0.0;  // positive bow up
  double heave_m = 0.0;    // positive up
  bool has_rtk = false;    // the receiver that the sensor leans on
};

/// A measurement of an IMU. Axes as VectorNav's: x forward, y starboard, z down.
struct ImuMeasurement {
  Eigen::Vector3d magnetic_gauss;
  Eigen::Vector3d specific_force_mps2;  // at rest -9.8 along z
  Eigen::Vector3d angular_rate_radps;
  double temperature_celsius = 0.0;
  double pressure_kpa = 0.0;
};

/// @param body  between $ and *
std::string Sentence(std::string_view body);

std::string Rmc(const GnssMeasurement& measurement);
std::string Gga(const GnssMeasurement& measurement);
std::string Vtg(const GnssMeasurement& measurement);
/// Pseudorange noise statistics: deviations of latitude, longitude and height, all the same; real heights are worse.
std::string Gst(const GnssMeasurement& measurement);
std::string Zda(Utime time);
std::string Hdt(double heading_deg);
/// @param rate_degpmin  positive when the bow turns to starboard
std::string Rot(double rate_degpmin);
/// $PASHR,time,heading,T,roll,pitch,heave,roll sd,pitch sd,heading sd,GNSS quality,INS status
std::string Pashr(const AttitudeMeasurement& measurement, double tilt_sd_deg, double heading_sd_deg);

/// $VNIMU of VectorNav's VN-100 (User Manual UM001, register 54 as ASCII): magnetic field x y z (Gauss), specific force x y z (m/s2), rate x y z
/// (rad/s), temperature, pressure. Not corrected by its own filter. It has the checksum of NMEA 0183 and no time.
std::string VnImu(const ImuMeasurement& measurement);

}  // namespace lookout::sim
