// How long it takes to render the scenes. The counter seconds_per_second is what one simulated second costs.
#include <benchmark/benchmark.h>
#include <filesystem>
#include <string>

#include "common/config/boat.hpp"
#include "lab/sim/simulation.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/sim/scenes.hpp"

namespace lookout::sim {
namespace {

void BM_Render(benchmark::State& state, const std::string& name) {
  using namespace std::chrono_literals;
  const auto scene = MakeScene(name, 1);
  const auto boat = config::LoadBoat(support::kDemoConfig);
  SimulationParams params;
  params.start = Utime(1'781'532'600s);
  params.duration = 1s;
  for (auto _ : state) {
    Simulation simulation(scene, boat, params, nullptr);
    while (const auto datagram = simulation.Next()) benchmark::DoNotOptimize(datagram->payload.data());
  }
  state.counters["seconds_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

const bool kAreRegistered = [] {
  for (const auto& name : SceneNames()) benchmark::RegisterBenchmark(("BM_Render/" + name).c_str(), BM_Render, name)->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace lookout::sim
