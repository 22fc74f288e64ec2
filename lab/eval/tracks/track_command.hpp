// lookout-eval --tracks: trackers against the truth of simulated scenes and of captures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/eval/methods/run_plan.hpp"
#include "lab/eval/tracks/multi_object_tracker.hpp"

namespace lookout::eval {

struct TrackOptions {
  std::filesystem::path config_folder;
  RunPlan plan;                                    // scenes may be none
  bool is_tuning = false;                          // seeds of tuning
  std::filesystem::path captures;                  // empty = none
  std::filesystem::path csv_folder;                // empty = none
  std::filesystem::path lost_file;                 // what costs MOTA, a row of CSV for each scan and thing or track; empty = none
  bool is_forced = false;                          // files that are there are replaced
  std::vector<std::filesystem::path> block_files;  // in whose marked blocks the tables are written (FillBlocks)
};

/// What stands beside the boat's own tracker in each table. A further tracker is a further line here.
MultiObjectTrackers MakeTrackers();

/// Runs all services on each scene and seed, and on each capture, and prints the tables to stdout, progress to stderr. @return exit code
/// The boat's tracks have a row where one of the services publishes TRACKS.
/// @throws config::ConfigError; std::invalid_argument for seeds of the other range; std::runtime_error for files
int EvaluateTracks(const TrackOptions& options);

}  // namespace lookout::eval
