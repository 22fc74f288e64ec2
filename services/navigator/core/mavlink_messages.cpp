#include "services/navigator/core/mavlink_messages.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "common/core/angles.hpp"
#include "common/core/bytes.hpp"
#include "common/core/elementary.hpp"
#include "services/navigator/core/mavlink_lines.hpp"

namespace lookout::navigator {

namespace {

// Bounds of possible values, as in nmea.cpp.
constexpr double kMaxSpeedMps = 100.0;
constexpr double kMinHeightM = -1000.0;
constexpr double kMaxHeightM = 20'000.0;
constexpr double kMaxGeoidSeparationM = 150.0;
constexpr double kMaxRateRadps = 100.0;
constexpr double kMaxHdop = 100.0;
constexpr double kMinHdop = 0.35;
constexpr double kMaxSdM = 1e6;
// Pi as a single-precision number is greater than pi.
constexpr double kRoundingRad = 1e-6;

constexpr double kDegPerE7 = 1e-7;
constexpr double kMPerMm = 1e-3;
constexpr double kMpsPerCmps = 1e-2;

// Fields by their place in the payload. Source: MAVLink, common.xml; the fields of a message stand in the order of their sizes, the greatest first,
// then extensions in the order in which they were added.
class Payload {
 public:
  explicit Payload(std::string_view payload) {
    for (std::size_t i = 0; i < payload.size(); ++i) bytes_[i] = static_cast<std::uint8_t>(payload[i]);
  }
  int Byte(std::size_t offset) const { return bytes_[offset]; }
  int Unsigned16(std::size_t offset) const { return ReadU16LittleEndian(bytes_, offset); }
  int Signed16(std::size_t offset) const { return static_cast<std::int16_t>(ReadU16LittleEndian(bytes_, offset)); }
  std::uint32_t Unsigned32(std::size_t offset) const { return ReadU32LittleEndian(bytes_, offset); }
  std::int32_t Signed32(std::size_t offset) const { return static_cast<std::int32_t>(ReadU32LittleEndian(bytes_, offset)); }
  double Float(std::size_t offset) const { return std::bit_cast<float>(ReadU32LittleEndian(bytes_, offset)); }

