#include "common/core/log_time.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <vector>

namespace lookout {

namespace {

using std::chrono::microseconds;

constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;
constexpr std::size_t kDigitsOfMicroseconds = 16;
// The length of a log is told in whole seconds, and a measurement is a little older than its event.
constexpr std::chrono::seconds kSlack(1);

// Digits only: no sign, no blank.
std::optional<std::int64_t> ParseDigits(std::string_view text) {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  std::int64_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc()) return std::nullopt;
  return value;
}

// "12" or "12.5"
std::optional<microseconds> ParseSeconds(std::string_view text) {
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
  return microseconds(*whole * kMicrosecondsPerSecond + fraction_us);
}

std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (auto end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  parts.push_back(text);
  return parts;
}

// "1:30", "1:02:03.5": each part behind the first colon is below 60. "12.5" alone may be any number.
std::optional<microseconds> ParseClock(std::string_view text) {
  const auto parts = Split(text, ':');
  if (parts.size() > 3) return std::nullopt;
  auto sum = ParseSeconds(parts.back());
  if (!sum || (parts.size() > 1 && *sum >= std::chrono::minutes(1))) return std::nullopt;
  std::int64_t unit_s = 60;
  for (auto part = parts.rbegin() + 1; part != parts.rend(); ++part, unit_s *= 60) {
    const auto number = ParseDigits(*part);
    const bool is_first = part + 1 == parts.rend();
    if (!number || (is_first ? *number > kMaxUtimeUs / kMicrosecondsPerSecond / unit_s : *number >= 60)) return std::nullopt;
    *sum += std::chrono::seconds(*number * unit_s);
  }
  return sum;
}

// "10:00:05.5", "10:00"
std::optional<microseconds> ParseTimeOfDay(std::string_view text) {
  const auto parts = Split(text, ':');
  if (parts.size() < 2 || parts.size() > 3) return std::nullopt;
  for (const auto part : parts) {
    if (part.substr(0, part.find('.')).size() != 2) return std::nullopt;
  }
  if (parts.size() == 2 && parts.back().find('.') != std::string_view::npos) return std::nullopt;
  const auto time = ParseClock(std::string(text) + (parts.size() == 2 ? ":00" : ""));
  return time && *time < std::chrono::days(1) ? time : std::nullopt;
}

// "2026-08-29"
std::optional<std::chrono::sys_days> ParseDate(std::string_view text) {
  const auto parts = Split(text, '-');
  if (parts.size() != 3 || parts[0].size() != 4 || parts[1].size() != 2 || parts[2].size() != 2) return std::nullopt;
  const auto year = ParseDigits(parts[0]);
  const auto month = ParseDigits(parts[1]);
  const auto day = ParseDigits(parts[2]);
  if (!year || !month || !day) return std::nullopt;
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(*year)), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day)));
  return date.ok() ? std::optional(std::chrono::sys_days(date)) : std::nullopt;
}

// A text that ends in Z.
std::optional<GivenTime> ParseUtc(std::string_view text) {
  const auto behind_date = text.find('T');
  if (behind_date == std::string_view::npos) {
    const auto time_of_day = ParseTimeOfDay(text);
    return time_of_day ? std::optional(GivenTime{GivenTime::Kind::kTimeOfDay, *time_of_day}) : std::nullopt;
  }
  const auto date = ParseDate(text.substr(0, behind_date));
  const auto time_of_day = ParseTimeOfDay(text.substr(behind_date + 1));
  if (!date || !time_of_day) return std::nullopt;
  const auto since_1970 = (*date + *time_of_day).time_since_epoch();
  return UtimeFromWire(since_1970.count()) ? std::optional(GivenTime{GivenTime::Kind::kUtc, since_1970}) : std::nullopt;
}

// "10:00:05Z" in a log of several days is several times.
std::vector<Utime> TimesOfDayWithin(microseconds time_of_day, const LogSpan& log) {
  std::vector<Utime> times;
  constexpr std::size_t kEnough = 2;
  for (auto day = std::chrono::floor<std::chrono::days>(log.begin - kSlack); day <= log.end + kSlack && times.size() < kEnough;
       day += std::chrono::days(1)) {
    const Utime time = day + time_of_day;
    if (time >= log.begin - kSlack && time <= log.end + kSlack) times.push_back(time);
  }
  return times;
}

std::string Quoted(std::string_view option, std::string_view text) { return std::string(option) + " " + std::string(text); }

}  // namespace

std::string TimeText(Utime time) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(time - day);
  std::array<char, 80> text{};
  const int size = std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02d.%06dZ", static_cast<int>(date.year()),
                                 static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()),
                                 static_cast<int>(clock.minutes().count()), static_cast<int>(clock.seconds().count()),
                                 static_cast<int>(clock.subseconds().count()));
  return {text.data(), static_cast<std::size_t>(size)};
}

std::string SecondsText(microseconds duration) {
  const auto magnitude = std::abs(duration.count());
  const auto decimals = std::to_string(kMicrosecondsPerSecond + magnitude % kMicrosecondsPerSecond).substr(1);
  return (duration.count() < 0 ? "-" : "") + std::to_string(magnitude / kMicrosecondsPerSecond) + "." + decimals + " s";
}

std::string SpanText(const LogSpan& span) {
  return "from " + TimeText(span.begin) + " to " + TimeText(span.end) + ", " + SecondsText(span.end - span.begin);
}

std::optional<GivenTime> ParseGivenTime(std::string_view text) {
  if (text.ends_with('Z')) return ParseUtc(text.substr(0, text.size() - 1));
  if (text.size() == kDigitsOfMicroseconds) {
    if (const auto utime_us = ParseDigits(text)) {
      return UtimeFromWire(*utime_us) ? std::optional(GivenTime{GivenTime::Kind::kUtc, microseconds(*utime_us)}) : std::nullopt;
    }
  }
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto since_start = ParseClock(text);
  return since_start ? std::optional(GivenTime{GivenTime::Kind::kFromStart, *since_start}) : std::nullopt;
}

TimeInLog FindTime(std::string_view option, std::string_view text, const LogSpan& log) {
  const auto given = ParseGivenTime(text);
  if (!given) return {std::nullopt, Quoted(option, text) + ": is no time; give " + kTimeForms + ". The log goes " + SpanText(log)};
  std::optional<Utime> time;
  if (given->kind == GivenTime::Kind::kTimeOfDay) {
    const auto times = TimesOfDayWithin(given->value, log);
    if (times.size() > 1) {
      return {std::nullopt, Quoted(option, text) + ": is more than one time of the log, which goes " + SpanText(log) + "; give the day too, " +
                                TimeText(times.front()) + " or " + TimeText(times.back())};
    }
    if (!times.empty()) time = times.front();
  } else {
    time = given->kind == GivenTime::Kind::kUtc ? Utime(given->value) : UtimeFromWire(ToUtimeUs(log.begin) + given->value.count());
  }
  const bool goes_back = log.end < log.begin;  // the host's clock was set: nobody knows which times lie outside
  if (!time || (!goes_back && (*time < log.begin - kSlack || *time > log.end + kSlack))) {
    return {std::nullopt, Quoted(option, text) + ": lies outside of the log, which goes " + SpanText(log)};
  }
  return {time, ""};
}

}  // namespace lookout
