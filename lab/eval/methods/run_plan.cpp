#include "lab/eval/methods/run_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "common/config/text_config.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "lab/sim/heads.hpp"
#include "lab/sim/scene_file.hpp"

namespace lookout::eval {

void RunPlan::CheckSeeds(SeedUse use) const {
  const std::uint64_t last_seed = first_seed + static_cast<std::uint64_t>(num_seeds) - 1;
  const auto ranges =
      fmt::format(" (seeds of tuning are {} to {}, those of tables {} and above)", kFirstTuningSeed, kLastTuningSeed, kFirstTableSeed);
  if (last_seed < first_seed) throw std::invalid_argument(fmt::format("{} seeds from {} on: there are not so many{}", num_seeds, first_seed, ranges));
  const auto seeds = fmt::format("seeds {} to {}", first_seed, last_seed);
  if (use == SeedUse::kTables && first_seed < kFirstTableSeed) {
    throw std::invalid_argument(seeds + ": tables are not made on seeds of tuning" + ranges + "; --tuning shows them without making a table");
  }
  if (use == SeedUse::kTuning && (first_seed < kFirstTuningSeed || last_seed > kLastTuningSeed)) {
    throw std::invalid_argument(seeds + ": nothing is tuned on seeds of tables" + ranges);
  }
}

void CheckLidars(const std::vector<std::string>& names) {
  const auto known = sim::HeadNames();
  for (const auto& name : names) {
    if (std::ranges::find(known, name) == known.end())
      throw std::invalid_argument(fmt::format("--lidar {}: there is no such head; there are: {}", name, fmt::join(known, ", ")));
  }
}

std::vector<std::string> NamesOfScenes(const std::vector<std::string>& names, const std::filesystem::path& config_folder) {
  std::vector<std::string> scenes;
  scenes.reserve(names.size());
  for (const auto& name : names) {
    if (name != "families" && name != "all") {
      scenes.push_back(name);
      continue;
    }
    for (const auto& known : name == "families" ? sim::ListFamilies(config_folder) : sim::ListScenes(config_folder)) scenes.push_back(known.name);
  }
  return scenes;
}

std::string SceneLabel(const std::string& name_or_path) { return std::filesystem::path(name_or_path).stem().string(); }

namespace {

// A layout that a seed cannot draw is told before hours are spent on the others.
std::vector<std::filesystem::path> CheckedFiles(const RunPlan& plan, const Boat& boat, std::FILE* progress, const std::string& program) {
  runtime::Progress shown(program, progress);
  std::vector<std::filesystem::path> files;
  config::FaultList faults;
  for (const auto& scene : plan.scenes) {
    files.push_back(sim::FindScene(scene, boat.config_folder));
    for (int k = 0; k < plan.num_seeds; ++k) {
      io::ThrowIfStopAsked();
      faults.Try([&] { sim::LoadScene(files.back(), plan.first_seed + static_cast<std::uint64_t>(k)); });
      const double done = static_cast<double>(files.size()) - 1.0 + static_cast<double>(k) / plan.num_seeds;
      shown.Update(done / static_cast<double>(plan.scenes.size()), [] { return "checking the layouts"; });
    }
  }
  faults.ThrowIfAny();
  return files;
}

}  // namespace

void ForEachScan(const RunPlan& plan, const Boat& boat, std::FILE* progress,
                 const std::function<void(const ScanPlace&, const LabelledScan&)>& on_scan, const std::string& program) {
  const auto files = CheckedFiles(plan, boat, progress, program);
  runtime::Progress shown(program, progress);
  const auto num_runs = static_cast<double>(files.size()) * plan.num_seeds;
  for (std::size_t i = 0; i < files.size(); ++i) {
    ScanPlace place{SceneLabel(plan.scenes[i]), 0, 0};
    for (int k = 0; k < plan.num_seeds; ++k) {
      place.seed = plan.first_seed + static_cast<std::uint64_t>(k);
      place.index = 0;
      auto scene = sim::LoadScene(files[i], place.seed);
      if (!plan.lidars.empty()) scene.lidar = plan.lidars[(i + static_cast<std::size_t>(k)) % plan.lidars.size()];
      RenderScans(scene, boat, place.seed, plan.seconds, [&](const LabelledScan& truth) {
        io::ThrowIfStopAsked();
        on_scan(place, truth);
        ++place.index;
        shown.Update((static_cast<double>(i) * plan.num_seeds + k) / num_runs, [&] { return fmt::format("{}, seed {}", place.scene, place.seed); });
      });
    }
  }
}

}  // namespace lookout::eval
