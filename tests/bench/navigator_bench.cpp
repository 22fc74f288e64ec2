// Cost of navigation: 20 s of a simulated boat (GNSS 5 Hz, HDT and ROT 20 Hz, PASHR 50 Hz, IMU 100 Hz) from its sentences to poses.
#include <benchmark/benchmark.h>
#include <vector>

#include "lab/sim/navigation.hpp"
#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/navigator.hpp"
#include "services/navigator/params.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/sim/scenes.hpp"

namespace lookout::navigator {
namespace {

constexpr int kSeconds = 20;
const Utime kStart = Utime(std::chrono::seconds(1'781'532'600));
const std::string kDemo = support::kDemoConfig.string();

std::vector<Item> Items() {
  const auto boat = config::LoadBoat(kDemo);
  const auto scene = sim::MakeScene("waves", 1);
  const sim::FaultPlan plan;
  const sim::NavigationParams params;
  sim::Navigation navigation(scene, boat, params, plan, kStart, 1);
  std::vector<sim::Datagram> datagrams;
  while (navigation.next_time() < kStart + std::chrono::seconds(kSeconds)) {
    for (auto& datagram : navigation.Next()) {
      if (datagram.port == params.nmea_port) datagrams.push_back(std::move(datagram));
    }
  }
  std::ranges::stable_sort(datagrams, {}, &sim::Datagram::time);
  std::vector<Item> items{{kStart, 0, ItemKind::kStart, {}, {}}};
  for (const auto& datagram : datagrams) {
    const auto seq = static_cast<std::int64_t>(items.size());
    items.push_back({datagram.time, seq, ItemKind::kSentence, kUdpSource, SplitDatagram(datagram.payload).lines.at(0)});
  }
  return items;
}

// Per second of the boat: 10 ms would be 1 % of a core.
void BenchNavigator(benchmark::State& state) {
  const auto items = Items();
  const auto params = LoadParams(kDemo).navigator;
  std::size_t num_poses = 0;
  for (auto _ : state) {
    Navigator navigator(params);
    for (const auto& item : items) num_poses += navigator.Consume(item).poses.size();
  }
  state.counters["poses"] = static_cast<double>(num_poses) / static_cast<double>(state.iterations());
  state.counters["cpu_s_per_boat_s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kSeconds, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(BenchNavigator)->Unit(benchmark::kMillisecond);

// What reading the sentences costs, without filter.
void BenchInterpreter(benchmark::State& state) {
  const auto items = Items();
  const auto params = LoadParams(kDemo).navigator;
  for (auto _ : state) {
    Interpreter interpreter(params);
    for (const auto& item : items) {
      if (item.kind == ItemKind::kSentence) benchmark::DoNotOptimize(interpreter.Read(item));
    }
  }
}
BENCHMARK(BenchInterpreter)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lookout::navigator
