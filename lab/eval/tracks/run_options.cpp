#include "lab/eval/tracks/run_options.hpp"

#include <stdexcept>

#include "common/io/stop_signal.hpp"
#include "lab/eval/methods/figures.hpp"
#include "lab/sim/scene_file.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {

void BeginRuns(const RunOptions& options, bool has_captures, const std::string& option) {
  if (!options.plan.scenes.empty()) options.plan.CheckSeeds(options.is_tuning ? SeedUse::kTuning : SeedUse::kTables);
  if (options.is_tuning && !(options.csv_folder.empty() && options.block_files.empty())) {
    throw std::invalid_argument("--tuning: no table is written of seeds of tuning: leave out --csv and --blocks");
  }
  if (options.plan.scenes.empty() && !has_captures) throw std::invalid_argument(option + " needs --scenes or --captures");
  replay::CheckConfig(options.config_folder);
  io::CatchStopSignals();
  FillBlocksOf(options.block_files, {});
}

void ForEachRun(const RunOptions& options,
                const std::function<void(const std::filesystem::path& file, const std::string& scene, std::uint64_t seed)>& handle) {
  for (const auto& name : options.plan.scenes) {
    const auto file = sim::FindScene(name, options.config_folder);
    const auto scene = SceneLabel(name);
    for (int k = 0; k < options.plan.num_seeds; ++k) handle(file, scene, options.plan.first_seed + static_cast<std::uint64_t>(k));
  }
}

}  // namespace lookout::eval
