// Time of measurement: microseconds since 1970-01-01 00:00 UTC, leap seconds not counted.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <ratio>

namespace lookout {

/// A point in time, UTC. Differences are std::chrono::microseconds.
using Utime = std::chrono::sys_time<std::chrono::microseconds>;

/// Bounds of what is accepted from outside, so that arithmetic cannot overflow: 1900-01-01 to 2200-01-01.
inline constexpr std::int64_t kMinUtimeUs = -2'208'988'800'000'000;
inline constexpr std::int64_t kMaxUtimeUs = 7'258'118'400'000'000;

/// @return nullopt when `utime_us` is outside of kMinUtimeUs to kMaxUtimeUs
constexpr std::optional<Utime> UtimeFromWire(std::int64_t utime_us) {
  if (utime_us < kMinUtimeUs || utime_us > kMaxUtimeUs) return std::nullopt;
  return Utime(std::chrono::microseconds(utime_us));
}

/// @return the time of day on that day which brings it nearest to `near`
constexpr Utime OnTheDayNearest(Utime near, std::chrono::microseconds time_of_day) {
  return std::chrono::floor<std::chrono::days>(near - time_of_day + std::chrono::hours(12)) + time_of_day;
}

/// GPS counts weeks in 10 bits: receivers of the first kind fall back by so much when the count rolls over.
using WeekRollovers = std::chrono::duration<std::int64_t, std::ratio_multiply<std::chrono::weeks::period, std::ratio<1024>>>;

/// @return `utc` and the whole number of rollovers that brings it within a day of `near`; `utc` itself where none does: then the computer's clock may
/// be wrong
constexpr Utime MendRollover(Utime utc, Utime near) {
  const Utime mended = utc + std::chrono::round<WeekRollovers>(near - utc);
  return std::chrono::abs(near - mended) <= std::chrono::days(1) ? mended : utc;
}

constexpr std::int64_t ToUtimeUs(Utime time) { return time.time_since_epoch().count(); }

/// Seconds, for formulas.
constexpr double ToSeconds(std::chrono::nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace lookout
