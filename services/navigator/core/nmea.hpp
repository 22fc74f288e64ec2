// The sentences that navigator understands. What a sentence does not say is NaN, nullopt, or -1 in counts; angles in radians.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <optional>
#include <string_view>
#include <variant>

#include "services/navigator/core/field_reader.hpp"
#include "services/navigator/core/sentence.hpp"

namespace lookout::navigator {

/// Of a fix, as in GGA (the numbers of gnss_fix_t).
enum class FixQuality {
  kNone = 0,
  kGnss = 1,
  kDifferential = 2,
  kPps = 3,
  kRtkFixed = 4,
  kRtkFloat = 5,
  kDeadReckoning = 6,
  kManual = 7,
  kSimulator = 8,
};

/// @return whether a receiver measured it; not "no fix", put in by hand, or simulated
bool IsMeasured(FixQuality quality);

/// Three numbers that were not said.
inline const Eigen::Vector3d kUnknownVector = Eigen::Vector3d::Constant(kNan);

/// RMC: time,status,latitude,N,longitude,E,knots,course,date,variation,E[,mode[,navigational status]]
struct Rmc {
  std::optional<std::chrono::microseconds> time_of_day;
  std::optional<std::chrono::sys_days> date;
  FixQuality quality = FixQuality::kNone;
  std::optional<GeodeticPosition> position;
  double speed_mps = kNan;
  double course_rad = kNan;
  double declination_rad = kNan;  // magnetic variation, positive east
};

/// GGA: time,latitude,N,longitude,E,quality,satellites,HDOP,height,M,geoid separation,M,age,station
/// One that is too short (Saab's R4 leaves a field out) is taken for what it holds: position, quality and HDOP, and a height that stands with its
/// unit. Where satellites, HDOP or height are missing these are not known, and the fix counts as one without correction.
struct Gga {
  std::optional<std::chrono::microseconds> time_of_day;
  FixQuality quality = FixQuality::kNone;
  std::optional<GeodeticPosition> position;
  int num_satellites = -1;
  double hdop = kNan;
  double msl_height_m = kNan;
  double geoid_separation_m = kNan;
};

/// GNS: time,latitude,N,longitude,E,modes (a letter per system),satellites,HDOP,height,geoid separation,age,station[,navigational status]
/// Source: gpsd's "NMEA Revealed", GNS. The quality is the best that a system has: the fix is made of all of them.
struct Gns : Gga {};

/// VTG: course,T,magnetic course,M,knots,N,km/h,K[,mode]
struct Vtg {
  double speed_mps = kNan;
  double course_rad = kNan;
};

/// HDT: heading,T
struct Hdt {
  double heading_rad = kNan;
};

/// PASHR: time,heading,T,roll,pitch,heave,roll sd,pitch sd,heading sd,GNSS quality[,INS status]
/// Fields: Trimble, NMEA-0183 message PASHR (help.fieldsystems.trimble.com); NovAtel OEM7, PASHR. Signs: roll positive port side up, that is
/// starboard down; pitch positive bow up (Kongsberg Seapath, PSXN,23: "positive with port side up", "positive with bow up"; the crate
/// nmea-kit 0.5.6, pashr.rs: "negative = port", "negative = bow down"). GNSS quality and INS status mean different things by maker (INS status 0 is
/// "GPS only" with Trimble, "IMU out" with Applanix) and are checked but not used.
struct Pashr {
  std::optional<std::chrono::microseconds> time_of_day;
  double heading_rad = kNan;
  double roll_rad = kNan;
  double pitch_rad = kNan;
  double heave_m = kNan;
  double roll_sd_rad = kNan;
  double pitch_sd_rad = kNan;
  double heading_sd_rad = kNan;
};

/// GST: time,rms,sd of the major axis,of the minor axis,direction,sd of latitude,of longitude,of height
struct Gst {
  std::optional<std::chrono::microseconds> time_of_day;
  double north_sd_m = kNan;
  double east_sd_m = kNan;
  double height_sd_m = kNan;
};

/// GLL: latitude,N,longitude,E[,time,status[,mode]]
struct Gll {
  std::optional<std::chrono::microseconds> time_of_day;
  FixQuality quality = FixQuality::kNone;
  std::optional<GeodeticPosition> position;
};

/// ZDA: time,day,month,year,zone hours,zone minutes
struct Zda {
  std::optional<std::chrono::microseconds> time_of_day;
  std::optional<std::chrono::sys_days> date;
};

/// HDG: heading of the compass,deviation,E,declination,E. HDM: heading,M
struct MagneticHeading {
  double compass_rad = kNan;
  double deviation_rad = kNan;    // positive east
  double declination_rad = kNan;  // positive east
};

/// ROT: degrees per minute,A
struct Rot {
  double rate_radps = kNan;  // positive when the bow turns to starboard
};

/// PSAT,HPR,time,heading,pitch,roll,type: N = by GNSS, G = by gyro.
/// Source: Hemisphere GNSS Technical Reference Guide, PSAT,HPR. Which way roll and pitch are positive is set in the receiver: see config.
struct PsatHpr {
  std::optional<std::chrono::microseconds> time_of_day;
  double heading_rad = kNan;
  double pitch_rad = kNan;
  double roll_rad = kNan;
};

/// XDR: groups of type,value,unit,name. Taken are A (angular displacement) in D (degrees) by the names PTCH, PITCH (pitch) and ROLL, HEEL (roll),
/// large or small letters, what follows # left out. Sources: NMEA's update to XDR (version 4.11: "Pitch", "Roll", "Heel"); Airmar (PTCH, ROLL); True
/// North (PITCH, ROLL). Which way they are positive: see config; by default pitch bow up, roll starboard down, as Airmar has them.
struct Xdr {
  double pitch_rad = kNan;
  double roll_rad = kNan;
};

/// PTNTHTM: heading,status,pitch,status,roll,status,dip,field, of True North's compasses. A status of C, L, P or V (alarms) voids its angle. Angles
/// are in degrees where one of them has a decimal point, else in turns / 65536. The heading is true where the declination is set in the compass.
/// Source: gpsd, driver_nmea0183.c, its description of the sentence.
struct TntHtm {
  double heading_rad = kNan;
  double pitch_rad = kNan;
  double roll_rad = kNan;
};

/// What a strapdown sensor measures, along its own axes: x forward, y to starboard, z down.
struct StrapdownSample {
  Eigen::Vector3d angular_velocity_radps = kUnknownVector;
  Eigen::Vector3d specific_force_mps2 = kUnknownVector;  // at rest and level z is -9.81
  Eigen::Vector3d magnetic_field_ut = kUnknownVector;    // microtesla
};

/// VNINS: GPS time of week,week,status,yaw,pitch,roll,latitude,longitude,height,velocity north,east,down,sd of attitude,position,velocity.
/// Source: VectorNav VN-300 User Manual UM005, "INS Solution - LLA". Yaw from true north, pitch positive bow up, roll positive starboard down.
struct VnIns {
  /// Bits 0 and 1 of the status.
  enum class Mode { kNotTracking = 0, kAligning = 1, kTracking = 2, kGnssLost = 3 };

