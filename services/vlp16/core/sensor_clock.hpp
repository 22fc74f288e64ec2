// The relation of the sensor's clock to the host's, the sensor's knowledge of UTC, and which of the two clocks stamps a scan.
#pragma once

#include <chrono>
#include <optional>

#include "common/core/clock_fit.hpp"
#include "common/core/utime.hpp"
#include "services/vlp16/core/packet_sequencer.hpp"
#include "services/vlp16/core/position_packet.hpp"

namespace lookout::vlp16 {

enum class TimeChoice { kAuto, kSensor, kHost };
enum class TimeSource { kHost, kSensor };

/// The quality of the sensor's clock. "RMC" stands for any sentence that tells UTC: see TimeOfSentence.
enum class ClockState {
  kUnknown,            // no position packet, or none for 3 s (of the sensor's clock, which no stall and no step of the host's stretches)
  kNoPps,              // no PPS, and there was no lock since the sensor started: its hour began when it liked
  kAcquiring,          // PPS is there, the clock is being set to it
  kLockedWithoutTime,  // PPS is locked, but no valid RMC for 3 s says which second it is
  kLocked,             // PPS is locked, and the stamps are those of the RMC
  kFreeRunning,        // it was locked and the PPS is gone; or it says "locked", but its stamps are not those of its RMC
  kError,              // the sensor says that its PPS is wrong
};

/// The clock at one instant; a scan keeps that of its first column, so that times inside a scan are regular.
struct ClockReading {
  TimeSource source = TimeSource::kHost;
  std::chrono::microseconds offset{0};  // UTC minus SensorTime, by the clock that is in use: Utime(time + offset)
  ClockState state = ClockState::kUnknown;
  std::optional<int> pps;                                      // of the last position packet
  std::optional<std::chrono::microseconds> rmc_age;            // since a valid RMC told a new time, by the sensor's oscillator
  std::optional<std::chrono::microseconds> host_minus_sensor;  // UTC by the host's clock minus UTC by the sensor's
  std::optional<double> drift_ppm;                             // of the sensor's clock against the host's, positive when it is fast

  Utime ToUtime(SensorTime time) const { return Utime(time + offset); }
};

class SensorClock {
 public:
  explicit SensorClock(TimeChoice choice) : choice_(choice) {}

  /// A data packet, in order of sensor time.
  ///
  /// Host: UTC is the fit of (host - sensor): see ClockFit. Sensor: UTC is the stamp in the hour that is nearest to what the last valid RMC said,
  /// else to the host's clock. Once found, the hour is kept over the end of each hour, day and year, and through steps of less than half an hour; it
  /// is looked for again when it is more than 45 minutes off.
  void OnDataPacket(const PlacedPacket& packet);

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
    Instant came;  // when it told a new time
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
