// NMEA 0183 sentences as receivers and attitude sensors send them, each ended by CR LF.
#pragma once

#include <string>
#include <string_view>

#include "common/core/utime.hpp"

namespace lookout::sim {

/// What a GNSS receiver measured at its antenna.
struct GnssMeasurement {
  Utime time;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double msl_height_m = 0.0;
  double geoid_separation_m = 0.0;
  double speed_mps = 0.0;
  double course_deg = 0.0;  // from true north, clockwise
  int quality = 0;          // as in GGA
};

/// What an attitude sensor measured. Signs as in POSE.
struct AttitudeMeasurement {
  Utime time;
  double heading_deg = 0.0;
  double roll_deg = 0.0;   // positive starboard down
  double pitch_deg = 0.0;  // positive bow up
  double heave_m = 0.0;    // positive up
};

/// @param body  between $ and *
std::string Sentence(std::string_view body);

std::string Rmc(const GnssMeasurement& measurement);
std::string Gga(const GnssMeasurement& measurement);
std::string Vtg(const GnssMeasurement& measurement);
std::string Hdt(double heading_deg);
/// $PASHR,time,heading,T,roll,pitch,heave,roll sd,pitch sd,heading sd,GNSS quality,INS status
std::string Pashr(const AttitudeMeasurement& measurement, double tilt_sd_deg, double heading_sd_deg);

}  // namespace lookout::sim
