#include "lab/sim/lidar_clock.hpp"

#include <gtest/gtest.h>

#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;
namespace format = vlp16::format;

// Ten minutes past an hour.
const Utime kClockStart = Utime(1'781'532'600s);
constexpr std::int64_t kStartPastHourUs = 600'000'000;

struct Lidar {
  explicit Lidar(std::initializer_list<std::string_view> texts) : plan(Parse(texts), kClockStart), clock(plan) {}

  static std::vector<TimedFault> Parse(std::initializer_list<std::string_view> texts) {
    std::vector<TimedFault> faults;
    for (const auto text : texts) faults.push_back(ParseTimedFault(text));
    return faults;
  }

  // How far the stamp is ahead of the time that has gone by, microseconds.
  std::int64_t ErrorUs(std::chrono::microseconds since_start) const {
    return static_cast<std::int64_t>(clock.StampUs(kClockStart + since_start)) - kStartPastHourUs - since_start.count();
  }
  int Pps(std::chrono::microseconds since_start) const { return clock.Pps(kClockStart + since_start); }
  // Second of the RMC since the start; -100 = none.
  double RmcS(std::chrono::microseconds since_start) const {
    const auto second = clock.SecondOfRmc(kClockStart + since_start);
    return second ? ToSeconds(*second - kClockStart) : -100.0;
  }

  FaultPlan plan;
  LidarClock clock;
};

TEST(LidarClock, IsRightWithoutFaults) {
  const Lidar lidar{};
  EXPECT_TRUE(lidar.clock.IsOn(kClockStart));
  EXPECT_EQ(lidar.ErrorUs(0us), 0);
  EXPECT_EQ(lidar.ErrorUs(123'456'789us), 0);
  EXPECT_EQ(lidar.clock.StampUs(kClockStart + 50min), 0U) << "the hour begins anew";
  EXPECT_EQ(lidar.clock.StampUs(kClockStart + 50min - 1us), 3'599'999'999U);
  EXPECT_EQ(lidar.Pps(5s), format::kPpsLocked);
  EXPECT_EQ(lidar.RmcS(0s), -1.0);
  EXPECT_EQ(lidar.RmcS(149'999us), -1.0);
  EXPECT_EQ(lidar.RmcS(150ms), 0.0);
  EXPECT_EQ(lidar.RmcS(1149ms), 0.0);
  EXPECT_EQ(lidar.clock.RmcError(kClockStart), 0h);
}

TEST(LidarClock, WithoutPpsItRunsOnAndIsSetWhenThePpsHasBeenBackForAWhile) {
  const Lidar lidar{"pps_loss:10:20:100"};
  EXPECT_EQ(lidar.Pps(10'999ms), format::kPpsLocked) << "nothing is missing before the next pulse";
  EXPECT_EQ(lidar.Pps(11s), format::kPpsAbsent);
  EXPECT_EQ(lidar.Pps(20s), format::kPpsSynchronising);
  EXPECT_EQ(lidar.Pps(23s), format::kPpsLocked);
  EXPECT_EQ(lidar.ErrorUs(10s), 0);
  EXPECT_EQ(lidar.ErrorUs(15s), 500);
  EXPECT_EQ(lidar.ErrorUs(22'999'999us), 1300);
  EXPECT_EQ(lidar.ErrorUs(23s), 0);
}

TEST(LidarClock, ThatRunsFreeSaysThatItIsLocked) {
  const Lidar lidar{"free_run:10:20:-50"};
  EXPECT_EQ(lidar.ErrorUs(20s - 1us), -500);
  EXPECT_EQ(lidar.ErrorUs(20s), 0);
  for (const auto time : {10s, 15s, 20s}) EXPECT_EQ(lidar.Pps(time), format::kPpsLocked);
}

TEST(LidarClock, AWrongStampIsWrongWithinTheHour) {
  const Lidar lidar{"wrong_stamp:1:2:-700"};
  EXPECT_EQ(lidar.clock.StampUs(kClockStart + 1s), 3'501'000'000U) << "10 min 1 s minus 700 s is 98.35 minutes past the hour before: wrapped";
  EXPECT_EQ(lidar.ErrorUs(2s), 0);
}

TEST(LidarClock, AWrongHourIsTheHourOfItsRmcAlone) {
  const Lidar lidar{"wrong_hour:5:10:-4"};
  EXPECT_EQ(lidar.clock.RmcError(kClockStart + 4s), 0h);
  EXPECT_EQ(lidar.clock.RmcError(kClockStart + 5s), -4h);
  EXPECT_EQ(lidar.clock.RmcError(kClockStart + 10s), 0h);
  EXPECT_EQ(lidar.ErrorUs(7s), 0);
}

TEST(LidarClock, ALateRmcComesLateAndNeverGoesBack) {
  const Lidar lidar{"late_rmc:5:8"};
  double last_s = -2.0;
  for (auto time = 0us; time < 12s; time += 50ms) {
    EXPECT_GE(lidar.RmcS(time), last_s);
    last_s = lidar.RmcS(time);
  }
  EXPECT_EQ(lidar.RmcS(5'200ms), 4.0) << "that of second 5 comes a second late";
  EXPECT_EQ(lidar.RmcS(6'200ms), 5.0);
  EXPECT_EQ(lidar.RmcS(8'149ms), 6.0);
  EXPECT_EQ(lidar.RmcS(8'150ms), 8.0) << "that of second 8 is in time, and with it those before do not count";
  EXPECT_EQ(lidar.ErrorUs(6s), 0);
}

TEST(LidarClock, ARestartIsSilentThenStampsFromZeroAndLocksInTheEnd) {
  const Lidar lidar{"sensor_restart:4:6:5"};
  EXPECT_TRUE(lidar.clock.IsOn(kClockStart + 4s - 1us));
  EXPECT_FALSE(lidar.clock.IsOn(kClockStart + 4s));
  EXPECT_FALSE(lidar.clock.IsOn(kClockStart + 6s - 1us));
  EXPECT_TRUE(lidar.clock.IsOn(kClockStart + 6s));
  EXPECT_EQ(lidar.clock.StampUs(kClockStart + 6s), 0U);
  EXPECT_EQ(lidar.clock.StampUs(kClockStart + 10s), 4'000'000U);
  EXPECT_EQ(lidar.ErrorUs(11s), 0);
  EXPECT_EQ(lidar.Pps(6s), format::kPpsAbsent);
  EXPECT_EQ(lidar.Pps(8s), format::kPpsSynchronising);
  EXPECT_EQ(lidar.Pps(11s), format::kPpsLocked);
  EXPECT_EQ(lidar.RmcS(6s), -100.0) << "what came before it is forgotten";
  EXPECT_EQ(lidar.RmcS(6'149ms), -100.0);
  EXPECT_EQ(lidar.RmcS(6'150ms), 6.0);
}

// It used to say that it was acquiring while there was no PPS, and had the time a second after the PPS was back.
TEST(LidarClock, ARestartWithoutPpsLocksWhenThePpsHasBeenBackForAWhile) {
  const Lidar lidar{"sensor_restart:0:2:3", "pps_loss:1:4:100"};
  EXPECT_EQ(lidar.Pps(2s), format::kPpsAbsent);
  EXPECT_EQ(lidar.Pps(4s - 1us), format::kPpsAbsent);
  EXPECT_EQ(lidar.Pps(4s), format::kPpsSynchronising);
  EXPECT_EQ(lidar.Pps(7s), format::kPpsLocked);
  EXPECT_EQ(lidar.clock.StampUs(kClockStart + 7s - 1us), 4'999'999U);
  EXPECT_EQ(lidar.ErrorUs(7s), 0);
}

}  // namespace
}  // namespace lookout::sim
