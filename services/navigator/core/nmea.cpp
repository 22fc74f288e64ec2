#include "services/navigator/core/nmea.hpp"

#include <cmath>
#include <string>

#include "common/core/angles.hpp"
#include "services/navigator/core/bounds.hpp"
#include "services/navigator/core/vectornav.hpp"

namespace lookout::navigator {

namespace {

constexpr double kMpsPerKnot = 1852.0 / 3600.0;
constexpr double kMpsPerKmh = 1.0 / 3.6;

// Bounds of what can be.
constexpr double kMaxHdop = 100.0;              // receivers send 99.99 for "no fix"
constexpr double kMaxGeoidSeparationM = 150.0;  // EGM2008: -107 m to +86 m
constexpr double kMaxHeaveM = 50.0;
constexpr int kMaxSatellites = 99;
constexpr double kMaxTurnDegpmin = 36000.0;  // 100 turns a minute

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
  fields.IsEmpty(10);
  // The declination is a by-product: where it is not in order, the fix is not refused for it.
  FieldReader declination = fields;
  rmc.declination_rad = DegToRad(declination.NumberWithSide(9, 180.0));
  if (declination.fault() != SentenceFault::kNone) rmc.declination_rad = kNan;
  const char mode = num_fields > 11 ? fields.Letter(11, kModeLetters) : '\0';
  // The navigational status of NMEA 4.1 behind the mode is V in receivers that give no such status, whatever the fix (u-blox ZED-F9P).
  if (status == 'A') rmc.quality = mode == '\0' ? FixQuality::kGnss : QualityOfMode(mode);
  return rmc;
}

// Of a sentence that is too short: a number that does not stand with its unit says nothing.
double NumberWithUnitOrNan(const FieldReader& fields, std::size_t index, double min, double max) {
  FieldReader reader = fields;
  const double number = reader.NumberWithUnit(index, 'M', min, max);
  return reader.fault() == SentenceFault::kNone ? number : kNan;
}

// A single digit, of which only the position counts: whatever it says, no better than a plain fix.
FixQuality ModestQuality(FieldReader& fields, std::size_t index) {
  const auto quality = fields.Text(index);
  if (quality.size() != 1) fields.Letter(index, {});  // a fault: two digits are satellites
  return quality.size() == 1 && std::string_view("123459").find(quality) != std::string_view::npos ? FixQuality::kGnss : FixQuality::kNone;
}

Gga ReadGga(FieldReader& fields, std::size_t num_fields) {
  // NovAtel: 9 = SBAS, which is a differential correction.
  constexpr int kNovatelSbas = 9;
  Gga gga;
  gga.time_of_day = fields.TimeOfDay(0);
  gga.position = fields.Position(1);
  constexpr std::size_t kNumFields = 14;
  if (num_fields > 8 && num_fields < kNumFields && fields.Text(8) == "M") {
    // The unit of the height one place too early: satellites, HDOP or height are missing, and which of them cannot be told.
    gga.quality = ModestQuality(fields, 5);
    return gga;
  }
  const int quality = fields.Count(5, kNovatelSbas);
  gga.quality = quality == kNovatelSbas ? FixQuality::kDifferential : static_cast<FixQuality>(quality < 0 ? 0 : quality);
  gga.num_satellites = fields.Count(6, kMaxSatellites);
  gga.hdop = fields.Number(7, 0.0, kMaxHdop);
  if (num_fields < kNumFields) {
    gga.msl_height_m = NumberWithUnitOrNan(fields, 8, kMinHeightM, kMaxHeightM);
    gga.geoid_separation_m = NumberWithUnitOrNan(fields, 10, -kMaxGeoidSeparationM, kMaxGeoidSeparationM);
    return gga;
  }
  gga.msl_height_m = fields.NumberWithUnit(8, 'M', kMinHeightM, kMaxHeightM);
  gga.geoid_separation_m = fields.NumberWithUnit(10, 'M', -kMaxGeoidSeparationM, kMaxGeoidSeparationM);
  fields.IsEmpty(13);  // age and station of the correction are not used, but must be there
  return gga;
}

// Of all systems the best, in the order of what they are worth.
FixQuality QualityOfModes(FieldReader& fields, std::size_t index) {
  constexpr std::string_view kBestFirst = "RFDPAEMS";
  const auto modes = fields.Text(index);
  constexpr std::size_t kMaxSystems = 8;
  if (modes.size() > kMaxSystems || modes.find_first_not_of(kModeLetters) != std::string_view::npos) {
    fields.Letter(index, {});  // a fault
    return FixQuality::kNone;
  }
  const auto best = kBestFirst.find_first_of(modes);
  return best == std::string_view::npos ? FixQuality::kNone : QualityOfMode(kBestFirst[best]);
}

Gns ReadGns(FieldReader& fields) {
  Gns gns;
  gns.time_of_day = fields.TimeOfDay(0);
  gns.position = fields.Position(1);
  gns.quality = QualityOfModes(fields, 5);
  gns.num_satellites = fields.Count(6, kMaxSatellites);
  gns.hdop = fields.Number(7, 0.0, kMaxHdop);
  gns.msl_height_m = fields.Number(8, kMinHeightM, kMaxHeightM);
  gns.geoid_separation_m = fields.Number(9, -kMaxGeoidSeparationM, kMaxGeoidSeparationM);
  fields.IsEmpty(11);  // age and station of the correction are not used, but must be there
  return gns;
}

std::string UpperName(std::string_view name) {
  std::string upper;
  for (const char character : name.substr(0, name.find('#'))) {
    upper.push_back(character >= 'a' && character <= 'z' ? static_cast<char>(character - 'a' + 'A') : character);
  }
  return upper;
}

// Other measurements are not looked at.
Sentence ReadXdr(FieldReader& fields, std::size_t num_fields) {
  constexpr std::size_t kGroup = 4;
  Xdr xdr;
  bool has_angle = false;
  for (std::size_t first = 0; first + kGroup <= num_fields; first += kGroup) {
    if (fields.Text(first) != "A" || fields.Text(first + 2) != "D") continue;
    const auto name = UpperName(fields.Text(first + 3));
    const bool is_pitch = name == "PTCH" || name == "PITCH";
    if (!is_pitch && name != "ROLL" && name != "HEEL") continue;
    has_angle = true;
    (is_pitch ? xdr.pitch_rad : xdr.roll_rad) = is_pitch ? AngleRad(fields, first + 1, -90.0, 90.0) : AngleRad(fields, first + 1, -180.0, 180.0);
  }
  if (!has_angle) return OtherSentence{};
  return xdr;
}

TntHtm ReadTntHtm(FieldReader& fields) {
  constexpr double kCountsPerTurn = 65536.0;
  constexpr double kDegreesPerTurn = 360.0;
  bool is_in_degrees = false;
  for (const std::size_t index : {0U, 2U, 4U, 6U}) is_in_degrees = is_in_degrees || fields.Text(index).find('.') != std::string_view::npos;
  const double unit_deg = is_in_degrees ? 1.0 : kDegreesPerTurn / kCountsPerTurn;
  const auto angle_rad = [&](std::size_t index, double min_deg, double max_deg) {
    const double angle = DegToRad(unit_deg * fields.Number(index, min_deg / unit_deg, max_deg / unit_deg));
    const char status = fields.Letter(index + 1, "CLMNOPV");
    return status == 'N' || status == 'M' || status == 'O' ? angle : kNan;
  };
  TntHtm htm;
  htm.heading_rad = WrapKnown(angle_rad(0, -180.0, 360.0));
  htm.pitch_rad = angle_rad(2, -90.0, 90.0);
  htm.roll_rad = angle_rad(4, -180.0, 180.0);
  fields.IsEmpty(7);  // dip and field are not used, but must be there
  return htm;
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

// THS: heading,mode. Estimated, manual, simulated and invalid headings were not measured.
Hdt ReadThs(FieldReader& fields) {
  const double heading_rad = CompassRad(fields, 0);
  return {fields.Letter(1, "AEMSV") == 'A' ? heading_rad : kNan};
}

Gst ReadGst(FieldReader& fields) {
  Gst gst;
  gst.time_of_day = fields.TimeOfDay(0);
  for (const std::size_t index : {1U, 2U, 3U}) fields.Number(index, 0.0, kMaxSdM);
  fields.Number(4, -360.0, 360.0);
  gst.north_sd_m = fields.Number(5, 0.0, kMaxSdM);
  gst.east_sd_m = fields.Number(6, 0.0, kMaxSdM);
  gst.height_sd_m = fields.Number(7, 0.0, kMaxSdM);
  return gst;
}

Gll ReadGll(FieldReader& fields, std::size_t num_fields) {
  Gll gll;
  gll.position = fields.Position(0);
  // Before NMEA 0183 2.0 there was neither time nor status: such a position counts.
  if (num_fields > 4) gll.time_of_day = fields.TimeOfDay(4);
  const char status = num_fields > 4 ? fields.Letter(5, "AV") : 'A';
  const char mode = num_fields > 6 ? fields.Letter(6, kModeLetters) : '\0';
  if (status == 'A' && gll.position) gll.quality = mode == '\0' ? FixQuality::kGnss : QualityOfMode(mode);
  return gll;
}

Zda ReadZda(FieldReader& fields) {
  Zda zda;
  zda.time_of_day = fields.TimeOfDay(0);
  zda.date = fields.Date(1, 2, 3);
  fields.Number(4, -13.0, 13.0);  // the zone is not used: time and date are UTC
  fields.Number(5, -59.0, 59.0);
  return zda;
}

MagneticHeading ReadHdm(FieldReader& fields) {
  MagneticHeading heading;
  heading.compass_rad = WrapKnown(DegToRad(fields.NumberWithUnit(0, 'M', 0.0, 360.0)));
  return heading;
}

MagneticHeading ReadHdg(FieldReader& fields) {
  MagneticHeading heading;
  heading.compass_rad = CompassRad(fields, 0);
  heading.deviation_rad = DegToRad(fields.NumberWithSide(1, 180.0));
  heading.declination_rad = DegToRad(fields.NumberWithSide(3, 180.0));
  return heading;
}

Rot ReadRot(FieldReader& fields, std::size_t num_fields) {
  constexpr double kSecondsPerMinute = 60.0;
  const double rate_radps = AngleRad(fields, 0, -kMaxTurnDegpmin, kMaxTurnDegpmin) / kSecondsPerMinute;
  const char status = num_fields > 1 ? fields.Letter(1, "AV") : 'A';
  return {status == 'A' ? rate_radps : kNan};
}

// The first field is the word HPR.
PsatHpr ReadPsatHpr(FieldReader& fields) {
  PsatHpr hpr;
  hpr.time_of_day = fields.TimeOfDay(1);
  hpr.heading_rad = CompassRad(fields, 2);
  hpr.pitch_rad = AngleRad(fields, 3, -90.0, 90.0);
  hpr.roll_rad = AngleRad(fields, 4, -180.0, 180.0);
  fields.Letter(5, "NG");
  return hpr;
}

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
  if (type == "GGA") return ReadGga(fields, num_fields);
  if (type == "GNS") return ReadGns(fields);
  if (type == "XDR") return ReadXdr(fields, num_fields);
  if (type == "PTNTHTM") return ReadTntHtm(fields);
  if (type == "VTG") return ReadVtg(fields, num_fields);
  if (type == "HDT") return ReadHdt(fields);
  if (type == "PASHR") return ReadPashr(fields);
  if (type == "GST") return ReadGst(fields);
  if (type == "GLL") return ReadGll(fields, num_fields);
  if (type == "ZDA") return ReadZda(fields);
  if (type == "THS") return ReadThs(fields);
  if (type == "HDG") return ReadHdg(fields);
  if (type == "HDM") return ReadHdm(fields);
  if (type == "ROT") return ReadRot(fields, num_fields);
  if (type == "PSAT") return ReadPsatHpr(fields);
  if (type == "VNINS") return ReadVnIns(fields);
  if (type == "VNYMR") return ReadVnYmr(fields);
  if (type == "VNIMU") return ReadVnImu(fields);
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
    if (address == "PASHR" && !has_word) return address;
    // Hemisphere's own sentences share an address; their first field tells them apart.
    if (address == "PTNTHTM") return address;
    if (address == "PSAT" && !sentence.fields.empty() && sentence.fields.front() == "HPR") return address;
    return {};
  }
  // VN is VectorNav's mark, not a talker.
  if (address == "VNINS" || address == "VNYMR" || address == "VNIMU") return address;
  return address.size() == kTalkerCharacters + kTypeCharacters ? address.substr(kTalkerCharacters) : std::string_view{};
}

}  // namespace

bool IsMeasured(FixQuality quality) { return quality >= FixQuality::kGnss && quality <= FixQuality::kDeadReckoning; }

ParseResult ParseSentence(std::string_view line, bool requires_checksum) {
  const auto framed = Frame(line, requires_checksum);
  if (framed.fault != SentenceFault::kNone) return {framed.fault, {}};
  FieldReader fields(framed.sentence.fields);
  ParseResult result;
  result.sentence = line.front() == '$' ? Read(TypeOf(framed.sentence), fields, framed.sentence.fields.size()) : OtherSentence{};
  result.fault = fields.fault();
  return result;
}

}  // namespace lookout::navigator
