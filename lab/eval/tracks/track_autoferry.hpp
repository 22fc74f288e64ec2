// lookout-eval --autoferry: trackers on real lidar detections, against where two boats truly were.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "lab/eval/table.hpp"
#include "lab/eval/tracks/multi_object_tracker.hpp"
#include "lab/eval/tracks/track_gospa.hpp"
#include "tools/import/autoferry.hpp"

namespace lookout::eval {

/// Truths and tracks farther from the ferry do not count.
inline constexpr std::array<double, 4> kFerryRangesM{50.0, 75.0, 100.0, std::numeric_limits<double>::infinity()};
/// Switches are counted within this range.
inline constexpr double kSwitchRangeM = 100.0;

struct FerryScores {
  std::array<Gospa, kFerryRangesM.size()> gospa;  // as kFerryRangesM; over all scans
  /// Over the scans in which a boat truly is within the range. A boat that is far off in most scans tells little about a tracker near by.
  std::array<Gospa, kFerryRangesM.size()> with_boat;
  std::int64_t num_switches = 0;

  FerryScores();
  void Add(const FerryScores& other);
};

/// @param tracks  [scans] reported ones count
/// Truth at the time of a scan: straight between its neighbours; a target counts between its first and its last place. Switches as in ScoreTracks,
/// with the cut-off of GOSPA as the gate of centres.
FerryScores ScoreFerry(const std::vector<importer::FerryScan>& scans, const importer::FerryTruth& truth,
                       const std::vector<std::vector<TrackState>>& tracks);

/// The tracks of each tracker after each scan: `trackers`, and before them the boat's own, where replay can run it.
struct FerryTracks {
  std::string tracker;
  std::vector<std::vector<TrackState>> tracks;
};
/// @param config_folder  of the boat's own tracker
std::vector<FerryTracks> TrackFerry(const std::filesystem::path& config_folder, const std::vector<importer::FerryScan>& scans,
                                    const MultiObjectTrackers& trackers);

struct FerryOptions {
  std::filesystem::path folder;                    // of the scenarios
  std::filesystem::path config_folder;             // of the boat's own tracker; empty: the ferry's own hull, and defaults
  std::vector<std::filesystem::path> block_files;  // in whose marked blocks the table is written (FillBlocks)
};

/// Prints the table of all scenarios in a folder. Scenarios up to 9 are in open water, the others in the channel. @return exit code
/// @throws std::runtime_error for files, and where there is none; config::ConfigError
int EvaluateAutoferry(const FerryOptions& options);

}  // namespace lookout::eval
