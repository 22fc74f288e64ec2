// The sensor's clock at one instant: its quality, its relation to the host's, and which of the two stamps a scan.
#pragma once

#include <chrono>
#include <optional>

#include "common/core/utime.hpp"

namespace lookout::lidar {

/// Time by the sensor's oscillator, that goes on evenly: where the sensor's clock is set (by PPS, PTP, in a leap second) it does not step. Between it
/// and the stamps stands StampOf(time) - time, which changes at such a step only. It begins anew at a restart.
using SensorTime = std::chrono::microseconds;

enum class TimeChoice { kAuto, kSensor, kHost };
enum class TimeSource { kHost, kSensor };

/// The quality of the sensor's clock. "RMC" stands for any sentence that tells UTC: see TimeOfSentence. A sensor that stamps with the whole time
/// since 1970 is kLocked while its clock is within 0.25 s of the host's, else kFreeRunning.
enum class ClockState {
  kUnknown,            // no position packet, or none for 3 s (of the sensor's clock, which no stall and no step of the host's stretches)
  kNoPps,              // no PPS, and no lock since the sensor started: the sensor's hour began at an arbitrary time
  kAcquiring,          // PPS is there, the sensor's clock is being set to it
  kLockedWithoutTime,  // PPS is locked, but no valid RMC for 3 s says which second it is
  kLocked,             // PPS is locked, and the stamps agree with the RMC
  kFreeRunning,        // the clock was locked and the PPS is gone; or the sensor says "locked", but its stamps do not agree with its RMC
  kError,              // the sensor says that its PPS is wrong
};

/// A scan keeps the reading of its first column, so that times inside a scan are regular.
struct ClockReading {
  TimeSource source = TimeSource::kHost;
  std::chrono::microseconds offset{0};  // UTC minus SensorTime, by the clock that is in use: Utime(time + offset)
  ClockState state = ClockState::kUnknown;
  std::optional<int> pps;                                      // of the last position packet
  std::optional<std::chrono::microseconds> rmc_age;            // since a valid RMC told a new time, by the sensor's oscillator
  std::optional<std::chrono::microseconds> host_minus_sensor;  // UTC by the host's clock minus UTC by the sensor's
  std::optional<double> drift_ppm;                             // of the sensor's clock against the host's, positive when the sensor's is fast

  Utime ToUtime(SensorTime time) const { return Utime(time + offset); }
};

}  // namespace lookout::lidar
