// Time of measurement: microseconds since 1970-01-01 00:00 UTC, leap seconds not counted.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

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

constexpr std::int64_t ToUtimeUs(Utime time) { return time.time_since_epoch().count(); }

/// Seconds, for formulas.
constexpr double ToSeconds(std::chrono::nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace lookout
