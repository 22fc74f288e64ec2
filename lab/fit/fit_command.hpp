// The command: scenes in, a file of evidence out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lookout::fit {

struct Options {
  std::string command;  // command line, as it was given
  std::filesystem::path config_folder;
  std::vector<std::string> scenes;
  std::vector<std::string> lidars;  // RunPlan::lidars
  std::vector<std::string> without;
  std::vector<std::string> hold_out;
  std::uint64_t first_seed = 1;
  int num_seeds = 10;
  double seconds = 0.5;  // of each scene and seed
  int num_trees = 100;
  std::vector<std::string> dropped;  // features that are not asked for
  std::filesystem::path out;         // empty: tables alone
  bool is_forced = false;
};

/// @return the exit code
/// @throws config::ConfigError, std::invalid_argument for mistakes of the user; std::runtime_error
int FitScenes(const Options& options);

}  // namespace lookout::fit
