// Placing one turn, against a rotation period of 100 ms.
#include <benchmark/benchmark.h>
#include <cmath>

#include "services/georeferencer/core/georeferencer.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

// A turn of so many obstacles with outlines of 20 corners, with two minutes of poses behind.
void PlaceTurn(benchmark::State& state) {
  Georeferencer georeferencer(PlacementParams{}, std::chrono::seconds(1));
  for (int i = 0; i <= 6000; ++i) georeferencer.AddPose(test::MakePose(20'000 * i));
  constexpr std::int64_t kTurnUs = 119'000'000;
  std::vector<Segment> segments;
  for (int id = 1; id <= state.range(0); ++id) {
    auto segment = test::MakePoint(kTurnUs + 50'000, 30.0, 0.0, 0.0);
    segment.id = id;
    segment.hull.clear();
    for (int i = 0; i < 20; ++i) segment.hull.push_back({{30.0 + std::cos(0.314 * i), std::sin(0.314 * i)}, test::At(kTurnUs + 1000 * i)});
    segments.push_back(segment);
  }
  const auto part = test::MakePart(kTurnUs, 0, segments);
  for (auto _ : state) benchmark::DoNotOptimize(georeferencer.AddSegments(part));
}
BENCHMARK(PlaceTurn)->Arg(10)->Arg(50)->Arg(500)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace lookout::georeferencer
