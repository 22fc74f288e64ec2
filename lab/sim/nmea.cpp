#include "lab/sim/nmea.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace lookout::sim {
namespace {

constexpr double kKnotsPerMps = 3600.0 / 1852.0;
constexpr double kKmhPerMps = 3.6;

// hhmmss.sss
std::string TimeOfDay(Utime time) {
  const std::chrono::hh_mm_ss clock(std::chrono::floor<std::chrono::milliseconds>(time - std::chrono::floor<std::chrono::days>(time)));
  return fmt::format("{:02}{:02}{:02}.{:03}", clock.hours().count(), clock.minutes().count(), clock.seconds().count(), clock.subseconds().count());
}

std::chrono::year_month_day DateOf(Utime time) { return std::chrono::floor<std::chrono::days>(time); }

// ddmmyy
std::string Date(Utime time) {
  const auto date = DateOf(time);
  return fmt::format("{:02}{:02}{:02}", static_cast<unsigned>(date.day()), static_cast<unsigned>(date.month()), static_cast<int>(date.year()) % 100);
}

// ddmm.mmmmmmm,N: 1e-7 minutes are 0.2 mm. Rounded as a whole, so that no minute reaches 60.
std::string Angle(double angle_deg, int degree_digits, char positive, char negative) {
  constexpr long long kUnitsPerMinute = 10'000'000;
  const long long units = std::llround(std::abs(angle_deg) * 60.0 * static_cast<double>(kUnitsPerMinute));
  const long long minutes = units / kUnitsPerMinute;
  return fmt::format("{:0{}}{:02}.{:07},{}", minutes / 60, degree_digits, minutes % 60, units % kUnitsPerMinute,
                     angle_deg < 0.0 ? negative : positive);
}

std::string Position(const GnssMeasurement& measurement) {
  return Angle(measurement.latitude_deg, 2, 'N', 'S') + "," + Angle(measurement.longitude_deg, 3, 'E', 'W');
}

// Mode letter of NMEA 0183 2.3 and later.
char Mode(int quality) { return quality == 4 ? 'R' : quality == 2 ? 'D' : 'A'; }

// Two decimals, never 360.00.
std::string Course(double course_deg) {
  const long long units = std::llround(course_deg * 100.0) % 36000;
  return fmt::format("{}.{:02}", units / 100, units % 100);
}

}  // namespace

std::string Sentence(std::string_view body) {
  unsigned checksum = 0;
  for (const char character : body) checksum ^= static_cast<unsigned char>(character);
  return fmt::format("${}*{:02X}\r\n", body, checksum);
}

std::string Rmc(const GnssMeasurement& m) {
  if (m.quality == 0) return Sentence(fmt::format("GPRMC,{},V,,,,,,,{},,,N", TimeOfDay(m.time), Date(m.time)));
  return Sentence(fmt::format("GPRMC,{},A,{},{:.3f},{},{},,,{}", TimeOfDay(m.time), Position(m), m.speed_mps * kKnotsPerMps, Course(m.course_deg),
                              Date(m.time), Mode(m.quality)));
}

std::string Gga(const GnssMeasurement& m) {
  if (m.quality == 0) return Sentence("GPGGA," + TimeOfDay(m.time) + ",,,,,0,00,99.9,,M,,M,,");
  return Sentence(
      fmt::format("GPGGA,{},{},{},14,0.7,{:.3f},M,{:.3f},M,,", TimeOfDay(m.time), Position(m), m.quality, m.msl_height_m, m.geoid_separation_m));
}

std::string Vtg(const GnssMeasurement& m) {
  if (m.quality == 0) return Sentence("GPVTG,,,,,,,,,N");
  return Sentence(
      fmt::format("GPVTG,{},T,,M,{:.3f},N,{:.3f},K,{}", Course(m.course_deg), m.speed_mps * kKnotsPerMps, m.speed_mps * kKmhPerMps, Mode(m.quality)));
}

std::string Gst(const GnssMeasurement& m) {
  if (m.quality == 0) return Sentence("GPGST," + TimeOfDay(m.time) + ",,,,,,,");
  // The ellipse is a circle: its axes are the deviations, its direction is 0. The simulated height has the deviation of the other two axes.
  return Sentence(fmt::format("GPGST,{0},{1:.3f},{1:.3f},{1:.3f},0.0,{1:.3f},{1:.3f},{1:.3f}", TimeOfDay(m.time), m.sd_m));
}

std::string Zda(Utime time) {
  const auto date = DateOf(time);
  return Sentence(fmt::format("GPZDA,{},{:02},{:02},{:04},00,00", TimeOfDay(time), static_cast<unsigned>(date.day()),
                              static_cast<unsigned>(date.month()), static_cast<int>(date.year())));
}

std::string Hdt(double heading_deg) { return Sentence("GPHDT," + Course(heading_deg) + ",T"); }

std::string Rot(double rate_degpmin) { return Sentence(fmt::format("GPROT,{:.1f},A", rate_degpmin)); }

std::string Pashr(const AttitudeMeasurement& m, double tilt_sd_deg, double heading_sd_deg) {
  // GNSS quality 2 is RTK, 1 any other position; INS status 1 is aligned: as Trimble and Applanix use them.
  return Sentence(fmt::format("PASHR,{},{},T,{:+.2f},{:+.2f},{:+.2f},{:.3f},{:.3f},{:.3f},{},1", TimeOfDay(m.time), Course(m.heading_deg), m.roll_deg,
                              m.pitch_deg, m.heave_m, tilt_sd_deg, tilt_sd_deg, heading_sd_deg, m.has_rtk ? 2 : 1));
}

std::string VnImu(const ImuMeasurement& m) {
  std::string body = "VNIMU";
  for (const double gauss : m.magnetic_gauss) body += fmt::format(",{:+08.4f}", gauss);
  for (const double force_mps2 : m.specific_force_mps2) body += fmt::format(",{:+07.3f}", force_mps2);
  for (const double rate_radps : m.angular_rate_radps) body += fmt::format(",{:+010.6f}", rate_radps);
  return Sentence(body + fmt::format(",{:+05.1f},{:+08.3f}", m.temperature_celsius, m.pressure_kpa));
}

}  // namespace lookout::sim
