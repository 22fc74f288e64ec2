#include "services/vlp16/core/sensor_clock.hpp"

#include <gtest/gtest.h>

#include "services/vlp16/core/packet_format.hpp"

namespace lookout::vlp16 {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr microseconds kDuration(1327);
const Utime kNoon = Utime(hours(24 * 20000 + 12));

PositionPacket Position(int pps, bool has_valid_rmc) {
  PositionPacket packet;
  packet.pps = pps;
  packet.has_valid_rmc = has_valid_rmc;
  return packet;
}

TEST(SensorClock, TakesTheLeastDelayedPacketOfTheLastTwoSeconds) {
  SensorClock clock(TimeChoice::kHost);
  const auto at = [&](microseconds sensor, microseconds delay) {
    const Utime host = kNoon + sensor + kDuration + delay;
    clock.OnDataPacket(host, sensor, kDuration);
    return clock.Read(host).ToUtime(sensor) - (kNoon + sensor);
  };
  EXPECT_EQ(at(milliseconds(0), microseconds(900)), microseconds(900));
  EXPECT_EQ(at(milliseconds(1), microseconds(100)), microseconds(100));
  EXPECT_EQ(at(milliseconds(2), microseconds(5000)), microseconds(100));
  EXPECT_EQ(at(milliseconds(2001), microseconds(5000)), microseconds(100));
  EXPECT_EQ(at(milliseconds(2002), microseconds(5000)), microseconds(5000));  // the best one has left the window
}

TEST(SensorClock, FollowsAHostClockThatIsSetByTheThirdPacket) {
  for (const auto step : {seconds(-10), seconds(10)}) {
    SensorClock clock(TimeChoice::kHost);
    clock.OnDataPacket(kNoon + kDuration, microseconds(0), kDuration);
    for (int packet = 1; packet <= 3; ++packet) clock.OnDataPacket(kNoon + step + kDuration, packet * microseconds(1327), kDuration);
    EXPECT_EQ(clock.Read(kNoon).offset, kNoon.time_since_epoch() + step - 3 * microseconds(1327));
  }
}

TEST(SensorClock, PutsSensorTimeInTheHourNearestToTheHost) {
  for (const int host_offset_s : {-1700, -1, 0, 1, 1700}) {
    SensorClock clock(TimeChoice::kSensor);
    // The sensor says one second past the hour.
    clock.OnDataPacket(kNoon + seconds(1 + host_offset_s) + kDuration, seconds(1), kDuration);
    const auto reading = clock.Read(kNoon);
    EXPECT_EQ(reading.source, TimeSource::kSensor);
    EXPECT_EQ(reading.ToUtime(seconds(1)), kNoon + seconds(1)) << host_offset_s;
    EXPECT_EQ(reading.host_minus_sensor, seconds(host_offset_s));
  }
}

TEST(SensorClock, CountsHoursBefore1970Too) {
  SensorClock clock(TimeChoice::kSensor);
  clock.OnDataPacket(Utime(seconds(-5)), seconds(3596), kDuration);
  EXPECT_EQ(clock.Read(Utime{}).ToUtime(seconds(3596)), Utime(seconds(-4)));
}

TEST(SensorClock, UsesTheSensorOnlyWhileItIsLockedAndKnowsTheTime) {
  const auto source = [](int pps, bool has_valid_rmc, microseconds age) {
    SensorClock clock(TimeChoice::kAuto);
    clock.OnDataPacket(kNoon, microseconds(0), kDuration);
    clock.OnPositionPacket(kNoon, Position(pps, has_valid_rmc));
    return clock.Read(kNoon + age).source;
  };
  EXPECT_EQ(source(format::kPpsLocked, true, seconds(0)), TimeSource::kSensor);
  EXPECT_EQ(source(format::kPpsLocked, true, seconds(3)), TimeSource::kSensor);
  EXPECT_EQ(source(format::kPpsLocked, true, microseconds(3'000'001)), TimeSource::kHost);
  EXPECT_EQ(source(format::kPpsLocked, true, seconds(-4)), TimeSource::kHost);
  EXPECT_EQ(source(format::kPpsLocked, false, seconds(0)), TimeSource::kHost);
  EXPECT_EQ(source(format::kPpsSynchronising, true, seconds(0)), TimeSource::kHost);
  EXPECT_EQ(source(format::kPpsAbsent, true, seconds(0)), TimeSource::kHost);
  EXPECT_EQ(source(format::kPpsError, true, seconds(0)), TimeSource::kHost);
}

TEST(SensorClock, DoesNotMixTheSensorsTimeWithAHostThatIsFarOff) {
  const auto source = [](microseconds host_ahead) {
    SensorClock clock(TimeChoice::kAuto);
    clock.OnDataPacket(kNoon + host_ahead + kDuration, microseconds(0), kDuration);
    clock.OnPositionPacket(kNoon, Position(format::kPpsLocked, true));
    return clock.Read(kNoon).source;
  };
  EXPECT_EQ(source(std::chrono::milliseconds(250)), TimeSource::kSensor);
  EXPECT_EQ(source(std::chrono::milliseconds(-250)), TimeSource::kSensor);
  EXPECT_EQ(source(std::chrono::milliseconds(251)), TimeSource::kHost);
  EXPECT_EQ(source(std::chrono::milliseconds(-251)), TimeSource::kHost);
}

TEST(SensorClock, IsNotMisledByOneBadStampAndFollowsAStep) {
  SensorClock clock(TimeChoice::kHost);
  const auto offset_after = [&clock](int packet, microseconds host_error) {
    clock.OnDataPacket(kNoon + packet * kDuration + host_error, packet * std::chrono::duration_cast<microseconds>(kDuration), kDuration);
    return clock.Read(kNoon).offset;
  };
  const auto offset = offset_after(1, seconds(0));
  EXPECT_EQ(offset_after(2, -std::chrono::days(3650)), offset);
  EXPECT_EQ(offset_after(3, seconds(0)), offset);
  EXPECT_EQ(offset_after(4, seconds(100)), offset);
  EXPECT_EQ(offset_after(5, seconds(100)), offset);
  EXPECT_NEAR(static_cast<double>((offset_after(6, seconds(100)) - offset).count()), 100e6, 10.0);
}

TEST(SensorClock, NamesItsState) {
  SensorClock clock(TimeChoice::kAuto);
  clock.OnDataPacket(kNoon, microseconds(0), kDuration);
  EXPECT_EQ(clock.Read(kNoon).state, ClockState::kUnknown);
  EXPECT_FALSE(clock.Read(kNoon).pps);
  EXPECT_FALSE(clock.Read(kNoon).rmc_age);
  const auto state = [&](int pps, bool has_valid_rmc) {
    clock.OnPositionPacket(kNoon, Position(pps, has_valid_rmc));
    return clock.Read(kNoon).state;
  };
  EXPECT_EQ(state(0, true), ClockState::kNoPps);
  EXPECT_EQ(state(1, true), ClockState::kAcquiring);
  EXPECT_EQ(state(2, false), ClockState::kLockedWithoutTime);
  EXPECT_EQ(state(2, true), ClockState::kLocked);
  EXPECT_EQ(state(3, true), ClockState::kError);
  EXPECT_EQ(clock.Read(kNoon + seconds(2)).rmc_age, seconds(2));
  EXPECT_EQ(clock.Read(kNoon + seconds(2)).pps, 3);
}

TEST(SensorClock, ForgetsTheOffsetAfterAJump) {
  SensorClock clock(TimeChoice::kHost);
  clock.OnDataPacket(kNoon, microseconds(0), kDuration);
  clock.ForgetOffset();
  clock.OnDataPacket(kNoon + seconds(1), microseconds(10), kDuration);
  EXPECT_EQ(clock.Read(kNoon).ToUtime(microseconds(10)), kNoon + seconds(1) - kDuration);
}

TEST(SensorClock, StampsAPositionPacketThatComesBeforeAnyData) {
  SensorClock host(TimeChoice::kHost);
  EXPECT_EQ(host.TimeOfStampAlone(kNoon, 77), kNoon);
  SensorClock sensor(TimeChoice::kSensor);
  EXPECT_EQ(sensor.TimeOfStampAlone(kNoon - seconds(1), 77), kNoon + microseconds(77));
}

}  // namespace
}  // namespace lookout::vlp16
