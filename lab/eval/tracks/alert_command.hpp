// lookout-eval --alerts: the boat's alerts against the truth of simulated scenes and of captures.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "lab/eval/tracks/track_sources.hpp"

namespace lookout::eval {

/// A run is no longer than its scene says that it lasts.
struct AlertOptions : RunOptions {
  double berth_seconds = 60.0;                  // seconds of each seed, where the own boat lies in its berth
  std::vector<std::filesystem::path> captures;  // folders; a missing folder is reported and left out
  std::size_t num_jobs = 1;                     // runs at once
  std::filesystem::path kept_folder;            // keeps the tracker's inputs, for use again (KeptRun); empty = none
  std::filesystem::path list_file;              // each alert and danger, a row of CSV; empty = none
  bool are_figures_long = false;                // blocks of long_alerts_... in place of alerts_...
};

/// Runs all services on each scene and seed, and on each capture, and prints the tables to stdout, progress to stderr. @return exit code
/// The same figures for any number of jobs. @throws config::ConfigError; std::invalid_argument for seeds of the other range; std::runtime_error for
/// files
int EvaluateAlerts(const AlertOptions& options);

}  // namespace lookout::eval
