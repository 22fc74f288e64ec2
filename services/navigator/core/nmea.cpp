#include "services/navigator/core/nmea.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"

namespace lookout::navigator {

bool IsMeasured(FixQuality quality) { return quality >= FixQuality::kGnss && quality <= FixQuality::kDeadReckoning; }

namespace {

constexpr double kMpsPerKnot = 1852.0 / 3600.0;
constexpr double kMpsPerKmh = 1.0 / 3.6;

// Bounds of possible values.
constexpr double kMaxSpeedMps = 100.0;   // of receivers on boats: 194 knots
constexpr double kMinHeightM = -1000.0;  // the Dead Sea lies at -430 m
constexpr double kMaxHeightM = 20'000.0;
constexpr double kMaxSdM = 1e6;     // receivers without a fix send great deviations
constexpr double kMaxHdop = 100.0;  // receivers send 99.99 for "no fix"
// Fifty satellites evenly over the sky, more than are ever in view, have sqrt(6 / 50) = 0.35: two thirds of the squares of their directions are
// horizontal, half of that along each axis. Receivers and gateways send 0, 0.01 and the like where they know none.
constexpr double kMinHdop = 0.35;
constexpr double kMaxGeoidSeparationM = 150.0;  // EGM2008: -107 m to +86 m
constexpr double kMaxHeaveM = 50.0;
constexpr int kMaxSatellites = 99;
constexpr double kMaxTurnDegpmin = 36000.0;  // 100 turns a minute
// Beyond the ranges of VectorNav's sensors (2000 deg/s, 16 g).
constexpr double kMaxRateRadps = 100.0;
constexpr double kMaxForceMps2 = 1000.0;
constexpr double kMaxFieldGauss = 100.0;

double AngleRad(FieldReader& fields, std::size_t index, double min_deg, double max_deg) { return DegToRad(fields.Number(index, min_deg, max_deg)); }

// 360 is 0. A missing value stays missing: WrapTo2Pi would make 0 of it.
double WrapKnown(double angle_rad) { return std::isnan(angle_rad) ? kNan : WrapTo2Pi(angle_rad); }

double CompassRad(FieldReader& fields, std::size_t index) { return WrapKnown(AngleRad(fields, index, 0.0, 360.0)); }

// Degrees, and behind them T, which must stand there when they do.
double TrueCompassRad(FieldReader& fields, std::size_t index) { return WrapKnown(DegToRad(fields.NumberWithUnit(index, 'T', 0.0, 360.0))); }

// Mode letters of NMEA 0183 2.3 and later, in the order of the numbers of GGA, from 0. P (precise) means that no deliberate degradation is used.
constexpr std::string_view kModeLetters = "NADPRFEMS";
FixQuality QualityOfMode(char mode) { return static_cast<FixQuality>(kModeLetters.find(mode)); }

double Tilt(FieldReader& fields, std::size_t index, double max_deg) { return AngleRad(fields, index, -max_deg, max_deg); }

// The last field of which anything is used may stand before some that must be there all the same.
void RequireField(FieldReader& fields, std::size_t index) { fields.Text(index); }

// Zero means unknown.
double KnownSd(double sd) { return sd > 0.0 ? sd : kNan; }

double Hdop(FieldReader& fields, std::size_t index) {
  const double hdop = fields.Number(index, 0.0, kMaxHdop);
  return hdop >= kMinHdop ? hdop : kNan;
}

// RMC: time,status,latitude,N,longitude,E,knots,course,date,variation,E[,mode[,navigational status]]
void ReadRmc(FieldReader& fields, Sentence& sentence) {
  sentence.time_of_day = fields.TimeOfDay(0);
  const char status = fields.Letter(1, "AV");
  sentence.position = fields.Position(2);
  sentence.speed_mps = fields.Number(6, 0.0, kMaxSpeedMps / kMpsPerKnot) * kMpsPerKnot;
  sentence.course_rad = CompassRad(fields, 7);
  sentence.date = fields.Date(8);
  RequireField(fields, 10);
  // The declination is a by-product: where it is not in order, the fix is not refused for it.
  FieldReader declination = fields;
  sentence.declination_rad = DegToRad(declination.NumberWithSide(9, 180.0));
  if (declination.fault() != SentenceFault::kNone) sentence.declination_rad = kNan;
  const char mode = fields.size() > 11 ? fields.Letter(11, kModeLetters) : '\0';
  // The navigational status of NMEA 4.1 behind the mode is V in receivers that give no such status, whatever the fix (u-blox ZED-F9P).
  if (status == 'A') sentence.quality = mode == '\0' ? FixQuality::kGnss : QualityOfMode(mode);
}

// A height of a sentence that is too short: a number that does not stand with its unit says nothing.
double NumberWithUnitOrNan(const FieldReader& fields, std::size_t index, double min, double max) {
  FieldReader reader = fields;
  const double number = reader.NumberWithUnit(index, 'M', min, max);
  return reader.fault() == SentenceFault::kNone ? number : kNan;
}

// A single digit, of which only the position counts: whatever it says, no better than a plain fix.
FixQuality ModestQuality(FieldReader& fields, std::size_t index) {
  const auto quality = fields.Text(index);
  if (quality.size() != 1) return fields.Fail(SentenceFault::kBadField, FixQuality::kNone);  // two digits are satellites
  return std::string_view("123459").find(quality) != std::string_view::npos ? FixQuality::kGnss : FixQuality::kNone;
}

// GGA: time,latitude,N,longitude,E,quality,satellites,HDOP,height,M,geoid separation,M,age,station
// One that is too short (Saab's R4 leaves a field out) counts for what it holds: position, quality and HDOP, and a height that stands with its unit.
// Where satellites, HDOP or height are missing these are not known, and the fix counts as one without correction.
void ReadGga(FieldReader& fields, Sentence& sentence) {
  constexpr int kNovatelSbas = 9;  // a differential correction
  constexpr std::size_t kNumFields = 14;
  sentence.time_of_day = fields.TimeOfDay(0);
  sentence.position = fields.Position(1);
  if (fields.size() > 8 && fields.size() < kNumFields && fields.Text(8) == "M") {
    // The unit of the height one place too early: satellites, HDOP or height are missing, and nobody can know which.
    sentence.quality = ModestQuality(fields, 5);
    return;
  }
  const int quality = fields.Count(5, kNovatelSbas);
  sentence.quality = quality == kNovatelSbas ? FixQuality::kDifferential : static_cast<FixQuality>(std::max(quality, 0));
  sentence.num_satellites = fields.Count(6, kMaxSatellites);
  sentence.hdop = Hdop(fields, 7);
  if (fields.size() < kNumFields) {
    sentence.msl_height_m = NumberWithUnitOrNan(fields, 8, kMinHeightM, kMaxHeightM);
    sentence.geoid_separation_m = NumberWithUnitOrNan(fields, 10, -kMaxGeoidSeparationM, kMaxGeoidSeparationM);
    return;
  }
  sentence.msl_height_m = fields.NumberWithUnit(8, 'M', kMinHeightM, kMaxHeightM);
  sentence.geoid_separation_m = fields.NumberWithUnit(10, 'M', -kMaxGeoidSeparationM, kMaxGeoidSeparationM);
}

// The best of all systems, in the order of their accuracy.
FixQuality QualityOfModes(FieldReader& fields, std::size_t index) {
  constexpr std::string_view kBestFirst = "RFDPAEMS";
  constexpr std::size_t kMaxSystems = 8;
  const auto modes = fields.Text(index);
  if (modes.size() > kMaxSystems || modes.find_first_not_of(kModeLetters) != std::string_view::npos) {
    return fields.Fail(SentenceFault::kBadField, FixQuality::kNone);
  }
  const auto best = kBestFirst.find_first_of(modes);
  return best == std::string_view::npos ? FixQuality::kNone : QualityOfMode(kBestFirst[best]);
}

// GNS: time,latitude,N,longitude,E,modes (a letter per system),satellites,HDOP,height,geoid separation,age,station[,navigational status]
// Source: gpsd's "NMEA Revealed", GNS. The quality is the best that a system has: the fix is made of all of them.
void ReadGns(FieldReader& fields, Sentence& sentence) {
  sentence.time_of_day = fields.TimeOfDay(0);
  sentence.position = fields.Position(1);
  sentence.quality = QualityOfModes(fields, 5);
  sentence.num_satellites = fields.Count(6, kMaxSatellites);
  sentence.hdop = Hdop(fields, 7);
  sentence.msl_height_m = fields.Number(8, kMinHeightM, kMaxHeightM);
  sentence.geoid_separation_m = fields.Number(9, -kMaxGeoidSeparationM, kMaxGeoidSeparationM);
  RequireField(fields, 11);
}

std::string UpperName(std::string_view name) {
  std::string upper(name.substr(0, name.find('#')));
  while (upper.ends_with(' ')) upper.pop_back();
  for (char& letter : upper) {
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  }
  return upper;
}

// XDR: groups of type,value,unit,name. Used are A (angular displacement) in D (degrees) with the names PTCH, PITCH (pitch) and ROLL, HEEL (roll), in
// large or small letters, without what follows #. Sources: NMEA's update to XDR (version 4.11: "Pitch", "Roll", "Heel"); Airmar (PTCH, ROLL); True
// North (PITCH, ROLL). Which way they are positive: see config; by default pitch bow up, roll starboard down, as Airmar has them.
void ReadXdr(FieldReader& fields, Sentence& sentence) {
  constexpr std::size_t kGroup = 4;
  bool has_angle = false;
  for (std::size_t first = 0; first + kGroup <= fields.size(); first += kGroup) {
    if (fields.Text(first) != "A" || fields.Text(first + 2) != "D") continue;
    const auto name = UpperName(fields.Text(first + 3));
    const bool is_pitch = name == "PTCH" || name == "PITCH";
    if (!is_pitch && name != "ROLL" && name != "HEEL") continue;
    has_angle = true;
    (is_pitch ? sentence.pitch_rad : sentence.roll_rad) = Tilt(fields, first + 1, is_pitch ? 90.0 : 180.0);
  }
  if (!has_angle) sentence.type = SentenceType::kOther;
}

// PTNTHTM: heading,status,pitch,status,roll,status,dip,field, of True North's compasses. A status of C, L, P or V (alarms) voids its angle. Angles
// are in degrees where one of them has a decimal point, else in turns / 65536. The heading is true where the declination is set in the compass.
// Source: gpsd, driver_nmea0183.c, its description of the sentence.
void ReadTntHtm(FieldReader& fields, Sentence& sentence) {
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
  sentence.heading_rad = WrapKnown(angle_rad(0, -180.0, 360.0));
  sentence.pitch_rad = angle_rad(2, -90.0, 90.0);
  sentence.roll_rad = angle_rad(4, -180.0, 180.0);
  RequireField(fields, 7);
}

// VTG: course,T,magnetic course,M,knots,N,km/h,K[,mode]
void ReadVtg(FieldReader& fields, Sentence& sentence) {
  const double course_rad = TrueCompassRad(fields, 0);
  const double knots_mps = fields.NumberWithUnit(4, 'N', 0.0, kMaxSpeedMps / kMpsPerKnot) * kMpsPerKnot;
  const double kmh_mps = fields.NumberWithUnit(6, 'K', 0.0, kMaxSpeedMps / kMpsPerKmh) * kMpsPerKmh;
  const char mode = fields.size() > 8 ? fields.Letter(8, kModeLetters) : '\0';
  if (mode != '\0' && !IsMeasured(QualityOfMode(mode))) return;
  sentence.course_rad = course_rad;
  sentence.speed_mps = std::isnan(knots_mps) ? kmh_mps : knots_mps;
}

// HDT: heading,T
void ReadHdt(FieldReader& fields, Sentence& sentence) { sentence.heading_rad = TrueCompassRad(fields, 0); }

// THS: heading,mode. Estimated, manual, simulated and invalid headings were not measured.
void ReadThs(FieldReader& fields, Sentence& sentence) {
  const double heading_rad = CompassRad(fields, 0);
  if (fields.Letter(1, "AEMSV") == 'A') sentence.heading_rad = heading_rad;
}

// GST: time,rms,sd of the major axis,of the minor axis,direction,sd of latitude,of longitude,of height. Both axes get one deviation.
void ReadGst(FieldReader& fields, Sentence& sentence) {
  sentence.time_of_day = fields.TimeOfDay(0);
  for (const std::size_t index : {1U, 2U, 3U}) fields.Number(index, 0.0, kMaxSdM);
  fields.Number(4, -360.0, 360.0);
  const double north_sd_m = fields.Number(5, 0.0, kMaxSdM);
  const double east_sd_m = fields.Number(6, 0.0, kMaxSdM);
  sentence.horizontal_sd_m = KnownSd(std::sqrt((north_sd_m * north_sd_m + east_sd_m * east_sd_m) / 2.0));
  sentence.vertical_sd_m = KnownSd(fields.Number(7, 0.0, kMaxSdM));
}

// GLL: latitude,N,longitude,E[,time,status[,mode]]. Before NMEA 0183 2.0 there was neither time nor status: such a position counts.
void ReadGll(FieldReader& fields, Sentence& sentence) {
  sentence.position = fields.Position(0);
  if (fields.size() > 4) sentence.time_of_day = fields.TimeOfDay(4);
  const char status = fields.size() > 4 ? fields.Letter(5, "AV") : 'A';
  const char mode = fields.size() > 6 ? fields.Letter(6, kModeLetters) : '\0';
  if (status == 'A' && sentence.position) sentence.quality = mode == '\0' ? FixQuality::kGnss : QualityOfMode(mode);
}

// ZDA: time,day,month,year,zone hours,zone minutes. Time and date are UTC: the zone is not used.
void ReadZda(FieldReader& fields, Sentence& sentence) {
  sentence.time_of_day = fields.TimeOfDay(0);
  sentence.date = fields.Date(1, 2, 3);
  fields.Number(4, -13.0, 13.0);
  fields.Number(5, -59.0, 59.0);
}

// HDM: heading,M
void ReadHdm(FieldReader& fields, Sentence& sentence) { sentence.heading_rad = WrapKnown(DegToRad(fields.NumberWithUnit(0, 'M', 0.0, 360.0))); }

// HDG: heading of the compass,deviation,E,declination,E
void ReadHdg(FieldReader& fields, Sentence& sentence) {
  sentence.heading_rad = CompassRad(fields, 0);
  sentence.deviation_rad = DegToRad(fields.NumberWithSide(1, 180.0));
  sentence.declination_rad = DegToRad(fields.NumberWithSide(3, 180.0));
}

// ROT: degrees per minute,A
void ReadRot(FieldReader& fields, Sentence& sentence) {
  constexpr double kSecondsPerMinute = 60.0;
  const double rate_radps = Tilt(fields, 0, kMaxTurnDegpmin) / kSecondsPerMinute;
  const char status = fields.size() > 1 ? fields.Letter(1, "AV") : 'A';
  if (status == 'A') sentence.turn_rate_radps = rate_radps;
}

// PSAT,HPR,time,heading,pitch,roll,type: N = by GNSS, G = by gyro.
// Source: Hemisphere GNSS Technical Reference Guide, PSAT,HPR. Which way roll and pitch are positive is set in the receiver: see config.
void ReadPsatHpr(FieldReader& fields, Sentence& sentence) {
  sentence.time_of_day = fields.TimeOfDay(1);
  sentence.heading_rad = CompassRad(fields, 2);
  sentence.pitch_rad = Tilt(fields, 3, 90.0);
  sentence.roll_rad = Tilt(fields, 4, 180.0);
  fields.Letter(5, "NG");
}

// PASHR: time,heading,T,roll,pitch,heave,roll sd,pitch sd,heading sd,GNSS quality[,INS status]
// Fields: Trimble, NMEA-0183 message PASHR (help.fieldsystems.trimble.com); NovAtel OEM7, PASHR. Signs: roll positive port side up, that is
// starboard down; pitch positive bow up (Kongsberg Seapath, PSXN,23: "positive with port side up", "positive with bow up"; the crate
// nmea-kit 0.5.6, pashr.rs: "negative = port", "negative = bow down"). GNSS quality and INS status mean different things by maker (INS status 0 is
// "GPS only" with Trimble, "IMU out" with Applanix) and are checked but not used.
void ReadPashr(FieldReader& fields, Sentence& sentence) {
  sentence.time_of_day = fields.TimeOfDay(0);
  sentence.heading_rad = TrueCompassRad(fields, 1);
  sentence.roll_rad = Tilt(fields, 3, 180.0);
  sentence.pitch_rad = Tilt(fields, 4, 90.0);
  sentence.heave_m = fields.Number(5, -kMaxHeaveM, kMaxHeaveM);
  sentence.roll_sd_rad = AngleRad(fields, 6, 0.0, 180.0);
  sentence.pitch_sd_rad = AngleRad(fields, 7, 0.0, 180.0);
  sentence.heading_sd_rad = AngleRad(fields, 8, 0.0, 180.0);
  fields.Count(9, 9);
}

// Year and month from whose first day GPS time has been one second more ahead of UTC: 18 s since 2017. IERS, Bulletin C (hpiers.obspm.fr), list of
// leap seconds; Bulletins C 71 and 72 announce none until the end of 2026.
constexpr std::array kLeapMonths{198107, 198207, 198307, 198507, 198801, 199001, 199101, 199207, 199307,
                                 199407, 199601, 199707, 199901, 200601, 200901, 201207, 201507, 201701};

Utime UtcOfGps(Utime gps_time) {
  // At the begin of the k-th of these months GPS time is k seconds more than UTC.
  std::chrono::seconds leap(0);
  for (const int month : kLeapMonths) {
    if (gps_time >= std::chrono::sys_days(std::chrono::year(month / 100) / (month % 100) / 1) + leap + std::chrono::seconds(1)) ++leap;
  }
  return gps_time - leap;
}

double YawRad(FieldReader& fields, std::size_t index) { return WrapKnown(Tilt(fields, index, 360.0)); }

Eigen::Vector3d Vector(FieldReader& fields, std::size_t first, double max) {
  return {fields.Number(first, -max, max), fields.Number(first + 1, -max, max), fields.Number(first + 2, -max, max)};
}

// Magnetometer x y z (not used), accelerometer x y z, gyro x y z.
StrapdownSample Sample(FieldReader& fields, std::size_t first) {
  StrapdownSample sample;
  Vector(fields, first, kMaxFieldGauss);
  sample.specific_force_mps2 = Vector(fields, first + 3, kMaxForceMps2);
  sample.angular_velocity_radps = Vector(fields, first + 6, kMaxRateRadps);
  return sample;
}

// VNINS: GPS time of week,week,status,yaw,pitch,roll,latitude,longitude,height,velocity north,east,down,sd of attitude,position,velocity.
// Source: VectorNav VN-300 User Manual UM005, "INS Solution - LLA". Yaw from true north, pitch positive bow up, roll positive starboard down.
// Before the sensor tracks, or with a fault, its heading comes from its magnetometer; roll and pitch come from gravity and count.
void ReadVnIns(FieldReader& fields, Sentence& sentence) {
  constexpr double kSecondsPerWeek = 7 * 86400.0;
  constexpr int kMaxWeek = 9999;
  constexpr auto kGpsEpoch = std::chrono::sys_days(std::chrono::year(1980) / 1 / 6);
  constexpr int kFaultBits = 0x78;  // bits 3 to 6: the filter's time, IMU, magnetometer or GNSS error
  constexpr int kModeBits = 3;
  constexpr int kNotTracking = 0;
  constexpr int kGnssLost = 3;
  const double time_of_week_s = fields.Number(0, 0.0, kSecondsPerWeek);
  const int week = fields.Count(1, kMaxWeek);
  // Before it has had GNSS time the sensor says week 0.
  if (week > 0 && !std::isnan(time_of_week_s)) {
    const Utime utc = UtcOfGps(kGpsEpoch + std::chrono::weeks(week) + std::chrono::microseconds(std::llround(time_of_week_s * 1e6)));
    sentence.date = std::chrono::floor<std::chrono::days>(utc);
    sentence.time_of_day = utc - *sentence.date;
  }
  const int status = std::max(fields.Hex(2), 0);
  const int mode = status & kModeBits;
  const double yaw_rad = YawRad(fields, 3);
  sentence.pitch_rad = Tilt(fields, 4, 90.0);
  sentence.roll_rad = Tilt(fields, 5, 180.0);
  const double latitude_deg = fields.Number(6, -90.0, 90.0);
  const double longitude_deg = fields.Number(7, -180.0, 180.0);
  const double height_m = fields.Number(8, kMinHeightM, kMaxHeightM);
  const Eigen::Vector3d velocity_ned_mps = Vector(fields, 9, kMaxSpeedMps);
  sentence.heading_sd_rad = sentence.pitch_sd_rad = sentence.roll_sd_rad = KnownSd(DegToRad(fields.Number(12, 0.0, 360.0)));
  const double position_sd_m = fields.Number(13, 0.0, kMaxSdM);
  const double velocity_sd_mps = fields.Number(14, 0.0, kMaxSdM);
  if (mode == kNotTracking || (status & kFaultBits) != 0) return;
  sentence.quality = mode == kGnssLost ? FixQuality::kDeadReckoning : FixQuality::kGnss;
  sentence.heading_rad = yaw_rad;
  if (!std::isnan(latitude_deg + longitude_deg)) sentence.position = GeodeticPlace{latitude_deg, longitude_deg};
  sentence.direct_ellipsoid_height_m = height_m;
  sentence.horizontal_sd_m = sentence.vertical_sd_m = KnownSd(position_sd_m);
  sentence.speed_mps = Hypot(velocity_ned_mps.x(), velocity_ned_mps.y());
  if (sentence.speed_mps > 0.0) sentence.course_rad = WrapTo2Pi(Atan2(velocity_ned_mps.y(), velocity_ned_mps.x()));
  sentence.velocity_sd_mps = KnownSd(velocity_sd_mps);
}

// VNYMR: yaw,pitch,roll,magnetometer x y z,accelerometer x y z,gyro x y z.
// Source: VectorNav VN-100 User Manual UM001, "Yaw, Pitch, Roll, Magnetic, Acceleration, and Angular Rates". Signs as VNINS.
void ReadVnYmr(FieldReader& fields, Sentence& sentence) {
  sentence.heading_rad = YawRad(fields, 0);
  sentence.pitch_rad = Tilt(fields, 1, 90.0);
  sentence.roll_rad = Tilt(fields, 2, 180.0);
  sentence.imu = Sample(fields, 3);
}

// VNIMU: magnetometer x y z,accelerometer x y z,gyro x y z,temperature,pressure. Source: VectorNav VN-100 User Manual UM001, "IMU Measurements".
void ReadVnImu(FieldReader& fields, Sentence& sentence) {
  sentence.imu = Sample(fields, 0);
  RequireField(fields, 10);
}

struct Decoder {
  std::string_view word;  // the address without its talker; of a proprietary sentence the whole address
  SentenceType type;
  std::string_view name;
  void (*read)(FieldReader& fields, Sentence& sentence);
};

constexpr std::array kDecoders{Decoder{"RMC", SentenceType::kRmc, "RMC", ReadRmc},
                               Decoder{"GGA", SentenceType::kGga, "GGA", ReadGga},
                               Decoder{"GNS", SentenceType::kGns, "GNS", ReadGns},
                               Decoder{"XDR", SentenceType::kXdr, "XDR", ReadXdr},
                               Decoder{"PTNTHTM", SentenceType::kTntHtm, "PTNTHTM", ReadTntHtm},
                               Decoder{"VTG", SentenceType::kVtg, "VTG", ReadVtg},
                               Decoder{"HDT", SentenceType::kHdt, "HDT", ReadHdt},
                               Decoder{"THS", SentenceType::kHdt, "HDT", ReadThs},
                               Decoder{"PASHR", SentenceType::kPashr, "PASHR", ReadPashr},
                               Decoder{"GST", SentenceType::kGst, "GST", ReadGst},
                               Decoder{"GLL", SentenceType::kGll, "GLL", ReadGll},
                               Decoder{"ZDA", SentenceType::kZda, "ZDA", ReadZda},
                               Decoder{"HDG", SentenceType::kMagnetic, "HDG", ReadHdg},
                               Decoder{"HDM", SentenceType::kMagnetic, "HDG", ReadHdm},
                               Decoder{"ROT", SentenceType::kRot, "ROT", ReadRot},
                               Decoder{"PSAT", SentenceType::kPsatHpr, "PSAT", ReadPsatHpr},
                               Decoder{"VNINS", SentenceType::kVnIns, "VNINS", ReadVnIns},
                               Decoder{"VNYMR", SentenceType::kVnYmr, "VNYMR", ReadVnYmr},
                               Decoder{"VNIMU", SentenceType::kVnImu, "VNIMU", ReadVnImu}};

// The type without its talker; of proprietary sentences, which begin with P and have none, and of VectorNav's, whose VN is no talker, the address.
std::string_view TypeOf(const FramedSentence& sentence) {
  constexpr std::size_t kTalkerCharacters = 2;
  constexpr std::size_t kTypeCharacters = 3;
  const auto address = sentence.address;
  const auto first = sentence.fields.empty() ? std::string_view{} : sentence.fields.front();
  // Ashtech's own sentences have a word in place of the time: $PASHR,POS,...
  if (address == "PASHR" && !first.empty() && first.front() >= 'A') return {};
  // Hemisphere's own sentences share an address; their first field distinguishes them.
  if (address == "PSAT" && first != "HPR") return {};
  if (address.starts_with('P') || address == "VNINS" || address == "VNYMR" || address == "VNIMU") return address;
  return address.size() == kTalkerCharacters + kTypeCharacters ? address.substr(kTalkerCharacters) : std::string_view{};
}

}  // namespace

ParseResult ParseSentence(std::string_view line, bool requires_checksum) {
  const auto framed = Frame(line, requires_checksum);
  if (framed.fault != SentenceFault::kNone) return {framed.fault, {}};
  ParseResult result;
  const auto* const decoder = line.front() == '$' ? std::ranges::find(kDecoders, TypeOf(framed.sentence), &Decoder::word) : kDecoders.end();
  if (decoder == kDecoders.end()) return result;
  FieldReader fields(framed.sentence.fields);
  result.sentence.type = decoder->type;
  result.sentence.name = decoder->name;
  decoder->read(fields, result.sentence);
  result.fault = fields.fault();
  return result;
}

}  // namespace lookout::navigator
