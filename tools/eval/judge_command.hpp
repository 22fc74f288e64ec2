// lookout-eval --config: methods against the truth of simulated scenes, or of recordings of others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lookout::eval {

struct JudgeOptions {
  std::string command;  // for the report
  std::filesystem::path config_folder;
  std::vector<std::string> scenes;  // "all", names or files
  std::vector<std::string> points;  // turns out of files: .pcd, or .bin with a .label beside it or without
  std::uint64_t first_seed = 1;
  int num_seeds = 20;
  double seconds = 2.0;
  std::vector<std::string> methods;  // MakeMethods
  std::vector<std::string> sweeps;   // ParseSweep
  std::vector<int> tests;            // RunPaperTest
  std::filesystem::path csv_folder;  // empty = none, and so below
  std::filesystem::path html_file;
};

/// Prints tables to stdout and progress to stderr, and writes the files that are asked for. @return exit code
/// @throws config::ConfigError, std::invalid_argument for a wrong line; std::runtime_error when a file cannot be written
int JudgeScenes(const JudgeOptions& options);

}  // namespace lookout::eval
