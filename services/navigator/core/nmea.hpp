// The sentences that navigator understands. What a sentence does not say is NaN, nullopt, or -1 in counts; angles in radians.
#pragma once

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

/// RMC: time,status,latitude,N,longitude,E,knots,course,date,variation,E[,mode[,navigational status]]
struct Rmc {
  std::optional<std::chrono::microseconds> time_of_day;
  std::optional<std::chrono::sys_days> date;
  FixQuality quality = FixQuality::kNone;
  std::optional<GeodeticPosition> position;
  double speed_mps = kNan;
  double course_rad = kNan;
};

/// GGA: time,latitude,N,longitude,E,quality,satellites,HDOP,height,M,geoid separation,M,age,station
struct Gga {
  std::optional<std::chrono::microseconds> time_of_day;
  FixQuality quality = FixQuality::kNone;
  std::optional<GeodeticPosition> position;
  int num_satellites = -1;
  double hdop = kNan;
  double msl_height_m = kNan;
  double geoid_separation_m = kNan;
};

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

/// A right sentence of a type that is not used.
struct OtherSentence {};

using Sentence = std::variant<OtherSentence, Rmc, Gga, Vtg, Hdt, Pashr>;

struct ParseResult {
  SentenceFault fault = SentenceFault::kNone;
  Sentence sentence;  // only when there is no fault
};

/// Whoever the talker is, numbers too; of proprietary sentences PASHR alone.
///
/// @param line  from $ or ! to the checksum
ParseResult ParseSentence(std::string_view line);

}  // namespace lookout::navigator
