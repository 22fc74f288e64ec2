// A scan of a VLP-16 from scan to segments by the paper's method, whole and by steps. Whole scans of ours stand in segmenter_scans.cpp.
// Scenes (second argument): 0 lake, 1 lake in rain (2880 drops), 2 nothing but 5000 drops, 3 a return on every beam.
#include <benchmark/benchmark.h>
#include <numeric>
#include <optional>

#include "services/segmenter/core/segmenter.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace {

using namespace lookout;
using namespace lookout::segmenter;

constexpr std::uint64_t kSeed = 20261121;

Scan MakeScan(int scene) {
  auto scan = test::EmptyScan({});
  for (std::size_t ring = 0; ring < scan.head.rings.size(); ++ring) {
    scan.head.rings[ring].azimuth_offset_rad = static_cast<float>(DegToRad(0.0083 * static_cast<double>(ring)));  // as at 600 rpm
  }
  auto walls = test::Lake(kSeed);
  if (scene == 3) {
    // The lake in a basin with walls of any height.
    test::AddBoat(walls, 0.0, 0.0, 0.1, 120.0, 60.0, -1000.0, 1000.0);
  }
  if (scene != 2) test::Look(scan, walls, 0.03, kSeed);
  if (scene == 1) test::AddRain(scan, 2880, kSeed);
  if (scene == 2) test::AddRain(scan, 5000, kSeed);
  return scan;
}

// What stands before each step.
struct Bench {
  explicit Bench(benchmark::State& state) : scan(MakeScan(static_cast<int>(state.range(1)))) {
    params.method = Method::kPaper;
    params.labelling.image_columns = static_cast<int>(state.range(0));
    classified = ClassifyReturns(scan, params.filter);
    all.resize(classified.returns.size());
    std::iota(all.begin(), all.end(), 0);
    image = Project();
    components = LabelComponents(scan, classified.returns, params.labelling);
    centroids = Centroids(classified.returns, components);
    clusters = ClusterComponents(centroids, params.clustering);
    state.counters["returns"] = static_cast<double>(all.size());
    state.counters["components"] = components.count;
    state.counters["segments"] = static_cast<double>(SegmentScan(scan, params).segments.size());
  }

  RangeImage Project() const {
    return params.labelling.image_columns == 0 ? ProjectToOwnColumns(scan, classified.returns)
                                               : ProjectToAzimuths(scan, classified.returns, all, params.labelling.image_columns);
  }

  Params params;
  Scan scan;
  ClassifiedReturns classified;
  std::vector<std::int32_t> all;
  RangeImage image;
  Groups components;
  std::vector<ComponentCentroid> centroids;
  std::vector<std::int32_t> clusters;
};

void Classify(benchmark::State& state) {
  const Bench bench(state);
  for (auto _ : state) benchmark::DoNotOptimize(ClassifyReturns(bench.scan, bench.params.filter));
}

void Projection(benchmark::State& state) {
  const Bench bench(state);
  for (auto _ : state) benchmark::DoNotOptimize(bench.Project());
}

void Search(benchmark::State& state) {
  const Bench bench(state);
  for (auto _ : state) benchmark::DoNotOptimize(SearchComponents(bench.image, bench.classified.returns, bench.params.labelling.search));
}

// Projection, search and what shadowed returns take on top.
void Labelling(benchmark::State& state) {
  const Bench bench(state);
  for (auto _ : state) benchmark::DoNotOptimize(LabelComponents(bench.scan, bench.classified.returns, bench.params.labelling));
}

void Clustering(benchmark::State& state) {
  const Bench bench(state);
  for (auto _ : state) benchmark::DoNotOptimize(ClusterComponents(Centroids(bench.classified.returns, bench.components), bench.params.clustering));
}

void Measuring(benchmark::State& state) {
  const Bench bench(state);
  for (auto _ : state) {
    Numbering numbering;
    numbering.Number(bench.components, bench.clusters, 1, 32767);
    benchmark::DoNotOptimize(Measure(bench.scan, bench.classified.returns, numbering.groups(), Eigen::Vector3d::UnitZ()));
  }
}

void WholeScan(benchmark::State& state) {
  const Bench bench(state);
  for (auto _ : state) benchmark::DoNotOptimize(SegmentScan(bench.scan, bench.params));
}

// The paper's method to the letter: shadowed returns have no label.
void WholeScanOfThePaper(benchmark::State& state) {
  Bench bench(state);
  bench.params.labelling.label_shadowed_returns = false;
  for (auto _ : state) benchmark::DoNotOptimize(SegmentScan(bench.scan, bench.params));
}

// Columns 0 = the scan's own, 1808.
void EachImage(benchmark::internal::Benchmark* benchmark) {
  for (const int scene : {0, 1, 2, 3}) {
    for (const int columns : {0, 512, 1024, 1800}) benchmark->Args({columns, scene});
  }
  benchmark->ArgNames({"columns", "scene"})->Unit(benchmark::kMicrosecond)->MinTime(0.2);
}

BENCHMARK(Classify)->Apply(EachImage);
BENCHMARK(Projection)->Apply(EachImage);
BENCHMARK(Search)->Apply(EachImage);
BENCHMARK(Labelling)->Apply(EachImage);
BENCHMARK(Clustering)->Apply(EachImage);
BENCHMARK(Measuring)->Apply(EachImage);
BENCHMARK(WholeScan)->Apply(EachImage);
BENCHMARK(WholeScanOfThePaper)->Apply(EachImage);

}  // namespace
