// When each datagram of a live simulation is due, and whether it goes out then.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "common/core/utime.hpp"

namespace lookout::sim {

/// Each datagram has a deadline of its own, so delays do not add up. What goes out too late is told: a service that hears it takes it for a late
/// sensor.
class Schedule {
 public:
  using Clock = std::chrono::steady_clock;

  /// Later than this is behind. Half a scan; a busy computer wakes up within some 10 ms.
  static constexpr std::chrono::milliseconds kLate{50};
  static constexpr std::chrono::seconds kTellEvery{1};

  /// @param start  of the simulation, due at `base`
  /// @param speed  times real time; 0 = everything is due at once, and nothing is late
  Schedule(Utime start, Clock::time_point base, double speed) : start_(start), base_(base), speed_(speed) {}

  Clock::time_point DueAt(Utime time) const;

  /// A datagram goes out.
  /// @return where it is behind, and nothing was told within the last kTellEvery: by how much
  std::optional<std::string> Tell(Utime time, Clock::time_point now);

  /// @return how many went out late and by how much at most; empty when none did
  std::string Summary() const;

 private:
  Utime start_;
  Clock::time_point base_;
  double speed_;
  std::int64_t num_sent_ = 0;
  std::int64_t num_late_ = 0;
  Clock::duration greatest_{};
  std::optional<Clock::time_point> last_told_;
};

}  // namespace lookout::sim
