// How the sensor's clock and the host's stand to each other, and which of them stamps a turn.
#pragma once

#include <chrono>
#include <deque>
#include <optional>

#include "common/core/utime.hpp"
#include "services/vlp16/core/packet_order.hpp"
#include "services/vlp16/core/position_packet.hpp"

namespace lookout::vlp16 {

enum class TimeChoice { kAuto, kSensor, kHost };
enum class TimeSource { kHost, kSensor };

/// kUnknown: no position packet, or none of late. kLockedWithoutTime: PPS is locked, but no valid RMC says of which second.
enum class ClockState { kUnknown, kNoPps, kAcquiring, kLockedWithoutTime, kLocked, kError };

/// What the clock says at one instant; a turn keeps that of its first column, so that times inside a turn are regular.
struct ClockReading {
  TimeSource source = TimeSource::kHost;
  std::chrono::microseconds offset{0};  // UTC minus sensor time, by the clock that is in use: Utime(time + offset)
  ClockState state = ClockState::kUnknown;
  std::optional<int> pps;                                      // of the last position packet
  std::optional<std::chrono::microseconds> rmc_age;            // since the last position packet with a valid RMC, by the host's clock
  std::optional<std::chrono::microseconds> host_minus_sensor;  // sensor time in the hour that brings it nearest to the host's

  Utime ToUtime(SensorTime time) const { return Utime(time + offset); }
};

class SensorClock {
 public:
  explicit SensorClock(TimeChoice choice) : choice_(choice) {}

  /// @param host_time  when the packet had arrived: it is sent after its last shot
  /// @param time       of its first shot
  /// @param duration   from its first shot to its end
  void OnDataPacket(Utime host_time, SensorTime time, std::chrono::nanoseconds duration);
  void OnPositionPacket(Utime host_time, const PositionPacket& packet);

  /// Sensor time went elsewhere: what was learnt of its relation to the host is void.
  void ForgetOffset();

  /// Precondition: OnDataPacket since the start and since ForgetOffset.
  ///
  /// Source host: the offset is the least (host - sensor) of the last two seconds of sensor time, since a datagram may come late but not
  /// early. Source sensor: the offset is the number of whole hours that brings sensor time nearest to the host's.
  ClockReading Read(Utime host_time) const;

  /// Time of a stamp while no data packet has come: of the sensor where it is in use, else the host's.
  Utime TimeOfStampAlone(Utime host_time, std::uint32_t stamp_us) const;

 private:
  struct Sample {
    SensorTime time;
    std::chrono::microseconds host_minus_sensor;
  };
  ClockState State(Utime host_time) const;
  bool IsSensorInUse(ClockState state, std::chrono::microseconds host_minus_sensor) const;

  TimeChoice choice_;
  std::deque<Sample> minima_;  // of the window: increasing in time and in offset, so that the first is the least
  int num_off_ = 0;            // samples in a row that are far off the window
  std::optional<Utime> position_host_time_;
  std::optional<Utime> rmc_host_time_;
  int pps_ = 0;
  bool has_valid_rmc_ = false;
};

}  // namespace lookout::vlp16
