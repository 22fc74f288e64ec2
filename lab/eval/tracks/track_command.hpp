// lookout-eval --tracks: trackers against the truth of simulated scenes and of captures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lab/eval/tracks/multi_object_tracker.hpp"
#include "lab/eval/tracks/track_sources.hpp"

namespace lookout::eval {

struct TrackOptions : RunOptions {
  /// Folders of captures, each a world of its own. A folder without truth of returns has truth of objects alone: no labels are scored.
  std::vector<std::filesystem::path> captures;
  std::filesystem::path lost_file;       // causes of a lower MOTA, a row of CSV for each scan and thing or track; empty = none
  bool has_ablation = false;             // the boat's tracker without each of its parts beside it, in one table
  std::set<std::string> left_out;        // families whose runs have evidence that was fitted without them (LeaveOutEvidence); one table of labels
  bool is_without_earth = false;         // simulated boats have neither receiver nor compass: tracks are in POSE's relative frame
  std::filesystem::path weights_folder;  // of the evidence of left_out
};

/// Trackers beside the boat's own in each table. A further tracker is a further line here.
MultiObjectTrackers MakeTrackers();

/// Runs all services on each scene and seed, and on each capture, and prints the tables to stdout, progress to stderr. @return exit code
/// The boat's tracks have a row where one of the services publishes TRACKS.
/// @throws config::ConfigError; std::invalid_argument for seeds of the other range; std::runtime_error for files
int EvaluateTracks(const TrackOptions& options);

}  // namespace lookout::eval
