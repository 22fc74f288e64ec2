#include "tools/sim/nmea.hpp"

#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace lookout::sim {
namespace {

constexpr double kKnotsPerMps = 3600.0 / 1852.0;
constexpr double kKmhPerMps = 3.6;

__attribute__((format(printf, 1, 2))) std::string Print(const char* form, ...) {
  std::array<char, 160> text{};
  va_list arguments;
  va_start(arguments, form);
  std::vsnprintf(text.data(), text.size(), form, arguments);
  va_end(arguments);
  return text.data();
}

// hhmmss.sss
std::string TimeOfDay(Utime time) {
  const auto since_midnight = std::chrono::floor<std::chrono::milliseconds>(time - std::chrono::floor<std::chrono::days>(time));
  const std::chrono::hh_mm_ss clock(since_midnight);
  return Print("%02d%02d%02d.%03d", static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
               static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
}

// ddmmyy
std::string Date(Utime time) {
  const std::chrono::year_month_day date(std::chrono::floor<std::chrono::days>(time));
  return Print("%02u%02u%02d", static_cast<unsigned>(date.day()), static_cast<unsigned>(date.month()), static_cast<int>(date.year()) % 100);
}

// ddmm.mmmmmmm,N: 1e-7 minutes are 0.2 mm. Rounded as a whole, so that no minute reaches 60.
std::string Angle(double angle_deg, int degree_digits, char positive, char negative) {
  constexpr long long kUnitsPerMinute = 10'000'000;
  const long long units = std::llround(std::abs(angle_deg) * 60.0 * static_cast<double>(kUnitsPerMinute));
  const long long minutes = units / kUnitsPerMinute;
  return Print("%0*lld%02lld.%07lld,%c", degree_digits, minutes / 60, minutes % 60, units % kUnitsPerMinute, angle_deg < 0.0 ? negative : positive);
}

std::string Position(const GnssMeasurement& measurement) {
  return Angle(measurement.latitude_deg, 2, 'N', 'S') + "," + Angle(measurement.longitude_deg, 3, 'E', 'W');
}

// Mode letter of NMEA 0183 2.3 and later.
char Mode(int quality) {
  switch (quality) {
    case 4:
      return 'R';
    case 2:
      return 'D';
    default:
      return 'A';
  }
}

// Two decimals, never 360.00.
std::string Course(double course_deg) {
  const long long units = std::llround(course_deg * 100.0) % 36000;
  return Print("%lld.%02lld", units / 100, units % 100);
}

}  // namespace

std::string Sentence(std::string_view body) {
  unsigned checksum = 0;
  for (const char character : body) checksum ^= static_cast<unsigned char>(character);
  return "$" + std::string(body) + Print("*%02X\r\n", checksum);
}

std::string Rmc(const GnssMeasurement& m) {
  if (m.quality == 0) return Sentence("GPRMC," + TimeOfDay(m.time) + ",V,,,,,,," + Date(m.time) + ",,,N");
  return Sentence("GPRMC," + TimeOfDay(m.time) + ",A," + Position(m) + Print(",%.3f,", m.speed_mps * kKnotsPerMps) + Course(m.course_deg) + "," +
                  Date(m.time) + ",,," + Mode(m.quality));
}

std::string Gga(const GnssMeasurement& m) {
  if (m.quality == 0) return Sentence("GPGGA," + TimeOfDay(m.time) + ",,,,,0,00,99.9,,M,,M,,");
  return Sentence("GPGGA," + TimeOfDay(m.time) + "," + Position(m) +
                  Print(",%d,14,0.7,%.3f,M,%.3f,M,,", m.quality, m.msl_height_m, m.geoid_separation_m));
}

std::string Vtg(const GnssMeasurement& m) {
  if (m.quality == 0) return Sentence("GPVTG,,,,,,,,,N");
  return Sentence("GPVTG," + Course(m.course_deg) + ",T,,M," + Print("%.3f,N,%.3f,K,", m.speed_mps * kKnotsPerMps, m.speed_mps * kKmhPerMps) +
                  Mode(m.quality));
}

std::string Gst(const GnssMeasurement& m) {
  if (m.quality == 0) return Sentence("GPGST," + TimeOfDay(m.time) + ",,,,,,,");
  // The ellipse is a circle: its axes are the deviations, its direction is 0. The simulated height has the deviation of the other two axes.
  return Sentence("GPGST," + TimeOfDay(m.time) + Print(",%.3f,%.3f,%.3f,0.0,%.3f,%.3f,%.3f", m.sd_m, m.sd_m, m.sd_m, m.sd_m, m.sd_m, m.sd_m));
}

std::string Zda(Utime time) {
  const std::chrono::year_month_day date(std::chrono::floor<std::chrono::days>(time));
  return Sentence(
      "GPZDA," + TimeOfDay(time) +
      Print(",%02u,%02u,%04d,00,00", static_cast<unsigned>(date.day()), static_cast<unsigned>(date.month()), static_cast<int>(date.year())));
}

std::string Hdt(double heading_deg) { return Sentence("GPHDT," + Course(heading_deg) + ",T"); }

std::string Rot(double rate_degpmin) { return Sentence("GPROT," + Print("%.1f", rate_degpmin) + ",A"); }

std::string Pashr(const AttitudeMeasurement& m, double tilt_sd_deg, double heading_sd_deg) {
  // GNSS quality 2 is RTK, 1 any other position; INS status 1 is aligned: as Trimble and Applanix use them.
  return Sentence("PASHR," + TimeOfDay(m.time) + "," + Course(m.heading_deg) +
                  Print(",T,%+.2f,%+.2f,%+.2f,%.3f,%.3f,%.3f,%d,1", m.roll_deg, m.pitch_deg, m.heave_m, tilt_sd_deg, tilt_sd_deg, heading_sd_deg,
                        m.has_rtk ? 2 : 1));
}

std::string VnImu(const ImuMeasurement& m) {
  return Sentence("VNIMU" + Print(",%+08.4f,%+08.4f,%+08.4f", m.magnetic_gauss.x(), m.magnetic_gauss.y(), m.magnetic_gauss.z()) +
                  Print(",%+07.3f,%+07.3f,%+07.3f", m.specific_force_mps2.x(), m.specific_force_mps2.y(), m.specific_force_mps2.z()) +
                  Print(",%+010.6f,%+010.6f,%+010.6f", m.angular_rate_radps.x(), m.angular_rate_radps.y(), m.angular_rate_radps.z()) +
                  Print(",%+05.1f,%+08.3f", m.temperature_celsius, m.pressure_kpa));
}

}  // namespace lookout::sim
