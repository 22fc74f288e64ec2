// The values of the sentences that navigator understands. A missing value is NaN, nullopt, or -1 in counts; angles are in radians.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "common/core/sentence.hpp"
#include "services/navigator/core/lines.hpp"

namespace lookout::navigator {

/// Quality of a fix, as in GGA (the numbers of gnss_fix_t).
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

/// Position, velocity and their quality, as far as sentences say them.
struct FixValues {
  FixQuality quality = FixQuality::kNone;
  int num_satellites = -1;
  double hdop = kNan;
  double horizontal_sd_m = kNan;  // one standard deviation per axis
  double vertical_sd_m = kNan;    // only where the receiver says it
  std::optional<GeodeticPlace> position;
  double msl_height_m = kNan;
  double geoid_separation_m = kNan;
  double direct_ellipsoid_height_m = kNan;  // of receivers that state the ellipsoid height itself
  double speed_mps = kNan;
  double course_rad = kNan;
  double velocity_sd_mps = kNan;  // per axis, only where the receiver states it

  /// Above the WGS84 ellipsoid, said so or as height above the geoid with its separation; NaN when neither is said.
  double EllipsoidHeightM() const { return std::isnan(direct_ellipsoid_height_m) ? msl_height_m + geoid_separation_m : direct_ellipsoid_height_m; }
};

/// Heading clockwise from north, pitch, roll, heave and their standard deviations.
struct AttitudeValues {
  double heading_rad = kNan;  // 0 to 2 pi; a sentence of SentenceType::kMagnetic: of the compass, else from true north
  double pitch_rad = kNan;    // -pi to pi
  double roll_rad = kNan;     // -pi to pi
  double heave_m = kNan;      // positive up
  double heading_sd_rad = kNan;
  double pitch_sd_rad = kNan;
  double roll_sd_rad = kNan;

  bool has_tilt() const { return !std::isnan(roll_rad) && !std::isnan(pitch_rad); }
};

/// Values of a strapdown sensor, along its own axes: x forward, y to starboard, z down.
struct StrapdownSample {
  Eigen::Vector3d angular_velocity_radps = kUnknownVector;
  Eigen::Vector3d specific_force_mps2 = kUnknownVector;  // at rest and level z is -9.81
};

enum class SentenceType {
  kOther,  // a right sentence that is not used
  kRmc,
  kGga,
  kGns,
  kXdr,
  kTntHtm,
  kVtg,
  kHdt,  // THS too
  kPashr,
  kGst,
  kGll,
  kZda,
  kMagnetic,  // HDG, HDM
  kRot,
  kPsatHpr,
  kVnIns,
  kVnYmr,
  kVnImu,
  // Messages of an autopilot (mavlink_messages.hpp).
  kMavAttitude,
  kMavPosition,
  kMavGps,  // fix of the autopilot's receiver: quality and accuracies without a place
};
inline constexpr std::size_t kNumSentenceTypes = static_cast<std::size_t>(SentenceType::kMavGps) + 1;

/// Which sentence says what, in which field, and by which source: at its reader in nmea.cpp.
struct Sentence : FixValues, AttitudeValues {
  SentenceType type = SentenceType::kOther;
  std::string_view name;                                 // as in GNSS_FIX and ATTITUDE: "RMC", "HDT" (THS too), "HDG" (HDM too), "PSAT" ...
  std::optional<std::chrono::microseconds> time_of_day;  // UTC
  std::optional<std::chrono::sys_days> date;             // UTC
  double deviation_rad = kNan;                           // of the compass, positive east
  double declination_rad = kNan;                         // positive east
  double turn_rate_radps = kNan;                         // positive when the bow turns to starboard
  std::optional<StrapdownSample> imu;
  std::optional<std::uint32_t> time_boot_ms;  // of an autopilot: time since it was switched on
};

struct ParseResult {
  SentenceFault fault = SentenceFault::kNone;
  Sentence sentence = {};  // only when there is no fault
};

/// Parses sentences of any talker, also of numbers; of proprietary sentences PASHR, PSAT,HPR, PTNTHTM, VNINS, VNYMR and VNIMU.
///
/// @param line               from $ or ! to the checksum
/// @param requires_checksum  false: a line without * is accepted too, one with a wrong checksum never
ParseResult ParseSentence(std::string_view line, bool requires_checksum = true);

}  // namespace lookout::navigator
