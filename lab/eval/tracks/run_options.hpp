// What the judging of tracks and that of alerts are asked for alike.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lab/eval/methods/run_plan.hpp"

namespace lookout::eval {

struct RunOptions {
  std::filesystem::path config_folder;
  RunPlan plan;                                    // scenes may be none
  bool is_tuning = false;                          // seeds of tuning
  std::filesystem::path csv_folder;                // empty = none
  bool is_forced = false;                          // files that are there are replaced
  std::vector<std::filesystem::path> block_files;  // in whose marked blocks the tables are written (FillBlocks)
};

/// Before all work: checks config, seeds and blocks, and catches signals to stop.
///
/// @param option  of the command line, for errors: "--tracks"
/// @throws config::ConfigError; std::invalid_argument for seeds of the other range and where nothing is to be run; std::runtime_error for files
void BeginRuns(const RunOptions& options, bool has_captures, const std::string& option);

/// Calls handle(file, scene, seed) for each scene and seed of the plan.
void ForEachRun(const RunOptions& options,
                const std::function<void(const std::filesystem::path& file, const std::string& scene, std::uint64_t seed)>& handle);

}  // namespace lookout::eval
