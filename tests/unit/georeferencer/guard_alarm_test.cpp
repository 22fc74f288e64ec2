// The alarm of the guard zone over time, through the service: SEGMENTS drive message time, AdvanceTo the host's clock.
#include "services/georeferencer/guard_alarm.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/bus/memory_bus.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/georeferencer/service.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t kPeriodUs = 100'000;  // 600 rpm
constexpr std::int32_t kPartial = lidar_scan_t::FLAG_PARTIAL_START;
constexpr std::int32_t kHole = lidar_scan_t::FLAG_HOLE;

class TheAlarm : public ::testing::Test {
 protected:
  TheAlarm() {
    params_.pose_timeout = milliseconds(500);
    params_.guard_zone.range_m = 15.0;
    service_.emplace(bus_, params_);
  }

  void Take(const segments_t& message) {
    bus::Publish(bus_, bus::kSegments, message);
    const std::int64_t grid_us = (message.end_utime_us - test::kStartUs) / 20'000 * 20'000 + 20'000;
    if (has_pose_) bus::Publish(bus_, bus::kPose, test::MakePoseMessage(grid_us));
    while (bus_.HandleOnce()) {
    }
  }
  // The obstacle is 10 m ahead.
  segments_t ScanAt(std::int64_t offset_us, bool has_obstacle, std::int32_t flags = 0) const {
    auto message =
        test::MakeSegmentsMessage(offset_us, seq_, has_obstacle ? std::vector{test::MakeSegmentMessage(1, offset_us)} : std::vector<segment_t>{});
    message.scan_flags = flags;
    return message;
  }
  segments_t PartAt(std::int64_t offset_us, int part_index, int num_parts, bool has_obstacle) const {
    auto message = ScanAt(offset_us, has_obstacle);
    message.part_index = part_index;
    message.num_parts = num_parts;
    return message;
  }
  // The next scan, a period after the one before in message time and host time.
  void Scan(bool has_obstacle, std::int32_t flags = 0) {
    Wait(milliseconds(kPeriodUs / 1000));
    Take(ScanAt(time_us_, has_obstacle, flags));
    time_us_ += kPeriodUs;
    ++seq_;
  }
  void Scans(int count, bool has_obstacle, std::int32_t flags = 0) {
    for (int i = 0; i < count; ++i) Scan(has_obstacle, flags);
  }
  // Host time alone goes on, as live: every 10 ms.
  void Wait(milliseconds duration) {
    for (auto waited = milliseconds(0); waited < duration; waited += milliseconds(10)) service_->AdvanceTo(host_ += milliseconds(10));
  }

  std::int64_t Counter(std::string_view name) const {
    for (const auto& counter : service_->Report().counters) {
      if (counter.name == name) return counter.count;
    }
    return -1;
  }
  std::int64_t Alarms() const { return Counter("alarms"); }
  bool IsObstacleTold() const { return Counter("nearest_cm") == 1000; }
  bool Says(const std::string& piece) const { return service_->Report().reason.find(piece) != std::string::npos; }

