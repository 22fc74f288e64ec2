// The command: scenes in, labelled pixels for training out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lookout::learned {

struct Options {
  std::filesystem::path config_folder;
  std::vector<std::string> scenes;
  std::uint64_t first_seed = 1;
  int num_seeds = 90;
  double seconds = 0.2;           // of each scene and seed
  std::filesystem::path out;      // folder
  std::filesystem::path weights;  // NAME.json of a trained network, whose probabilities are written, too; empty: none
  bool is_forced = false;         // files that are there are replaced
};

/// Writes scans.csv and returns.bin (README), and with `weights` probabilities.bin. Equal options give equal bytes.
///
/// @return the exit code
/// @throws config::ConfigError, std::invalid_argument for mistakes of the user; std::runtime_error
int ExportScenes(const Options& options);

}  // namespace lookout::learned
