// NMEA 0183 text for tests.
#pragma once

#include <chrono>
#include <cstdarg>
#include <cstdio>
#include <string>
#include <string_view>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::navigator {

/// printf into a string.
__attribute__((format(printf, 1, 2))) inline std::string Print(const char* form, ...) {
  char text[256] = {};
  va_list arguments;
  va_start(arguments, form);
  std::vsnprintf(text, sizeof(text), form, arguments);
  va_end(arguments);
  return text;
}

/// @param body  between $ and *
inline std::string Line(std::string_view body, char start = '$') {
  unsigned checksum = 0;
  for (const char character : body) checksum ^= static_cast<unsigned char>(character);
  return start + std::string(body) + Print("*%02X", checksum);
}

inline Bytes ToBytes(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

/// 2026-06-01, 12:00 UTC, and so many seconds.
inline Utime NoonPlus(double seconds) {
  using namespace std::chrono;
  return sys_days(2026y / June / 1) + hours(12) + microseconds(static_cast<std::int64_t>(seconds * 1e6 + (seconds < 0 ? -0.5 : 0.5)));
}

/// hhmmss.ssssss
inline std::string TimeOfDay(Utime time) {
  const std::chrono::hh_mm_ss clock(time - std::chrono::floor<std::chrono::days>(time));
  return Print("%02d%02d%02d.%06d", static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
               static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
}

/// dddmm.mmmmmmmm and its hemisphere; `num_degree_digits` is 2 for latitudes, 3 for longitudes.
inline std::string Angle(double angle_deg, int num_degree_digits, char positive, char negative) {
  const double size_deg = angle_deg < 0 ? -angle_deg : angle_deg;
  const auto units = static_cast<long long>(size_deg * 60e8 + 0.5);
  const long long minute_units = 60LL * 100'000'000;
  return Print("%0*lld%02lld.%08lld,%c", num_degree_digits, units / minute_units, units % minute_units / 100'000'000, units % 100'000'000,
               angle_deg < 0 ? negative : positive);
}

inline std::string RmcLine(Utime time, double latitude_deg, double longitude_deg, double speed_mps, double course_deg) {
  const std::chrono::year_month_day date(std::chrono::floor<std::chrono::days>(time));
  return Line("GPRMC," + TimeOfDay(time) + ",A," + Angle(latitude_deg, 2, 'N', 'S') + "," + Angle(longitude_deg, 3, 'E', 'W') +
              Print(",%.6f,%.4f,%02u%02u%02d,,,A", speed_mps * 3600.0 / 1852.0, course_deg, static_cast<unsigned>(date.day()),
                    static_cast<unsigned>(date.month()), static_cast<int>(date.year()) % 100));
}

inline std::string GgaLine(Utime time, double latitude_deg, double longitude_deg, int quality, double hdop, double msl_height_m,
                           double separation_m) {
  return Line("GPGGA," + TimeOfDay(time) + "," + Angle(latitude_deg, 2, 'N', 'S') + "," + Angle(longitude_deg, 3, 'E', 'W') +
              Print(",%d,12,%.2f,%.4f,M,%.4f,M,,", quality, hdop, msl_height_m, separation_m));
}

inline std::string HdtLine(double heading_deg) { return Line(Print("GPHDT,%.4f,T", heading_deg)); }

inline std::string PashrLine(Utime time, double heading_deg, double roll_deg, double pitch_deg, double heave_m) {
  return Line("PASHR," + TimeOfDay(time) + Print(",%.4f,T,%+.4f,%+.4f,%+.4f,0.050,0.060,0.100,1,1", heading_deg, roll_deg, pitch_deg, heave_m));
}

}  // namespace lookout::navigator
