// lookout-eval --navigation: own motion by the lidar, and POSE with it and without it, on simulated scenes.
#pragma once

#include <filesystem>

#include "lab/eval/tracks/track_sources.hpp"

namespace lookout::eval {

struct NavigationOptions : RunOptions {
  double gap_begin_s = 15.0;          // of the runs with a gap
  double gap_s = 60.0;                // its length
  std::filesystem::path kept_folder;  // the motions of earlier calls; empty = none
  bool has_kiss_icp = false;          // own motion beside KISS-ICP, without POSE; the gap and kept motions have no meaning
};

/// Simulates each scene and seed, and prints the tables to stdout, progress to stderr. @return exit code
/// @throws config::ConfigError; std::invalid_argument for seeds of the other range, or where the gap does not end in the run; std::runtime_error for
/// files
int EvaluateNavigation(const NavigationOptions& options);

}  // namespace lookout::eval
