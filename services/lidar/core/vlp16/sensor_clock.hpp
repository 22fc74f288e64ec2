// The relation of the sensor's clock to the host's, the sensor's knowledge of UTC, and which of the two clocks stamps a scan.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "common/core/clock_fit.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/core/driver/clock_reading.hpp"
#include "services/lidar/core/vlp16/position_packet.hpp"

namespace lookout::vlp16 {

using lidar::ClockReading;
using lidar::ClockState;
using lidar::SensorTime;
using lidar::TimeChoice;
using lidar::TimeSource;

/// The parts of a data packet that the clock uses.
struct StampedPacket {
  Utime host_time;
  SensorTime time{0};                     // of the packet's stamp
  std::chrono::microseconds duration{0};  // from the stamp to the end of the packet, when it was sent
  std::uint32_t stamp_us = 0;             // past the hour
  bool is_restart = true;
};

class SensorClock {
 public:
  explicit SensorClock(TimeChoice choice) : choice_(choice) {}

  /// A data packet, in order of sensor time.
  ///
  /// Host: UTC is the fit of (host - sensor): see ClockFit. Sensor: UTC is the stamp in the hour that is nearest to what the last valid RMC said,
  /// else to the host's clock. Once found, the hour is kept over the end of each hour, day and year, and through steps of less than half an hour;
  /// when the hour is more than 45 minutes off it is looked for again.
  void OnDataPacket(const StampedPacket& packet);

  /// @param time  of the packet's stamp; nullopt before the first data packet
  void OnPositionPacket(Utime host_time, const PositionPacket& packet, std::optional<SensorTime> time);

  /// Precondition: OnDataPacket.
  ///
  /// TimeChoice::kAuto uses the sensor's clock while it is locked and the host's agrees with it, else the host's.
  ClockReading Read(Utime host_time);

  /// Time of a stamp while no data packet has come: of the sensor where it is in use, else the host's.
  Utime TimeOfStampAlone(Utime host_time, std::uint32_t stamp_us) const;

 private:
  /// The time at which something came. Late deliveries, and a host's clock that is set, change its host time only.
  struct Instant {
    Utime host_time;
    std::optional<SensorTime> time;  // nullopt before the first data packet, and of arrivals before a restart
  };
  struct Rmc {
    Instant came;  // when an RMC told a new time
    std::chrono::microseconds utc{0};
    bool is_agreeing = true;  // with the stamp of the position packet in which it was new
  };

  static std::chrono::microseconds Age(const Instant& came, const Instant& now);
  ClockState State(const Instant& now) const;
  bool IsSensorInUse(ClockState state, std::chrono::microseconds host_minus_sensor) const;
  void FindHour(std::uint32_t stamp_us, SensorTime time);

  TimeChoice choice_;
  ClockFit fit_;                                         // of host minus SensorTime
  std::optional<std::chrono::microseconds> sensor_utc_;  // UTC by the sensor minus SensorTime
  std::optional<std::chrono::microseconds> rmc_utc_;     // UTC by the last valid RMC minus SensorTime, good to some seconds
  bool is_sensor_in_use_ = false;

  std::optional<SensorTime> time_;  // of the last data packet
  std::optional<Instant> position_came_;
  int pps_ = 0;
  bool has_valid_rmc_ = false;  // in the last position packet
  std::optional<Rmc> rmc_;
  bool was_locked_ = false;  // since the sensor started
};

}  // namespace lookout::vlp16
