// Targets for tracks, and the reached values: TRACKS.md.
#pragma once

#include <string>
#include <vector>

#include "lab/eval/tracks/track_tables.hpp"

namespace lookout::eval {

/// Runs of one world, called `name`.
struct TrackWorld {
  std::string name;
  std::vector<TrackRow> scenes;  // one row of each scene and tracker (AddUp)
  std::string over_all;          // name of the row over all of them
};

/// A row for each target and world: the value of `tracker`, whether it reaches the target, the scene that is farthest from it, and the value of
/// `other`. A target that no scene of a world shows has no row.
NamedTable TargetTable(const std::vector<TrackWorld>& worlds, const std::string& tracker, const std::string& other);

}  // namespace lookout::eval
