// The lidar's own clock, and what its GNSS line tells it: right, or as the faults of a run have it.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "common/core/utime.hpp"
#include "lab/sim/fault_plan.hpp"

namespace lookout::sim {

/// From the whole second that an RMC tells to its last character in the lidar: the lidar's line has 9600 baud, 80 characters take 83 ms.
inline constexpr std::chrono::milliseconds kLidarRmcLatency{150};

class LidarClock {
 public:
  /// From the return of the PPS to the lock, and from a start to the first PPS. Assumptions: no recording of either was at hand.
  static constexpr std::chrono::seconds kAcquiring{3};
  /// A PPS that is gone is noticed when the next one does not come.
  static constexpr std::chrono::seconds kPpsNoticed{1};

  /// @param plan  outlives this
  explicit LidarClock(const FaultPlan& plan) : plan_(plan) {}

  /// @return whether the lidar has power
  bool IsOn(Utime time) const;

  /// Precondition: IsOn.
  /// @return microseconds past the hour, as data and position packets say them
  std::uint32_t StampUs(Utime time) const;

  /// Precondition: IsOn.
  /// @return PPS byte of a position packet
  std::uint8_t Pps(Utime time) const;

  /// @return the whole second of the last RMC that the lidar has got since it was switched on, not older than kOldestRmc; nullopt = none
  std::optional<Utime> SecondOfRmc(Utime time) const;
  static constexpr std::chrono::seconds kOldestRmc{12};

  /// How far ahead of the truth the time of day and date in the RMC of that second are.
  std::chrono::hours RmcError(Utime second) const;

 private:
  const TimedFault* RestartBefore(Utime time) const;
  Utime LockAfter(const TimedFault& restart) const;

  const FaultPlan& plan_;
};

}  // namespace lookout::sim
