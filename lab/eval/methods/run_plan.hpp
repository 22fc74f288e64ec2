// The runs: scenes, and which seeds of them may choose values and which may make tables.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lab/eval/methods/render.hpp"

namespace lookout::eval {

/// Seeds of sweeps, and of every choice of a default: ours (1 to 4) and the peers' (1 to 4) were chosen on these. The guards of the tests, too.
inline constexpr std::uint64_t kFirstTuningSeed = 1;
inline constexpr std::uint64_t kLastTuningSeed = 100;

/// Seeds of tables and figures: these and above. Nothing was ever chosen on them: a figure on seeds that chose the method flatters it.
inline constexpr std::uint64_t kFirstTableSeed = 101;

enum class SeedUse { kTuning, kTables };

struct RunPlan {
  std::vector<std::string> scenes;  // names or files (sim::FindScene)
  std::uint64_t first_seed = 1;
  int num_seeds = 1;
  double seconds = 2.0;  // of each scene and seed
  /// Heads (sim::HeadNames) that look at the scenes in place of their own; of several each seed has another in turn, and scenes begin with different
  /// ones. Empty: as the scenes say.
  std::vector<std::string> lidars{};

  /// @throws std::invalid_argument when one of the seeds is of the other range; says both ranges
  void CheckSeeds(SeedUse use) const;
};

/// Names of scenes: `families` and `all` (scenes that are no families) become those of the folder, others stay.
std::vector<std::string> NamesOfScenes(const std::vector<std::string>& names, const std::filesystem::path& config_folder);

/// Checks names of heads. @throws std::invalid_argument for one that is none; it says which there are
void CheckLidars(const std::vector<std::string>& names);

/// Name of a scene in tables: the name itself, or the file's name without folder and ending.
std::string SceneLabel(const std::string& name_or_path);

/// Renders scene after scene, seed after seed, and calls with each scan.
///
/// @param progress  for people (runtime::Progress); nullptr: silent
/// @param program   whose lines they are
/// @throws config::ConfigError for scenes that are wrong, with the faults of all: each is laid out with each of its seeds before the first is
/// rendered
void ForEachScan(const RunPlan& plan, const Boat& boat, std::FILE* progress,
                 const std::function<void(const ScanPlace&, const LabelledScan&)>& on_scan, const std::string& program = "lookout-eval");

}  // namespace lookout::eval
