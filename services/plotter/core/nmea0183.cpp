#include "services/plotter/core/nmea0183.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/sentence.hpp"

namespace lookout::plotter {

namespace {

using namespace std::chrono_literals;

constexpr double kMetresPerNauticalMile = 1852.0;
constexpr double kSecondsPerHour = 3600.0;

double MetresIn(Unit unit) { return unit == Unit::kKilometres ? 1000.0 : kMetresPerNauticalMile; }
char LetterOf(Unit unit) { return unit == Unit::kKilometres ? 'K' : 'N'; }

// Empty where it is not known. A number that rounds to zero has no sign.
std::string Number(double value, int decimals) {
  if (!std::isfinite(value)) return {};
  auto text = fmt::format("{:.{}f}", value, decimals);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

// 0.00 to 359.99.
std::string Degrees(double angle_rad) {
  if (!std::isfinite(angle_rad)) return {};
  const auto text = Number(RadToDeg(WrapTo2Pi(angle_rad)), 2);
  return text == "360.00" ? "0.00" : text;
}

std::string Speed(double speed_mps, Unit unit) { return Number(speed_mps * kSecondsPerHour / MetresIn(unit), 2); }

std::string Date(Utime time) {
  const std::chrono::year_month_day day(std::chrono::floor<std::chrono::days>(time));
  return fmt::format("{:02}{:02}{:02}", static_cast<unsigned>(day.day()), static_cast<unsigned>(day.month()), static_cast<int>(day.year()) % 100);
}

// ddmm.mmmmmm,S: 2 mm. In whole millionths of a minute, so that 59.9999999 does not become 60.
std::string Angle(double angle_deg, int num_degree_digits, char positive, char negative) {
  constexpr std::int64_t kPerDegree = 60'000'000;
  const auto millionths = std::llround(std::fabs(angle_deg) * static_cast<double>(kPerDegree));
  const auto minutes = millionths % kPerDegree;
  return fmt::format("{:0{}}{:02}.{:06},{}", millionths / kPerDegree, num_degree_digits, minutes / 1'000'000, minutes % 1'000'000,
                     angle_deg < 0.0 ? negative : positive);
}

std::string PositionFields(const Position& position) {
  return Angle(position.latitude_deg, 2, 'N', 'S') + "," + Angle(position.longitude_deg, 3, 'E', 'W');
}

char LetterOf(TargetState state) {
  switch (state) {
    case TargetState::kAcquiring:
      return 'Q';
    case TargetState::kLost:
      return 'L';
    default:
      return 'T';
  }
}

// The name where it fits, else the number at its end.
std::string NameWithin(const Target& target, std::size_t max_bytes) {
  const auto& name = AsciiNameOf(target, max_bytes);
  if (name.size() <= max_bytes) return FieldText(name, max_bytes);
  const auto last_word = name.rfind(' ');
  return FieldText(last_word == std::string::npos ? name : name.substr(last_word + 1), max_bytes);
}

}  // namespace

std::size_t RoomFor(std::string_view before, std::string_view after) {
  constexpr std::size_t kFrame = 6;  // $ * two digits CR LF
  const auto used = before.size() + after.size() + kFrame;
  return used < kMaxSentenceBytes ? kMaxSentenceBytes - used : 0;
}

std::string TimeOfDay(Utime time) {
  const auto since_midnight = time - std::chrono::floor<std::chrono::days>(time);
  const std::chrono::hh_mm_ss parts(std::chrono::floor<std::chrono::microseconds>(since_midnight));
  return fmt::format("{:02}{:02}{:02}.{:02}", parts.hours().count(), parts.minutes().count(), parts.seconds().count(), parts.subseconds() / 10ms);
}

std::string Sentence(std::string_view body) { return WithChecksum(body) + "\r\n"; }

std::string FieldText(std::string_view text, std::size_t max_bytes) {
  constexpr std::string_view kReserved = "$*,!\\^~";
  std::string field(text.substr(0, max_bytes));
  std::ranges::replace_if(
      field, [&](char letter) { return letter < ' ' || letter > '~' || kReserved.find(letter) != std::string_view::npos; }, ' ');
  return field;
}

std::string Rmc(std::string_view talker, const OwnShip& own) {
  if (!own.is_placed()) return Sentence(fmt::format("{}RMC,{},V,,,,,,,{},,,N", talker, TimeOfDay(own.time), Date(own.time)));
  return Sentence(fmt::format("{}RMC,{},{},{},{},{},{},,,{}", talker, TimeOfDay(own.time), own.is_estimated ? 'V' : 'A', PositionFields(own.position),
                              Speed(own.speed_mps, Unit::kNauticalMiles), Degrees(own.course_rad), Date(own.time), own.is_estimated ? 'E' : 'A'));
}

std::optional<std::string> Hdt(std::string_view talker, const OwnShip& own) {
  if (!std::isfinite(own.heading_rad) || own.is_estimated) return std::nullopt;
  return Sentence(fmt::format("{}HDT,{},T", talker, Degrees(own.heading_rad)));
}

std::string Osd(std::string_view talker, const OwnShip& own, Unit unit) {
  return Sentence(fmt::format("{}OSD,{},{},{},P,{},P,,,{}", talker, Degrees(own.heading_rad),
                              std::isfinite(own.heading_rad) && !own.is_estimated ? 'A' : 'V', Degrees(own.course_rad), Speed(own.speed_mps, unit),
                              LetterOf(unit)));
}

std::string Ttm(std::string_view talker, const OwnShip& own, const Target& target, int number, Unit unit) {
  constexpr double kSecondsPerMinute = 60.0;
  const auto relative = RangeAndBearingOf(own.position, target.position);
  const auto before = fmt::format("{}TTM,{:02},{},{},T,{},{},{},{},{},{},", talker, number, Number(relative.range_m / MetresIn(unit), 4),
                                  Degrees(relative.bearing_rad), Speed(target.speed_mps, unit), Degrees(target.course_rad),
                                  std::isfinite(target.course_rad) ? "T" : "", Number(target.cpa_m / MetresIn(unit), 4),
                                  Number(target.tcpa_s / kSecondsPerMinute, 3), LetterOf(unit));
  // Time and way of acquisition are of version 3 on; they give way to names that people gave, and to numbers of more digits than any target at sea
  // has.
  const std::size_t least_name = target.given_name.empty() ? 6 : target.given_name.size();
  auto after = fmt::format(",{},,{},A", LetterOf(target.state), TimeOfDay(own.time));
  if (RoomFor(before, after) < least_name) after = fmt::format(",{},", LetterOf(target.state));
  return Sentence(before + NameWithin(target, RoomFor(before, after)) + after);
}

std::string Tll(std::string_view talker, const Target& target, int number, Utime time) {
  const auto before = fmt::format("{}TLL,{:02},{},", talker, number, PositionFields(target.position));
  const auto after = fmt::format(",{},{},", TimeOfDay(time), LetterOf(target.state));
  return Sentence(before + NameWithin(target, RoomFor(before, after)) + after);
}

}  // namespace lookout::plotter