  bus::MemoryBus bus_;
  Params params_;
  std::optional<Service> service_;
  std::int64_t time_us_ = 0;
  std::int64_t seq_ = 0;
  bool has_pose_ = true;
  Utime host_ = test::At(50'000);
};

TEST_F(TheAlarm, IsNotRungByWhatOneOrTwoScansInFiveShow) {
  Scans(5, false);
  for (int i = 0; i < 20; ++i) {
    Scans(2, true);
    Scans(3, false);
  }
  EXPECT_EQ(Alarms(), 0);
  EXPECT_EQ(Counter("alarm_active"), 0);
  EXPECT_EQ(service_->Report().state, HealthState::kOk);
}

TEST_F(TheAlarm, IsRungByTheThirdOfFiveScans) {
  Scans(5, false);
  Scan(true);
  Scan(false);
  Scan(true);
  Scan(false);
  EXPECT_FALSE(IsObstacleTold());
  Scan(true);
  EXPECT_TRUE(IsObstacleTold());
  EXPECT_EQ(Counter("alarm_active"), 1);
  EXPECT_TRUE(Says("obstacle within 15.0 m: 10.0 m, 0 deg to starboard"));
}

TEST_F(TheAlarm, IsClearedAfterASecondWithout) {
  Scans(5, true);
  Scans(9, false);
  EXPECT_TRUE(IsObstacleTold());
  Scan(false);
  EXPECT_FALSE(IsObstacleTold());
  EXPECT_EQ(Counter("alarm_active"), 0);
  Scans(3, true);
  EXPECT_EQ(Alarms(), 2);
}

TEST_F(TheAlarm, HoldsWhileTheObstacleIsSeenNowAndThen) {
  Scans(5, true);
  for (int i = 0; i < 10; ++i) {
    Scans(9, false);
    Scan(true);
    EXPECT_TRUE(IsObstacleTold());
  }
  EXPECT_EQ(Alarms(), 1);
}

// A sender that is not the lidar cuts its scans into pieces without the obstacle, at 60 packets a second for 8 s.
TEST_F(TheAlarm, IsNotClearedByPartialScansAndSaysThatNobodyLooks) {
  Scans(5, true);
  for (int i = 0; i < 480; ++i) {
    Wait(milliseconds(16));
    Take(ScanAt(time_us_, false, kPartial));
    time_us_ += 16'000;
    ++seq_;
  }
  EXPECT_TRUE(IsObstacleTold());
  EXPECT_EQ(Counter("alarm_active"), 1);
  EXPECT_EQ(Counter("zone_unwatched"), 1);
  EXPECT_TRUE(Says("guard zone not watched: no whole scan for ")) << service_->Report().reason;
  EXPECT_TRUE(Says("480 that were not whole"));
  Scans(30, false);
  EXPECT_EQ(Counter("alarm_active"), 0);
}

TEST_F(TheAlarm, IsNotHeldOffByPartialScansBetween) {
  Scans(5, false);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(Alarms(), 0);
    Scan(true);
    Scans(2, false, kHole);
  }
  EXPECT_EQ(Alarms(), 1);
}

TEST_F(TheAlarm, IsRungByPartialScansThatShowTheObstacle) {
  Scans(5, false);
  Scans(3, true, kHole);
  EXPECT_EQ(Alarms(), 1);
}

TEST_F(TheAlarm, IsNotRungByWhatThreeScansShowInFarMoreThanASecond) {
  Scans(5, false);
  for (int i = 0; i < 20; ++i) {
    Scan(true, kPartial);
    Scans(6, false, kPartial);
  }
  EXPECT_EQ(Alarms(), 0);
  EXPECT_EQ(Counter("alarm_active"), 1) << "but nobody looks";
}

TEST_F(TheAlarm, IsNotClearedByScansThatLackAPart) {
  Scans(5, true);
  for (int i = 0; i < 20; ++i) {
    Wait(milliseconds(100));
    auto message = ScanAt(time_us_, false);
    message.num_parts = 2;  // the second is lost
    Take(message);
    time_us_ += kPeriodUs;
    ++seq_;
  }
  EXPECT_TRUE(IsObstacleTold());
  EXPECT_EQ(Counter("zone_unwatched"), 1);
}

TEST_F(TheAlarm, CountsAScanInPartsOnce) {
  for (int i = 0; i < 6; ++i) {
    Wait(milliseconds(100));
    for (const int part : {0, 1, 1, 2}) {  // one comes twice
      auto message = ScanAt(time_us_, i == 5);
      message.num_parts = 3;
      message.part_index = part;
      Take(message);
    }
    time_us_ += kPeriodUs;
    ++seq_;
  }
  EXPECT_EQ(Alarms(), 0);
  EXPECT_EQ(Counter("zone_unwatched"), 0);
  EXPECT_EQ(Counter("scans_whole"), 6);
}

