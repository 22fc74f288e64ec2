#include "services/lidar/core/vlp16/sensor_clock.hpp"

#include <algorithm>
#include <cstdlib>

#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::vlp16 {

namespace {

using std::chrono::microseconds;

constexpr microseconds kClockHour(format::kMicrosecondsPerHour);
// Position packets come about every 7 ms and repeat the RMC that comes every second; the sensor tells of a lost PPS within a second or two.
constexpr microseconds kMaxAge = std::chrono::seconds(3);
// An RMC belongs to the PPS before it and comes up to a second behind; one that is late by a second more is still told by its stamp.
constexpr microseconds kMinStampBehindRmc = std::chrono::milliseconds(-500);
constexpr microseconds kMaxStampBehindRmc = std::chrono::milliseconds(2500);
// POSE is labelled by the host's clock (arrivals), scans by the sensor's. Farther apart than this they would place obstacles of a boat that turns
// at 10 deg/s and goes 3 m/s more than 2.5 deg and 0.75 m wrong; up to this, the host's clock is taken to be kept by UTC with some delay.
constexpr microseconds kMaxDisagreement = std::chrono::milliseconds(250);
constexpr microseconds kMaxDisagreementToStay = std::chrono::milliseconds(300);
// An hour that was found is kept unless it is more than this off: half an hour would flip to and fro for a clock that is half an hour off.
constexpr microseconds kMaxOffHour = std::chrono::minutes(45);

// `value` plus or minus whole hours, nearest to `target`.
microseconds InNearestHour(microseconds value, microseconds target) {
  microseconds rest = (value - target + kClockHour / 2) % kClockHour;
  if (rest < microseconds(0)) rest += kClockHour;
  return target + rest - kClockHour / 2;
}

// UTC of a sentence, on the day nearest to `about` where it has no date, and put right against the host where its date is off by whole rollovers.
microseconds ToUtc(const SentenceTime& time, Utime host_time, microseconds about) {
  const Utime utc = time.date ? MendRollover(*time.date + time.time_of_day, host_time) : OnTheDayNearest(Utime(about), time.time_of_day);
  return utc.time_since_epoch();
}

}  // namespace

void SensorClock::OnDataPacket(const StampedPacket& packet) {
  if (packet.is_restart) {
    fit_ = {};
    sensor_utc_.reset();
    rmc_utc_.reset();
    was_locked_ = false;
    is_sensor_in_use_ = false;
    if (position_came_) position_came_->time.reset();
    if (rmc_) rmc_->came.time.reset();
  }
  time_ = packet.time;
  const auto end = packet.time + packet.duration;
  fit_.Add(packet.time, packet.host_time.time_since_epoch() - end);
  const bool is_rmc_fresh = rmc_ && std::chrono::abs(packet.host_time - rmc_->came.host_time) <= kMaxAge;
  if (!rmc_utc_ && is_rmc_fresh) rmc_utc_ = rmc_->utc + (packet.host_time - rmc_->came.host_time) - packet.time;
  FindHour(packet.stamp_us, packet.time);
}

void SensorClock::FindHour(std::uint32_t stamp_us, SensorTime time) {
  const microseconds reference = rmc_utc_.value_or(fit_.offset());
  const microseconds stamp_minus_time = microseconds(stamp_us) - time;
  if (sensor_utc_) sensor_utc_ = InNearestHour(stamp_minus_time, *sensor_utc_);
  if (!sensor_utc_ || std::chrono::abs(*sensor_utc_ - reference) > kMaxOffHour) sensor_utc_ = InNearestHour(stamp_minus_time, reference);
}

void SensorClock::OnPositionPacket(Utime host_time, const PositionPacket& packet, std::optional<SensorTime> time) {
  const Instant now{host_time, time};
  position_came_ = now;
  pps_ = packet.pps;
  has_valid_rmc_ = packet.time.has_value();
  if (packet.time) {
    const microseconds about = rmc_ ? rmc_->utc + Age(rmc_->came, now) : host_time.time_since_epoch();
    const microseconds utc = ToUtc(*packet.time, host_time, about);
    const bool is_new = !rmc_ || rmc_->utc != utc;
    if (is_new) {
      const microseconds behind = InNearestHour(microseconds(packet.stamp_us) - utc, microseconds(0));
      rmc_ = Rmc{now, utc, behind >= kMinStampBehindRmc && behind <= kMaxStampBehindRmc};
    }
    if (time && is_new) rmc_utc_ = utc - *time;
  }
  if (State(now) == ClockState::kLocked) was_locked_ = true;
}

microseconds SensorClock::Age(const Instant& came, const Instant& now) {
  return came.time && now.time ? *now.time - *came.time : now.host_time - came.host_time;
}

ClockState SensorClock::State(const Instant& now) const {
  // The host's clock may be set back: an age below zero says as little as a great one.
  const auto is_old = [&](const Instant& came) { return std::chrono::abs(Age(came, now)) > kMaxAge; };
  if (!position_came_ || is_old(*position_came_)) return ClockState::kUnknown;
  switch (pps_) {
    case format::kPpsAbsent:
      return was_locked_ ? ClockState::kFreeRunning : ClockState::kNoPps;
    case format::kPpsSynchronising:
      return ClockState::kAcquiring;
    case format::kPpsLocked:
      if (!has_valid_rmc_ || is_old(rmc_->came)) return ClockState::kLockedWithoutTime;
      return rmc_->is_agreeing ? ClockState::kLocked : ClockState::kFreeRunning;
    default:
      return ClockState::kError;
  }
}

bool SensorClock::IsSensorInUse(ClockState state, microseconds host_minus_sensor) const {
  if (choice_ != TimeChoice::kAuto) return choice_ == TimeChoice::kSensor;
  const auto limit = is_sensor_in_use_ ? kMaxDisagreementToStay : kMaxDisagreement;
  return state == ClockState::kLocked && std::chrono::abs(host_minus_sensor) <= limit;
}

Utime SensorClock::TimeOfStampAlone(Utime host_time, std::uint32_t stamp_us) const {
  const microseconds host = host_time.time_since_epoch();
  const microseconds sensor = InNearestHour(microseconds(stamp_us), rmc_ ? rmc_->utc : host);
  return IsSensorInUse(State({host_time, std::nullopt}), host - sensor) ? Utime(sensor) : host_time;
}

ClockReading SensorClock::Read(Utime host_time) {
  ClockReading reading;
  const Instant now{host_time, time_};
  reading.state = State(now);
  if (position_came_) reading.pps = pps_;
  if (rmc_) reading.rmc_age = std::max(microseconds(0), Age(rmc_->came, now));
  const microseconds host_utc = fit_.offset();
  reading.host_minus_sensor = host_utc - *sensor_utc_;
  reading.drift_ppm = fit_.drift_ppm();
  is_sensor_in_use_ = IsSensorInUse(reading.state, host_utc - *sensor_utc_);
  reading.source = is_sensor_in_use_ ? TimeSource::kSensor : TimeSource::kHost;
  reading.offset = is_sensor_in_use_ ? *sensor_utc_ : host_utc;
  return reading;
}

}  // namespace lookout::vlp16
