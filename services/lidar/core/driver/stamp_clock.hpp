// The clock of a sensor that stamps with the whole time: since 1970 where it is set, else since its start.
#pragma once

#include <chrono>
#include <optional>

#include "common/core/clock_fit.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/core/driver/clock_reading.hpp"

namespace lookout::lidar {

/// By the host's clock UTC is the fit of (host - sensor): see ClockFit; by the sensor's it is the stamp. No packet says whether the sensor's clock is
/// set, so the host's decides: TimeChoice::kAuto uses the sensor's while both agree to 0.25 s. TAI, GPS time and the time since start do not.
class StampClock {
 public:
  explicit StampClock(TimeChoice choice) : choice_(choice) {}

  /// A data packet, in order of sensor time.
  ///
  /// @param stamp     at `time`
  /// @param duration  from the stamp to its end, when it was sent
  void OnDataPacket(Utime host_time, SensorTime time, std::chrono::microseconds stamp, std::chrono::microseconds duration, bool is_restart);

  /// Precondition: OnDataPacket.
  ClockReading Read();

 private:
  TimeChoice choice_;
  ClockFit fit_;
  std::chrono::microseconds stamp_{0};  // of the last packet
  std::chrono::microseconds stamp_minus_time_{0};
  bool is_sensor_in_use_ = false;
};

}  // namespace lookout::lidar