TEST_F(TheAlarm, TakesPartsInAnyOrder) {
  for (int i = 0; i < 3; ++i) {
    Wait(milliseconds(100));
    for (const int part : {1, 0}) Take(PartAt(time_us_, part, 2, part == 0));
    time_us_ += kPeriodUs;
    ++seq_;
  }
  EXPECT_TRUE(IsObstacleTold());
  EXPECT_EQ(Counter("scans_whole"), 3);
}

TEST_F(TheAlarm, IsRungByPartsThatComeAfterTheNextScanBegan) {
  for (int i = 0; i < 5; ++i) {
    Wait(milliseconds(100));
    Take(PartAt(time_us_, 0, 2, false));
    if (i > 0) {
      --seq_;
      Take(PartAt(time_us_ - kPeriodUs, 1, 2, true));
      ++seq_;
    }
    time_us_ += kPeriodUs;
    ++seq_;
  }
  EXPECT_TRUE(IsObstacleTold());
  EXPECT_EQ(Counter("scans_whole"), 0);
}

TEST_F(TheAlarm, IsRungByPartsThatDisagreeAboutTheirNumber) {
  for (const auto& num_parts : {std::vector{3, 2, 3}, {3, 4, 3}, {2, 3, 3}}) {
    service_.emplace(bus_, params_);
    for (int i = 0; i < 4; ++i) {
      Wait(milliseconds(100));
      for (int part = 0; part < 3; ++part) Take(PartAt(time_us_, part, num_parts[static_cast<std::size_t>(part)], part == 1));
      time_us_ += kPeriodUs;
      ++seq_;
    }
    EXPECT_TRUE(IsObstacleTold()) << num_parts[0] << num_parts[1];
    EXPECT_EQ(Counter("scans_whole"), 0) << num_parts[0] << num_parts[1];
  }
}

TEST_F(TheAlarm, NeedsSixTenthsOfASecondAtThreeHundredRpm) {
  const auto scan = [this](bool has_obstacle) {
    Wait(milliseconds(200));
    Take(ScanAt(time_us_, has_obstacle));
    time_us_ += 200'000;
    ++seq_;
  };
  for (int i = 0; i < 5; ++i) scan(false);
  EXPECT_EQ(Counter("zone_unwatched"), 0);
  for (int i = 0; i < 3; ++i) scan(true);
  EXPECT_EQ(Alarms(), 1);
  for (int i = 0; i < 4; ++i) scan(false);
  EXPECT_TRUE(IsObstacleTold());
  scan(false);
  EXPECT_FALSE(IsObstacleTold());
  EXPECT_EQ(Counter("zone_times_unwatched"), 0);
}

TEST_F(TheAlarm, SaysAtTheStartThatNobodyLooksYet) {
  Wait(milliseconds(10));
  EXPECT_EQ(Counter("alarm_active"), 1);
  EXPECT_TRUE(Says("guard zone not watched: no whole scan yet"));
  EXPECT_EQ(service_->Report().state, HealthState::kDegraded);
  Scans(2, false);
  EXPECT_TRUE(Says("guard zone not watched: less than 3 whole scans within 1.0 s")) << service_->Report().reason;
  Scan(false);
  EXPECT_EQ(Counter("alarm_active"), 0);
  EXPECT_FALSE(Says("guard zone"));
  EXPECT_EQ(Counter("zone_times_unwatched"), 0);
}

TEST_F(TheAlarm, SaysAfterHalfASecondWithoutScansThatNobodyLooks) {
  Scans(10, false);
  Wait(milliseconds(490));
  EXPECT_EQ(Counter("alarm_active"), 0);
  Wait(milliseconds(20));
  EXPECT_EQ(Counter("alarm_active"), 1);
  EXPECT_EQ(Counter("nearest_cm"), -1) << "no obstacle";
  EXPECT_TRUE(Says("guard zone not watched: no whole scan for 0.5 s")) << service_->Report().reason;
  EXPECT_EQ(Counter("zone_times_unwatched"), 1);
}

