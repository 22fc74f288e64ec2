// The faults of the lidar's clock, as the simulator makes them, through the real decoder: the states and counters that are to tell of them.
#include <algorithm>
#include <gtest/gtest.h>
#include <set>
#include <string>

#include "lab/sim/simulation.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using namespace std::chrono_literals;

const Utime kBegin = Utime(1'781'532'600s);

struct Seen {
  double time_s;  // of the scan's last shot on the host's clock, since the start
  Scan scan;
};

struct Run {
  std::vector<Seen> scans;
  std::vector<Counter> counters;

  std::int64_t Count(std::string_view name) const {
    const auto found = std::ranges::find(counters, name, &Counter::name);
    return found != counters.end() ? found->count : -1;
  }
  // States of the scans that ended in that time.
  std::set<ClockState> States(double from_s, double to_s) const {
    std::set<ClockState> states;
    for (const auto& seen : scans) {
      if (seen.time_s >= from_s && seen.time_s < to_s) states.insert(seen.scan.clock.state);
    }
    return states;
  }
  std::vector<Scan> Between(double from_s, double to_s) const {
    std::vector<Scan> found;
    for (const auto& seen : scans) {
      if (seen.time_s >= from_s && seen.time_s < to_s) found.push_back(seen.scan);
    }
    return found;
  }
};

// A lidar on a boat that lies still, nothing around it.
Run Play(const std::vector<std::string>& faults, std::chrono::microseconds duration, TimeChoice choice = TimeChoice::kAuto) {
  sim::SimulationParams params;
  params.start = kBegin;
  params.duration = duration;
  for (const auto& fault : faults) params.faults.push_back(sim::ParseTimedFault(fault));
  const sim::Scene scene;
  sim::Simulation simulation(scene, sim::SmallBoat(), params, nullptr);

  Run run;
  double now_s = 0.0;
  DecoderParams decoder_params;
  decoder_params.time = choice;
  Decoder decoder(
      decoder_params,
      [&](const Scan& scan) {
        run.scans.push_back({now_s, scan});
      },
      [](const SentenceOfLidar&) {});
  while (const auto datagram = simulation.Next()) {
    now_s = ToSeconds(datagram->time - kBegin);
    if (datagram->port == params.data_port) decoder.OnDataPayload(datagram->time, datagram->payload);
    if (datagram->port == params.navigation.position_port) decoder.OnPositionPayload(datagram->time, datagram->payload);
  }
  decoder.Flush();
  run.counters = decoder.counters();
  return run;
}

constexpr auto kLocked = ClockState::kLocked;
using States = std::set<ClockState>;

TEST(Vlp16ClockFaults, WithoutFaultTheClockIsLockedAndRight) {
  const auto run = Play({}, 4s);
  EXPECT_EQ(run.States(0.5, 4.0), States{kLocked});
  for (const auto& scan : run.Between(0.5, 4.0)) {
    EXPECT_EQ(scan.clock.source, TimeSource::kSensor);
    EXPECT_LT(std::abs(ToSeconds(*scan.clock.host_minus_sensor)), 1e-3);
  }
  for (const auto* name : {"data_lost", "data_duplicate", "data_reordered", "sensor_restarts", "sensor_clock_steps", "scans_with_hole"}) {
    EXPECT_EQ(run.Count(name), 0) << name;
  }
}

TEST(Vlp16ClockFaults, ALostPpsIsAFreeRunThenAcquiredThenLocked) {
  const auto run = Play({"pps_loss:3:6:200"}, 11s);
  EXPECT_EQ(run.States(0.5, 4.0), States{kLocked});
  EXPECT_EQ(run.States(4.2, 6.0), States{ClockState::kFreeRunning});
  EXPECT_EQ(run.States(6.2, 9.0), States{ClockState::kAcquiring});
  EXPECT_EQ(run.States(9.2, 11.0), States{kLocked});
  for (const auto& scan : run.Between(4.2, 9.0)) EXPECT_EQ(scan.clock.source, TimeSource::kHost);
  EXPECT_EQ(run.Count("data_lost"), 0);
  EXPECT_EQ(run.Count("sensor_restarts"), 0);
}

TEST(Vlp16ClockFaults, AFreeRunThatSaysLockedShowsInTheDrift) {
  const auto run = Play({"free_run:0:100:150"}, 20s);
  ASSERT_FALSE(run.scans.empty());
  const auto& last = run.scans.back().scan;
  ASSERT_TRUE(last.clock.drift_ppm);
  EXPECT_NEAR(*last.clock.drift_ppm, 150.0, 6.0);
  EXPECT_NEAR(ToSeconds(*last.clock.host_minus_sensor), -20.0 * 150e-6, 3e-4) << "it is fast";
  EXPECT_EQ(last.clock.state, kLocked) << "half a second in the hour is what its RMC bears witness to; less cannot be told";
}

TEST(Vlp16ClockFaults, TheOffsetFollowsAClockThatIsFasterThanAnyCrystal) {
  const auto run = Play({"free_run:0:100:500"}, 20s);
  ASSERT_FALSE(run.scans.empty());
  const auto& last = run.scans.back().scan;
  EXPECT_NEAR(last.clock.drift_ppm.value_or(0.0), ClockFit::kMaxDriftPpm, 1e-6) << "no crystal drifts more";
  EXPECT_NEAR(ToSeconds(*last.clock.host_minus_sensor), -20.0 * 500e-6, 1e-3) << "it is fast";
}

TEST(Vlp16ClockFaults, AStampThatIsNotThatOfItsRmcIsAFreeRun) {
  const auto run = Play({"wrong_stamp:3:6"}, 9s);
  EXPECT_EQ(run.States(0.5, 3.0), States{kLocked});
  EXPECT_EQ(run.States(4.5, 6.0), States{ClockState::kFreeRunning});
  EXPECT_EQ(run.States(7.5, 9.0), States{kLocked});
  for (const auto& scan : run.Between(4.5, 6.0)) EXPECT_EQ(scan.clock.source, TimeSource::kHost);
  EXPECT_EQ(run.Count("sensor_clock_steps"), 2) << "there and back";
  EXPECT_EQ(run.Count("data_lost"), 0);
}

TEST(Vlp16ClockFaults, AWrongHourTurnsTheSensorTimeDownWhereTheHostIsThereToTell) {
  const auto run = Play({"wrong_hour:0:100:-4"}, 4s);
  for (const auto& scan : run.Between(2.5, 4.0)) {
    EXPECT_EQ(scan.clock.source, TimeSource::kHost);
    EXPECT_NEAR(ToSeconds(*scan.clock.host_minus_sensor), 4.0 * 3600.0, 1.0);
  }
  const auto believed = Play({"wrong_hour:0:100:-4"}, 4s, TimeChoice::kSensor).Between(2.5, 4.0);
  ASSERT_FALSE(believed.empty());
  EXPECT_NEAR(ToSeconds(believed.back().time - kBegin), 4.0 - 4.0 * 3600.0, 1.0) << "asked to believe the sensor, it does";
}

TEST(Vlp16ClockFaults, AnRmcThatIsASecondLateChangesNothing) {
  const auto run = Play({"late_rmc:2:6"}, 8s);
  EXPECT_EQ(run.States(0.5, 8.0), States{kLocked});
  for (const auto& scan : run.Between(0.5, 8.0)) {
    EXPECT_EQ(scan.clock.source, TimeSource::kSensor);
    EXPECT_LT(std::abs(ToSeconds(*scan.clock.host_minus_sensor)), 1e-3);
  }
}

TEST(Vlp16ClockFaults, AGapOfTheReceiverLeavesTheClockLockedWithoutTime) {
  const auto run = Play({"gnss_gap:2:7"}, 10s);
  EXPECT_EQ(run.States(0.5, 2.0), States{kLocked});
  EXPECT_EQ(run.States(5.5, 7.0), States{ClockState::kLockedWithoutTime});
  EXPECT_EQ(run.States(8.5, 10.0), States{kLocked});
}

TEST(Vlp16ClockFaults, ARestartedSensorIsSilentThenGoesThroughAllStates) {
  const auto run = Play({"sensor_restart:3:5:5"}, 13s);
  EXPECT_EQ(run.States(0.5, 3.0), States{kLocked});
  EXPECT_TRUE(run.Between(3.2, 5.0).empty()) << "silence";
  EXPECT_EQ(run.States(5.2, 7.0), States{ClockState::kNoPps});
  EXPECT_EQ(run.States(7.2, 10.0), States{ClockState::kAcquiring});
  EXPECT_EQ(run.States(10.2, 13.0), States{kLocked});
  EXPECT_GE(run.Count("sensor_restarts"), 1);
  EXPECT_EQ(run.Count("data_lost"), 0) << "what was never sent is not lost";
  // By the host's clock until the lock: never elsewhere in time. A scan that the silence cut short is told of when it is over.
  for (const auto& seen : run.scans) {
    if (seen.scan.is_partial_end) continue;
    EXPECT_NEAR(ToSeconds(seen.scan.end_time - kBegin), seen.time_s, 0.01);
  }
}

}  // namespace
}  // namespace lookout::vlp16
