#include "services/lidar/core/driver/stamp_clock.hpp"

#include <gtest/gtest.h>

namespace lookout::lidar {
namespace {

using namespace std::chrono_literals;

const Utime kClockBegin = Utime(1'700'000'000s);

// Five seconds of packets every 3 ms; the stamp is `apart` ahead of UTC, and packets need 1 ms to come.
ClockReading ReadingOf(TimeChoice choice, std::chrono::microseconds apart) {
  StampClock clock(choice);
  for (auto time = 0us; time < 5s; time += 3ms) {
    clock.OnDataPacket(kClockBegin + time + 4ms, time, kClockBegin.time_since_epoch() + time + apart, 3ms, time == 0us);
  }
  return clock.Read();
}

TEST(StampClock, IsUsedWhileItAgreesWithTheHost) {
  for (const auto apart : {0us, 200'000us, -200'000us}) {
    const auto reading = ReadingOf(TimeChoice::kAuto, apart);
    EXPECT_EQ(reading.source, TimeSource::kSensor);
    EXPECT_EQ(reading.state, ClockState::kLocked);
    EXPECT_EQ(reading.ToUtime(0us), kClockBegin + apart);
    EXPECT_EQ(reading.host_minus_sensor, 1ms - apart);
  }
}

// PTP that tells TAI, GPS time, a clock that was never set: scans would be labelled seconds, or decades, beside POSE.
TEST(StampClock, GivesWayToTheHostWhereItDoesNot) {
  for (const std::chrono::microseconds apart : {37s, 18s, -1s}) {
    const auto reading = ReadingOf(TimeChoice::kAuto, apart);
    EXPECT_EQ(reading.source, TimeSource::kHost);
    EXPECT_EQ(reading.state, ClockState::kFreeRunning);
    EXPECT_EQ(reading.ToUtime(0us), kClockBegin + 1ms);
  }
  const auto since_start = ReadingOf(TimeChoice::kAuto, -kClockBegin.time_since_epoch() + 100s);
  EXPECT_EQ(since_start.source, TimeSource::kHost);
  EXPECT_EQ(since_start.state, ClockState::kNoPps);
}

TEST(StampClock, IsWhatTheConfigSays) {
  EXPECT_EQ(ReadingOf(TimeChoice::kSensor, 37s).ToUtime(0us), kClockBegin + 37s);
  EXPECT_EQ(ReadingOf(TimeChoice::kHost, 0us).source, TimeSource::kHost);
}

}  // namespace
}  // namespace lookout::lidar