TEST_F(TheAlarm, StaysWhenSegmentsStop) {
  Scans(5, true);
  Wait(milliseconds(10'000));
  EXPECT_TRUE(IsObstacleTold()) << "it was there when it was last looked at";
  EXPECT_TRUE(Says("guard zone not watched"));
  EXPECT_TRUE(Says("no SEGMENTS for "));
}

TEST_F(TheAlarm, IsNotClearedByAGapOfItsOwnLength) {
  Scans(5, true);
  time_us_ += 3'000'000;
  Scans(10, false);
  EXPECT_TRUE(IsObstacleTold());
  Scan(false);
  EXPECT_FALSE(IsObstacleTold());
}

TEST_F(TheAlarm, DoesNotWaitForPose) {
  has_pose_ = false;
  Scans(3, true);
  EXPECT_EQ(Alarms(), 1);
}

TEST_F(TheAlarm, DoesNotVanishWhenMessageTimeGoesBack) {
  Scans(5, true);
  time_us_ = -3'600'000'000;
  seq_ = 0;
  Scans(9, false);
  EXPECT_TRUE(IsObstacleTold());
  Scans(2, false);
  EXPECT_FALSE(IsObstacleTold());
  EXPECT_EQ(Alarms(), 1);
}

TEST_F(TheAlarm, BeginsAnewWhenMessageTimeGoesBack) {
  Scans(5, false);
  Scans(2, true);
  time_us_ = -3'600'000'000;
  seq_ = 0;
  Scans(2, true);
  EXPECT_EQ(Alarms(), 0) << "two of the one run and two of the other";
  Scan(true);
  EXPECT_EQ(Alarms(), 1);
}

// Each scan is of another run than the one before: no three belong together.
TEST_F(TheAlarm, SaysThatNobodyLooksWhileTwoRunsAlternate) {
  Scans(5, false);
  for (int i = 0; i < 20; ++i) {
    const std::int64_t shift_us = i % 2 == 0 ? 0 : 3'600'000'000;
    Wait(milliseconds(100));
    Take(ScanAt(time_us_ - shift_us, true));
    time_us_ += kPeriodUs;
    ++seq_;
  }
  EXPECT_EQ(Counter("alarm_active"), 1);
}

TEST_F(TheAlarm, IsNotRungByAStepOfTheHostsClock) {
  Scans(10, false);
  for (const auto step : {std::chrono::seconds(3600), std::chrono::seconds(-7200)}) {
    host_ += step;
    Scans(5, false);
    EXPECT_EQ(Counter("zone_times_unwatched"), 0);
  }
}

// Everything that came in 2 s in which this process did not run, at once.
TEST_F(TheAlarm, IsNotRungByAPauseOfThisProcessAlone) {
  Scans(10, false);
  host_ += milliseconds(2000);
  for (int i = 0; i < 20; ++i) {
    Take(ScanAt(time_us_, false));
    time_us_ += kPeriodUs;
    ++seq_;
  }
  Scans(5, false);
  EXPECT_EQ(Counter("zone_times_unwatched"), 0);
}

TEST_F(TheAlarm, TakesTheTentativeWhereItIsAskedTo) {
  for (const bool takes_tentative : {false, true}) {
    params_.guard_zone.takes_tentative = takes_tentative;
    bus::MemoryBus bus;
    Service service(bus, params_);
    for (std::int64_t i = 0; i < 5; ++i) {
      auto message = test::MakeSegmentsMessage(i * kPeriodUs, i, {test::MakeSegmentMessage(1, i * kPeriodUs)});
      message.segments[0].confidence = segment_t::CONFIDENCE_TENTATIVE;
      bus::Publish(bus, bus::kSegments, message);
      while (bus.HandleOnce()) {
      }
    }
    const auto report = service.Report();
    EXPECT_EQ(std::ranges::find(report.counters, "alarms", &Counter::name)->count, takes_tentative ? 1 : 0);
  }
}

TEST_F(TheAlarm, IsNotThereWithoutAGuardZone) {
  params_.guard_zone.range_m = 0.0;
  service_.emplace(bus_, params_);
  Scans(5, true);
  EXPECT_EQ(Alarms(), -1);
  EXPECT_FALSE(Says("guard zone"));
}

}  // namespace
}  // namespace lookout::georeferencer
