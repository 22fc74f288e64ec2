// Times as people give them to a tool, and as tools write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/core/utime.hpp"

namespace lookout {

/// "2026-11-21T13:45:01.123456Z"
std::string TimeText(Utime time);

/// "83.123456 s"
std::string SecondsText(std::chrono::microseconds duration);

/// Times of the first and the last event of a log, or of several that are read as one.
struct LogSpan {
  Utime begin;
  Utime end;
};

/// "from 2026-11-21T13:45:01.123456Z to 2026-11-21T13:46:24.246912Z, 83.123456 s"
std::string SpanText(const LogSpan& span);

/// For the help of every option that takes a time.
inline constexpr const char* kTimeForms =
    "seconds from the start of the log (10, 90.5, 1:30), UTC (2026-08-29T10:00:00Z; 10:00:00Z is of the day of the log), or microseconds since 1970 "
    "(16 digits)";

/// A time that was given and is not yet brought to a log.
struct GivenTime {
  enum class Kind { kFromStart, kUtc, kTimeOfDay };
  Kind kind = Kind::kFromStart;
  std::chrono::microseconds value{0};  // since the start of the log, 1970, or midnight UTC
};

/// From the start of the log: "10", "+10", "90.5", "1:30", "1:02:03.5". UTC: "2026-08-29T10:00:00Z"; a time of day, "10:00:05Z". Seconds may have up
/// to six decimals. 16 digits: microseconds since 1970.
///
/// @return nullopt when it is none of them
std::optional<GivenTime> ParseGivenTime(std::string_view text);

/// The answer of a log to a given time.
struct TimeInLog {
  std::optional<Utime> time;  // nullopt: it is refused
  std::string fault;          // why, with the span of the log
};

/// @param option  "--from": begins the sentence of a fault
/// @return the time; refused where the text is none, or the time lies before or after the log by more than a second
TimeInLog FindTime(std::string_view option, std::string_view text, const LogSpan& log);

}  // namespace lookout
