#include "services/vlp16/core/sensor_clock.hpp"

#include "services/vlp16/core/packet_format.hpp"

namespace lookout::vlp16 {

namespace {

using std::chrono::microseconds;

// Long enough that some datagram came without delay, short enough that two free clocks (50 ppm) drift by 0.1 ms only.
constexpr microseconds kOffsetWindow = std::chrono::seconds(2);
// Position packets come about every 7 ms, and the sensor tells of a lost PPS within a second or two.
constexpr microseconds kMaxPositionAge = std::chrono::seconds(3);
// POSE is labelled by the host's clock (arrivals), turns by the sensor's. Farther apart than this they would place obstacles of a boat that turns
// at 10 deg/s and goes 3 m/s more than 2.5 deg and 0.75 m wrong; up to this, the host's clock is taken to be kept by UTC with some delay.
constexpr microseconds kMaxDisagreement = std::chrono::milliseconds(250);
// Datagrams come late by milliseconds. What is off by more is a bad stamp, or, when it goes on, a step of the host's clock.
constexpr microseconds kMaxLateness = std::chrono::seconds(1);
constexpr int kSamplesOfAStep = 3;
constexpr microseconds kHour(format::kMicrosecondsPerHour);

// The whole number of hours nearest to `duration`; half an hour goes up.
microseconds NearestHours(microseconds duration) {
  const microseconds shifted = duration + kHour / 2;
  microseconds rest = shifted % kHour;
  if (rest < microseconds(0)) rest += kHour;
  return shifted - rest;
}

}  // namespace

void SensorClock::OnDataPacket(Utime host_time, SensorTime time, std::chrono::nanoseconds duration) {
  const auto end = time + std::chrono::duration_cast<microseconds>(duration);
  const Sample sample{time, host_time.time_since_epoch() - end};
  const bool is_off = !minima_.empty() && std::chrono::abs(sample.host_minus_sensor - minima_.front().host_minus_sensor) > kMaxLateness;
  num_off_ = is_off ? num_off_ + 1 : 0;
  if (is_off && num_off_ < kSamplesOfAStep) return;
  if (is_off) minima_.clear();
  while (!minima_.empty() && minima_.back().host_minus_sensor >= sample.host_minus_sensor) minima_.pop_back();
  minima_.push_back(sample);
  while (minima_.front().time < time - kOffsetWindow) minima_.pop_front();
}

void SensorClock::OnPositionPacket(Utime host_time, const PositionPacket& packet) {
  position_host_time_ = host_time;
  pps_ = packet.pps;
  has_valid_rmc_ = packet.has_valid_rmc;
  if (has_valid_rmc_) rmc_host_time_ = host_time;
}

void SensorClock::ForgetOffset() { minima_.clear(); }

ClockState SensorClock::State(Utime host_time) const {
  if (!position_host_time_) return ClockState::kUnknown;
  // The host's clock may be set back: an age below zero says as little as a great one.
  const microseconds age = host_time - *position_host_time_;
  if (age > kMaxPositionAge || age < -kMaxPositionAge) return ClockState::kUnknown;
  switch (pps_) {
    case format::kPpsAbsent:
      return ClockState::kNoPps;
    case format::kPpsSynchronising:
      return ClockState::kAcquiring;
    case format::kPpsLocked:
      return has_valid_rmc_ ? ClockState::kLocked : ClockState::kLockedWithoutTime;
    default:
      return ClockState::kError;
  }
}

bool SensorClock::IsSensorInUse(ClockState state, microseconds host_minus_sensor) const {
  if (choice_ != TimeChoice::kAuto) return choice_ == TimeChoice::kSensor;
  return state == ClockState::kLocked && std::chrono::abs(host_minus_sensor) <= kMaxDisagreement;
}

Utime SensorClock::TimeOfStampAlone(Utime host_time, std::uint32_t stamp_us) const {
  const microseconds offset = host_time.time_since_epoch() - microseconds(stamp_us);
  const microseconds hours = NearestHours(offset);
  return IsSensorInUse(State(host_time), offset - hours) ? Utime(microseconds(stamp_us) + hours) : host_time;
}

ClockReading SensorClock::Read(Utime host_time) const {
  ClockReading reading;
  reading.state = State(host_time);
  if (position_host_time_) reading.pps = pps_;
  if (rmc_host_time_) reading.rmc_age = host_time - *rmc_host_time_;
  const microseconds offset = minima_.front().host_minus_sensor;
  const microseconds hours = NearestHours(offset);
  reading.host_minus_sensor = offset - hours;
  const bool is_sensor_time = IsSensorInUse(reading.state, offset - hours);
  reading.source = is_sensor_time ? TimeSource::kSensor : TimeSource::kHost;
  reading.offset = is_sensor_time ? hours : offset;
  return reading;
}

}  // namespace lookout::vlp16
