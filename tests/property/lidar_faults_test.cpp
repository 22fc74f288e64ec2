// Whatever a network does to the packets of a lidar, the counters of the lidar process tell it exactly: the simulator's faults into the service.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <string_view>
#include <tuple>

#include "lab/sim/faulty_network.hpp"
#include "lab/sim/simulation.hpp"
#include "lab/sim/sinks.hpp"
#include "services/lidar/io/capture_reader.hpp"
#include "services/lidar/service.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/lidar/packet_maker.hpp"
#include "tests/unit/sim/scenes.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using namespace std::chrono_literals;

const Utime kStart = Utime(1'781'532'600s);

void ExpectExactCounts(const Service& service, const sim::FaultTotals& totals) {
  const auto report = service.Report();
  EXPECT_EQ(support::CountOf(report, "data_packets_whole"), totals.num_sent);
  EXPECT_EQ(support::CountOf(report, "data_lost"), totals.num_dropped);
  EXPECT_EQ(support::CountOf(report, "data_duplicate"), totals.num_doubled);
  EXPECT_EQ(support::CountOf(report, "data_reordered"), totals.num_swapped);
  for (const auto* name : {"data_late", "data_overlapping", "data_azimuth_disagrees", "sensor_restarts", "sensor_clock_steps"}) {
    EXPECT_EQ(support::CountOf(report, name), 0) << name;
  }
}

// A minute of a lidar through a faulty network.
sim::FaultTotals FeedMinute(Service& service, bus::MemoryBus& bus, const sim::FaultParams& params, std::uint8_t mode, std::uint64_t seed) {
  constexpr auto kDuration = 60s;
  test::SpinningSensor sensor;
  sensor.mode = mode;
  sensor.rpm = 300.0 + 100.0 * static_cast<double>(seed % 10);
  sensor.time_ns = 3'570'000'000'000;  // the hour begins in the middle
  const auto first_ns = sensor.time_ns;
  sim::FaultyNetwork network(
      [&]() -> std::optional<sim::Datagram> {
        const Utime time = kStart + std::chrono::microseconds((sensor.time_ns - first_ns + sensor.period().count()) / 1000);
        if (time > kStart + kDuration) return std::nullopt;
        return sim::Datagram{time, format::kDataPort, sensor.Next()};
      },
      {}, params, format::kDataPort, kStart, kStart + kDuration, seed);
  while (const auto datagram = network.Next()) {
    service.OnDatagram(datagram->time, datagram->port, datagram->payload);
    support::HandleAll(bus);
  }
  service.Finish(kStart + kDuration);
  return network.totals();
}

TEST(Vlp16Faults, AreCountedExactlyOverAMinute) {
  for (const auto& params : {sim::FaultParams{0.05, 0.02, 0.02}, sim::FaultParams{0.3, 0.2, 0.3}}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " drop " << params.drop_share);
      bus::MemoryBus bus;
      Service service(bus, Params{});
      const auto totals = FeedMinute(service, bus, params, seed % 2 == 0 ? format::kModeDual : format::kModeStrongest, seed);
      EXPECT_GT(totals.num_made, 45'000);
      ExpectExactCounts(service, totals);
    }
  }
}

// By way of a capture, with position packets and the latencies of the simulator.
TEST(Vlp16Faults, AreCountedExactlyOutOfACapture) {
  const support::TempDir folder;
  const auto file = folder / "file.pcap";
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    sim::SimulationParams params;
    params.lidar.model = seed == 3 ? Model::kPuckHiRes : Model::kVlp16;
    params.start = kStart;
    params.duration = 5s;
    params.seed = seed;
    auto scene = sim::MakeScene("open_water", seed);
    scene.effects.set_return_mode(seed == 2 ? config::Scene::DUAL : config::Scene::STRONGEST);
    sim::Simulation simulation(scene, sim::SmallBoat(), params, nullptr);
    sim::FaultyNetwork network([&] { return simulation.Next(); }, {}, {0.05, 0.02, 0.02}, params.data_port, kStart, kStart + params.duration, seed);
    sim::PcapSink sink(file, {params.data_port, params.navigation.position_port}, {.force = true});
    while (const auto datagram = network.Next()) sink.Send(*datagram);
    sink.Finish().Commit();

    bus::MemoryBus bus;
    Service service(bus, Params{});
    CaptureReader reader(file);
    Utime last_time{};
    while (const auto datagram = reader.Next()) {
      last_time = datagram->host_time;
      service.OnDatagram(datagram->host_time, datagram->destination_port, datagram->payload);
      support::HandleAll(bus);
    }
    service.Finish(last_time);
    EXPECT_GT(network.totals().num_dropped, 100);
    ExpectExactCounts(service, network.totals());
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace lookout::vlp16
