// Faults that are ordered for a part of a run: KIND:BEGIN:END[:VALUE]. README.md says what each fault does to its sensor.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string_view>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::sim {

enum class TimedFaultKind {
  kDrop,
  kDouble,
  kSwap,
  kPpsLoss,
  kFreeRun,
  kWrongStamp,
  kWrongHour,
  kLateRmc,
  kGnssGap,
  kGnssJump,
  kFrozenHeading,
  kImuStop,
  kSensorRestart,
};

/// How a kind is written on the command line and in faults.csv.
struct TimedFaultForm {
  std::string_view name;
  std::string_view unit;  // unit of the value, for people; empty = the kind has no value
  std::optional<double> default_value{};
  double min_value = 0.0;
  double max_value = 0.0;
};

/// By TimedFaultKind.
inline constexpr std::array<TimedFaultForm, 13> kTimedFaultForms{{
    {"drop", "share of the data packets", std::nullopt, 0.0, 1.0},
    {"double", "share of the data packets", std::nullopt, 0.0, 1.0},
    {"swap", "share of the data packets", std::nullopt, 0.0, 1.0},
    {"pps_loss", "drift of the clock meanwhile, ppm", 5.0, -1000.0, 1000.0},  // 5 ppm: an ordinary oscillator without compensation
    {"free_run", "drift of the clock, ppm", 50.0, -10000.0, 10000.0},
    {"wrong_stamp", "seconds that the stamps are ahead", 1800.0, -3600.0, 3600.0},
    {"wrong_hour", "whole hours that the RMC is ahead", 1.0, -23.0, 23.0},
    {"late_rmc", "seconds", 1.0, 0.0, 10.0},
    {"gnss_gap", "", std::nullopt},
    {"gnss_jump", "metres to the east", 5.0, -1000.0, 1000.0},
    {"frozen_heading", "", std::nullopt},
    {"imu_stop", "", std::nullopt},
    {"sensor_restart", "seconds from its first packet to its lock", 5.0, 0.0, 3600.0},
}};

constexpr const TimedFaultForm& FormOf(TimedFaultKind kind) { return kTimedFaultForms[static_cast<std::size_t>(kind)]; }

struct TimedFault {
  TimedFaultKind kind = TimedFaultKind::kDrop;
  std::chrono::microseconds begin{0};  // since the start of the run
  std::chrono::microseconds end{0};    // no longer
  double value = 0.0;                  // in the unit of its form; 0 where there is none
};

/// @param text  KIND:BEGIN:END or KIND:BEGIN:END:VALUE, times in seconds since the start
/// @throws std::invalid_argument  with the text and what is wrong with it
TimedFault ParseTimedFault(std::string_view text);

/// The faults of a run.
class FaultPlan {
 public:
  FaultPlan() = default;  // none

  /// @param start  of the run
  /// @throws std::invalid_argument when two of a kind overlap, or shares of packets are more than 1 together
  FaultPlan(std::vector<TimedFault> faults, Utime start);

  /// @return the fault of that kind at that time; nullptr = none
  const TimedFault* At(TimedFaultKind kind, Utime time) const;

  /// Its value; 0 where there is no fault of that kind.
  double ValueAt(TimedFaultKind kind, Utime time) const;

  /// @return the last fault of that kind that has begun by then, also when it is over; nullptr = none
  const TimedFault* LastBegun(TimedFaultKind kind, Utime time) const;

  /// By begin.
  const std::vector<TimedFault>& faults() const { return faults_; }

  Utime Begin(const TimedFault& fault) const { return start_ + fault.begin; }
  Utime End(const TimedFault& fault) const { return start_ + fault.end; }

 private:
  std::vector<TimedFault> faults_;
  Utime start_{};
};

}  // namespace lookout::sim