 private:
  std::array<std::uint8_t, kMaxMavlinkPayloadBytes> bytes_{};  // zeros at the end are not sent
};

bool IsWithin(double value, double most) { return std::abs(value) <= most; }  // not for NaN

// ATTITUDE: time_boot_ms 0, roll 4, pitch 8, yaw 12, their rates 16, 20, 24. Aeronautical axes: roll positive starboard down, pitch positive bow up,
// yaw clockwise from north, its rate positive when the bow turns to starboard.
bool ReadAttitude(const Payload& payload, Sentence& sentence) {
  sentence.type = SentenceType::kMavAttitude;
  sentence.time_boot_ms = payload.Unsigned32(0);
  sentence.roll_rad = payload.Float(4);
  sentence.pitch_rad = payload.Float(8);
  const double yaw_rad = payload.Float(12);
  sentence.turn_rate_radps = payload.Float(24);
  if (!IsWithin(sentence.roll_rad, kPi + kRoundingRad) || !IsWithin(sentence.pitch_rad, kPi / 2 + kRoundingRad)) return false;
  if (!IsWithin(yaw_rad, 2 * kPi + kRoundingRad) || !IsWithin(sentence.turn_rate_radps, kMaxRateRadps)) return false;
  sentence.heading_rad = WrapTo2Pi(yaw_rad);
  return true;
}

// GLOBAL_POSITION_INT: time_boot_ms 0, latitude 4, longitude 8, height above sea 12 (mm), above home 16, velocity north 20, east 22, down 24 (cm/s),
// heading 26 (repeats ATTITUDE's).
bool ReadPosition(const Payload& payload, Sentence& sentence) {
  sentence.type = SentenceType::kMavPosition;
  sentence.time_boot_ms = payload.Unsigned32(0);
  const GeodeticPlace place{payload.Signed32(4) * kDegPerE7, payload.Signed32(8) * kDegPerE7};
  sentence.position = place;
  sentence.msl_height_m = payload.Signed32(12) * kMPerMm;
  const double north_mps = payload.Signed16(20) * kMpsPerCmps;
  const double east_mps = payload.Signed16(22) * kMpsPerCmps;
  sentence.speed_mps = Hypot(north_mps, east_mps);
  if (sentence.speed_mps > 0.0) sentence.course_rad = WrapTo2Pi(Atan2(east_mps, north_mps));
  return IsWithin(place.latitude_deg, 90.0) && IsWithin(place.longitude_deg, 180.0) && sentence.speed_mps <= kMaxSpeedMps &&
         sentence.msl_height_m >= kMinHeightM && sentence.msl_height_m <= kMaxHeightM;
}

// GPS_FIX_TYPE. 2 has no height and is of three satellites; 7 (static) is of a base station.
FixQuality QualityOf(int fix_type) {
  switch (fix_type) {
    case 3:
    case 8:  // precise point positioning
      return FixQuality::kGnss;
    case 4:
      return FixQuality::kDifferential;
    case 5:
      return FixQuality::kRtkFloat;
    case 6:
      return FixQuality::kRtkFixed;
    default:
      return FixQuality::kNone;
  }
}

// 0 and values beyond any receiver's say nothing.
double KnownSdM(std::uint32_t sd_mm) { return sd_mm > 0 && sd_mm * kMPerMm <= kMaxSdM ? sd_mm * kMPerMm : kNan; }

// GPS_RAW_INT: height above sea 16 (mm), HDOP 20 (hundredths), fix 28, satellites 29; extensions: height above the ellipsoid 30, accuracies of place
// 34, height 38 and speed 42 (mm, mm/s), of heading 46 (1e-5 deg), heading by two antennas 50 (0.01 deg, 0 = none, 65535 = not now).
bool ReadGps(const Payload& payload, Sentence& sentence) {
  constexpr int kUnknownSatellites = 255;
  constexpr int kNoHeadingNow = 65535;
  constexpr double kDegPerE5 = 1e-5;
  sentence.type = SentenceType::kMavGps;
  sentence.quality = QualityOf(payload.Byte(28));
  const int num_satellites = payload.Byte(29);
  if (num_satellites != kUnknownSatellites) sentence.num_satellites = num_satellites;
  const double hdop = payload.Unsigned16(20) / 100.0;
  if (hdop >= kMinHdop && hdop <= kMaxHdop) sentence.hdop = hdop;
  const double separation_m = (static_cast<double>(payload.Signed32(30)) - payload.Signed32(16)) * kMPerMm;
  // Without the extension the height above the ellipsoid is 0: such a separation tells nothing.
  if (payload.Signed32(30) != 0 && IsWithin(separation_m, kMaxGeoidSeparationM)) sentence.geoid_separation_m = separation_m;
  sentence.horizontal_sd_m = KnownSdM(payload.Unsigned32(34));
  sentence.vertical_sd_m = KnownSdM(payload.Unsigned32(38));
  sentence.velocity_sd_mps = KnownSdM(payload.Unsigned32(42));
  // Without two antennas it is the accuracy of the course.
  const int antennas_heading_cdeg = payload.Unsigned16(50);
  const double heading_sd_rad = DegToRad(payload.Unsigned32(46) * kDegPerE5);
  const bool has_two_antennas = antennas_heading_cdeg != 0 && antennas_heading_cdeg != kNoHeadingNow;
  if (has_two_antennas && heading_sd_rad > 0.0 && heading_sd_rad <= kPi) sentence.heading_sd_rad = heading_sd_rad;
  return true;
}

}  // namespace

ParseResult ParseMavlinkLine(std::string_view line) {
  if (const auto fault = Frame(line).fault; fault != SentenceFault::kNone) return {fault, {}};
  const auto bytes = MavlinkBytesOf(line);
  if (!bytes) return {SentenceFault::kBadField, {}};
  const auto [verdict, frame] = LookForMavlink(*bytes, kMavlinkKinds);
  if (verdict == MavlinkLook::Verdict::kBadChecksum) return {SentenceFault::kBadChecksum, {}};
  if (verdict != MavlinkLook::Verdict::kFrame || frame.bytes.size() != bytes->size()) return {SentenceFault::kBadField, {}};
  ParseResult result;
  result.sentence.name = kMavlinkAddress;
  const Payload payload(frame.payload);
  const auto read = frame.id == kMavlinkAttitude ? ReadAttitude : frame.id == kMavlinkGlobalPositionInt ? ReadPosition : ReadGps;
  if (!read(payload, result.sentence)) return {SentenceFault::kImplausible, {}};
  return result;
}

}  // namespace lookout::navigator
