#include "services/lidar/core/driver/stamp_clock.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::microseconds;

// As for a VLP-16: see services/lidar/core/vlp16/sensor_clock.cpp.
constexpr microseconds kMaxApart = std::chrono::milliseconds(250);
constexpr microseconds kMaxApartToStay = std::chrono::milliseconds(300);
// A clock that says less was never set.
constexpr microseconds kYear2000 = std::chrono::seconds(946'684'800);

}  // namespace

void StampClock::OnDataPacket(Utime host_time, SensorTime time, microseconds stamp, microseconds duration, bool is_restart) {
  if (is_restart) {
    fit_ = {};
    is_sensor_in_use_ = false;
  }
  fit_.Add(time, host_time.time_since_epoch() - (time + duration));
  stamp_ = stamp;
  stamp_minus_time_ = stamp - time;
}

ClockReading StampClock::Read() {
  ClockReading reading;
  const auto host_utc = fit_.offset();
  const auto apart = host_utc - stamp_minus_time_;
  const bool is_agreeing = std::chrono::abs(apart) <= (is_sensor_in_use_ ? kMaxApartToStay : kMaxApart);
  const bool was_never_set = stamp_ < kYear2000;
  reading.state = is_agreeing ? ClockState::kLocked : was_never_set ? ClockState::kNoPps : ClockState::kFreeRunning;
  reading.host_minus_sensor = apart;
  reading.drift_ppm = fit_.drift_ppm();
  is_sensor_in_use_ = choice_ == TimeChoice::kAuto ? is_agreeing : choice_ == TimeChoice::kSensor;
  reading.source = is_sensor_in_use_ ? TimeSource::kSensor : TimeSource::kHost;
  reading.offset = is_sensor_in_use_ ? stamp_minus_time_ : host_utc;
  return reading;
}

}  // namespace lookout::lidar
