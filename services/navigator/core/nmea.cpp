#include "services/navigator/core/nmea.hpp"

#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::navigator {

namespace {

constexpr double kMpsPerKnot = 1852.0 / 3600.0;
constexpr double kMpsPerKmh = 1.0 / 3.6;

// Bounds of what can be. Receivers on boats: 100 m/s is 194 knots.
constexpr double kMaxSpeedMps = 100.0;
constexpr double kMaxHdop = 100.0;       // receivers send 99.99 for "no fix"
constexpr double kMinHeightM = -1000.0;  // the Dead Sea lies at -430 m
constexpr double kMaxHeightM = 20000.0;
constexpr double kMaxGeoidSeparationM = 150.0;  // EGM2008: -107 m to +86 m
constexpr double kMaxHeaveM = 50.0;
constexpr int kMaxSatellites = 99;

double AngleRad(FieldReader& fields, std::size_t index, double min_deg, double max_deg) { return DegToRad(fields.Number(index, min_deg, max_deg)); }

// 360 is 0. What is not said stays so: WrapTo2Pi would make 0 of it.
double WrapKnown(double angle_rad) { return std::isnan(angle_rad) ? kNan : WrapTo2Pi(angle_rad); }

double CompassRad(FieldReader& fields, std::size_t index) { return WrapKnown(AngleRad(fields, index, 0.0, 360.0)); }

// Degrees, and behind them T, which must stand there when they do.
double TrueCompassRad(FieldReader& fields, std::size_t index) { return WrapKnown(DegToRad(fields.NumberWithUnit(index, 'T', 0.0, 360.0))); }

// Mode letters of NMEA 0183 2.3 and later, in the numbers of GGA. P (precise) is given when no deliberate degradation is used.
FixQuality QualityOfMode(char mode) {
  switch (mode) {
    case 'A':
      return FixQuality::kGnss;
    case 'D':
      return FixQuality::kDifferential;
    case 'P':
      return FixQuality::kPps;
    case 'R':
      return FixQuality::kRtkFixed;
    case 'F':
      return FixQuality::kRtkFloat;
    case 'E':
      return FixQuality::kDeadReckoning;
    case 'M':
      return FixQuality::kManual;
    case 'S':
      return FixQuality::kSimulator;
    default:
      return FixQuality::kNone;
  }
}

constexpr std::string_view kModeLetters = "ADPRFEMSN";

Rmc ReadRmc(FieldReader& fields, std::size_t num_fields) {
  Rmc rmc;
  rmc.time_of_day = fields.TimeOfDay(0);
  const char status = fields.Letter(1, "AV");
  rmc.position = fields.Position(2);
  rmc.speed_mps = fields.Number(6, 0.0, kMaxSpeedMps / kMpsPerKnot) * kMpsPerKnot;
  rmc.course_rad = CompassRad(fields, 7);
  rmc.date = fields.Date(8);
  fields.IsEmpty(10);  // variation is not used, but must be there
  const char mode = num_fields > 11 ? fields.Letter(11, kModeLetters) : '\0';
  // The navigational status of NMEA 4.1 behind the mode is V in receivers that give no such status, whatever the fix (u-blox ZED-F9P).
  if (status == 'A') rmc.quality = mode == '\0' ? FixQuality::kGnss : QualityOfMode(mode);
  return rmc;
}

Gga ReadGga(FieldReader& fields) {
  // NovAtel: 9 = SBAS, which is a differential correction.
  constexpr int kNovatelSbas = 9;
  Gga gga;
  gga.time_of_day = fields.TimeOfDay(0);
  gga.position = fields.Position(1);
  const int quality = fields.Count(5, kNovatelSbas);
  gga.quality = quality == kNovatelSbas ? FixQuality::kDifferential : static_cast<FixQuality>(quality < 0 ? 0 : quality);
  gga.num_satellites = fields.Count(6, kMaxSatellites);
  gga.hdop = fields.Number(7, 0.0, kMaxHdop);
  gga.msl_height_m = fields.NumberWithUnit(8, 'M', kMinHeightM, kMaxHeightM);
  gga.geoid_separation_m = fields.NumberWithUnit(10, 'M', -kMaxGeoidSeparationM, kMaxGeoidSeparationM);
  fields.IsEmpty(13);  // age and station of the correction are not used, but must be there
  return gga;
}

Vtg ReadVtg(FieldReader& fields, std::size_t num_fields) {
  Vtg vtg;
  vtg.course_rad = TrueCompassRad(fields, 0);
  const double knots_mps = fields.NumberWithUnit(4, 'N', 0.0, kMaxSpeedMps / kMpsPerKnot) * kMpsPerKnot;
  const double kmh_mps = fields.NumberWithUnit(6, 'K', 0.0, kMaxSpeedMps / kMpsPerKmh) * kMpsPerKmh;
  vtg.speed_mps = std::isnan(knots_mps) ? kmh_mps : knots_mps;
  const char mode = num_fields > 8 ? fields.Letter(8, kModeLetters) : '\0';
  if (mode != '\0' && !IsMeasured(QualityOfMode(mode))) return {};
  return vtg;
}

Hdt ReadHdt(FieldReader& fields) { return {TrueCompassRad(fields, 0)}; }

Pashr ReadPashr(FieldReader& fields) {
  Pashr pashr;
  pashr.time_of_day = fields.TimeOfDay(0);
  pashr.heading_rad = TrueCompassRad(fields, 1);
  pashr.roll_rad = AngleRad(fields, 3, -180.0, 180.0);
  pashr.pitch_rad = AngleRad(fields, 4, -90.0, 90.0);
  pashr.heave_m = fields.Number(5, -kMaxHeaveM, kMaxHeaveM);
  pashr.roll_sd_rad = AngleRad(fields, 6, 0.0, 180.0);
  pashr.pitch_sd_rad = AngleRad(fields, 7, 0.0, 180.0);
  pashr.heading_sd_rad = AngleRad(fields, 8, 0.0, 180.0);
  fields.Count(9, 9);
  return pashr;
}

Sentence Read(std::string_view type, FieldReader& fields, std::size_t num_fields) {
  if (type == "RMC") return ReadRmc(fields, num_fields);
  if (type == "GGA") return ReadGga(fields);
  if (type == "VTG") return ReadVtg(fields, num_fields);
  if (type == "HDT") return ReadHdt(fields);
  if (type == "PASHR") return ReadPashr(fields);
  return OtherSentence{};
}

// The type without its talker. Proprietary addresses begin with P and have none.
std::string_view TypeOf(const FramedSentence& sentence) {
  constexpr std::size_t kTalkerCharacters = 2;
  constexpr std::size_t kTypeCharacters = 3;
  const auto address = sentence.address;
  if (address.starts_with('P')) {
    // Ashtech's own sentences have a word in place of the time: $PASHR,POS,...
    const bool has_word = !sentence.fields.empty() && !sentence.fields.front().empty() && sentence.fields.front().front() >= 'A';
    return address == "PASHR" && !has_word ? address : std::string_view{};
  }
  return address.size() == kTalkerCharacters + kTypeCharacters ? address.substr(kTalkerCharacters) : std::string_view{};
}

}  // namespace

bool IsMeasured(FixQuality quality) { return quality >= FixQuality::kGnss && quality <= FixQuality::kDeadReckoning; }

ParseResult ParseSentence(std::string_view line) {
  const auto framed = Frame(line);
  if (framed.fault != SentenceFault::kNone) return {framed.fault, {}};
  FieldReader fields(framed.sentence.fields);
  ParseResult result;
  result.sentence = line.front() == '$' ? Read(TypeOf(framed.sentence), fields, framed.sentence.fields.size()) : OtherSentence{};
  result.fault = fields.fault();
  return result;
}

}  // namespace lookout::navigator
