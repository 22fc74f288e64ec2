#include "lab/eval/sensor_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "common/io/stop_signal.hpp"
#include "lab/eval/methods/figures.hpp"
#include "lab/eval/methods/method_comparison.hpp"
#include "lab/eval/methods/results.hpp"
#include "lab/eval/metrics.hpp"
#include "lab/eval/table.hpp"
#include "lab/eval/tracks/over_time.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {
namespace {

// Size of the scans of one head.
struct ScanSize {
  int num_rings = 0;
  int num_columns = 0;
  Mean returns;
};

Outcomes OutcomesOf(const Score& total) {
  Outcomes outcomes;
  for (const auto& [kind, of_kind] : total.outcomes_by_kind) outcomes.Add(of_kind);
  return outcomes;
}

Table MakeTable() { return Table({"sensor", "rings_x_columns", "returns", "method", "mIoU_%", "water_%", "lost_%", "false", "median_ms", "p99_ms"}); }

void AddRows(const std::string& lidar, const ScanSize& size, const Results& results, Table& table) {
  for (const auto& method : results.methods) {
    const Score total = Total(method);
    Summary time_ms;
    for (const double value : total.time_ms) time_ms.Add(value);
    const bool is_timed = !total.time_ms.empty();
    table.Add({lidar, fmt::format("{} x {}", size.num_rings, size.num_columns), Number(size.returns.value(), 0), method.method,
               Percent(MeanOverScenes(results, method, &Score::iou)), Percent(MeanOverScenes(results, method, &Score::water_iou)),
               Percent(OutcomesOf(total).ShareLost()), Number(MeanOverScenes(results, method, &Score::false_segments), 2),
               is_timed ? Number(time_ms.Median(), 2) : "-", is_timed ? Number(time_ms.Percentile(99), 2) : "-"});
  }
}

}  // namespace

int CompareSensors(const ComparisonOptions& options) {
  const auto boat = LoadBoat(options.config_folder);
  const auto use = options.is_tuning ? SeedUse::kTuning : SeedUse::kTables;
  auto plan = PlanOf(options, use);
  if (plan.scenes.empty()) throw std::invalid_argument("--lidar needs --scenes");
  plan.CheckSeeds(use);
  if (options.is_tuning && !(options.csv_folder.empty() && options.block_files.empty())) {
    throw std::invalid_argument("--tuning: no table is written of seeds of tuning: leave out --csv and --blocks");
  }
  io::CatchStopSignals();
  Table table = MakeTable();
  const std::string name = options.scenes == std::vector<std::string>{"families"} ? "sensors_families" : "sensors";
  TableFiles files(options.csv_folder, {{name, "", table}}, options.is_forced);  // before all work
  FillBlocksOf(options.block_files, {});
  std::int64_t num_scans = 0;
  for (const auto& lidar : options.lidars) {
    plan.lidars = {lidar};
    const auto methods = MethodsOf(options, boat, [&] {
      replay::CheckConfig(options.config_folder);
      return std::make_unique<OverTimeMethod>(options.config_folder, FeedOfScenes(options.config_folder, plan.scenes, plan.seconds, lidar));
    });
    MethodComparison comparison(methods);
    ScanSize size;
    ForEachScan(plan, boat, stderr, [&](const ScanPlace& place, const LabelledScan& truth) {
      size.num_rings = truth.scan.head.num_rings();
      size.num_columns = std::max(size.num_columns, truth.scan.columns.size());
      size.returns.Add(static_cast<double>(std::ranges::count_if(truth.scan.columns.range, [](std::uint16_t range) { return range != 0; })));
      comparison.Add(place, truth);
      ++num_scans;
    });
    Results results;
    results.methods = comparison.results();
    for (const auto& scene : plan.scenes) results.scenes.push_back(SceneLabel(scene));
    AddRows(lidar, size, results, table);
    std::cerr << fmt::format("lookout-eval: {} done\n", lidar);
  }
  const std::vector<NamedTable> tables{{name, "By sensor: mean over the scenes; lost: things of 5 returns or more, over all scans", table}};
  PrintTables(tables, std::cout);
  files.Commit(tables);
  const auto scope = fmt::format("Own simulator: {} scans of {} scenes, {} seeds each from {} on, {:.1f} s a seed, by each head; times on {}.",
                                 num_scans, plan.scenes.size(), plan.num_seeds, plan.first_seed, plan.seconds, Computer());
  if (!options.block_files.empty()) FillBlocksOf(options.block_files, FiguresOf(tables, scope));
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
