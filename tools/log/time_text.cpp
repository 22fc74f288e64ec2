#include "tools/log/time_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdlib>

namespace lookout::log {

namespace {

constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;

// Digits only: no sign, no blank.
std::optional<std::int64_t> ParseDigits(std::string_view text) {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  std::int64_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc()) return std::nullopt;
  return value;
}

// "12" or "12.5", to microseconds.
std::optional<std::int64_t> ParseSecondsUs(std::string_view text) {
  const auto dot = text.find('.');
  const auto whole = ParseDigits(text.substr(0, dot));
  if (!whole || *whole > kMaxUtimeUs / kMicrosecondsPerSecond) return std::nullopt;
  std::int64_t fraction_us = 0;
  if (dot != std::string_view::npos) {
    std::string decimals(text.substr(dot + 1));
    if (decimals.empty() || decimals.size() > 6) return std::nullopt;
    decimals.resize(6, '0');
    const auto fraction = ParseDigits(decimals);
    if (!fraction) return std::nullopt;
    fraction_us = *fraction;
  }
  return *whole * kMicrosecondsPerSecond + fraction_us;
}

std::optional<Utime> ParseUtc(std::string_view text) {
  // 0123456789012345678
  // 2026-11-21T13:45:01.123456Z
  if (text.size() < 20 || text[4] != '-' || text[7] != '-' || text[10] != 'T' || text[13] != ':' || text[16] != ':' || text.back() != 'Z') {
    return std::nullopt;
  }
  const auto year = ParseDigits(text.substr(0, 4));
  const auto month = ParseDigits(text.substr(5, 2));
  const auto day = ParseDigits(text.substr(8, 2));
  const auto hour = ParseDigits(text.substr(11, 2));
  const auto minute = ParseDigits(text.substr(14, 2));
  const auto second_us = ParseSecondsUs(text.substr(17, text.size() - 18));
  if (!year || !month || !day || !hour || !minute || !second_us) return std::nullopt;
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(*year)), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day)));
  if (!date.ok() || *hour > 23 || *minute > 59 || *second_us >= 60 * kMicrosecondsPerSecond) return std::nullopt;
  const Utime time = std::chrono::sys_days(date) + std::chrono::hours(*hour) + std::chrono::minutes(*minute) + std::chrono::microseconds(*second_us);
  return UtimeFromWire(ToUtimeUs(time));
}

}  // namespace

std::string TimeText(Utime time) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(time - day);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()), clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     clock.subseconds().count());
}

std::string SecondsText(std::chrono::microseconds duration) {
  const auto microseconds = std::abs(duration.count());
  return fmt::format("{}{}.{:06} s", duration.count() < 0 ? "-" : "", microseconds / kMicrosecondsPerSecond, microseconds % kMicrosecondsPerSecond);
}

std::optional<Utime> ParseTime(std::string_view text, Utime start) {
  if (const auto offset_us = ParseSecondsUs(text)) return UtimeFromWire(ToUtimeUs(start) + *offset_us);
  return ParseUtc(text);
}

}  // namespace lookout::log