  std::optional<std::chrono::microseconds> time_of_day;  // UTC
  std::optional<std::chrono::sys_days> date;             // UTC
  Mode mode = Mode::kNotTracking;
  bool has_fault = false;  // the filter's time, IMU, magnetometer or GNSS error: bits 3 to 6
  double yaw_rad = kNan;
  double pitch_rad = kNan;
  double roll_rad = kNan;
  std::optional<GeodeticPosition> position;
  double ellipsoid_height_m = kNan;
  Eigen::Vector3d velocity_ned_mps = kUnknownVector;
  double attitude_sd_rad = kNan;
  double position_sd_m = kNan;
  double velocity_sd_mps = kNan;
};

/// VNYMR: yaw,pitch,roll,magnetometer x y z,accelerometer x y z,gyro x y z.
/// Source: VectorNav VN-100 User Manual UM001, "Yaw, Pitch, Roll, Magnetic, Acceleration, and Angular Rates". Signs as VNINS.
struct VnYmr {
  double yaw_rad = kNan;
  double pitch_rad = kNan;
  double roll_rad = kNan;
  StrapdownSample sample;
};

/// VNIMU: magnetometer x y z,accelerometer x y z,gyro x y z,temperature,pressure. Source: VectorNav VN-100 User Manual UM001, "IMU Measurements".
struct VnImu {
  StrapdownSample sample;
};

/// A right sentence of a type that is not used.
struct OtherSentence {};

using Sentence =
    std::variant<OtherSentence, Rmc, Gga, Gns, Xdr, TntHtm, Vtg, Hdt, Pashr, Gst, Gll, Zda, MagneticHeading, Rot, PsatHpr, VnIns, VnYmr, VnImu>;

struct ParseResult {
  SentenceFault fault = SentenceFault::kNone;
  Sentence sentence;  // only when there is no fault
};

/// Whoever the talker is, numbers too; of proprietary sentences PASHR, PSAT,HPR, PTNTHTM, VNINS, VNYMR and VNIMU. THS is given as HDT.
///
/// @param line               from $ or ! to the checksum
/// @param requires_checksum  false: a line without * is taken too; one whose checksum is wrong never is
ParseResult ParseSentence(std::string_view line, bool requires_checksum = true);

}  // namespace lookout::navigator
