// Tables of scores of tracks: one for each family of figures. TRACKS.md defines the columns.
#pragma once

#include <string>
#include <vector>

#include "lab/eval/table.hpp"
#include "lab/eval/tracks/track_run.hpp"

namespace lookout::eval {

/// Scores of a tracker on the runs of a scene.
struct TrackRow {
  std::string scene;  // with "second world: " before it, or as it is
  TrackRun::Row row;
};

/// One row of each scene and tracker: runs of one are added. Order: as they come first.
std::vector<TrackRow> AddUp(const std::vector<TrackRow>& runs);
/// Rows over all scenes, called `name`; labels are means over the scenes.
std::vector<TrackRow> OverAll(const std::vector<TrackRow>& rows, const std::string& name);

std::vector<NamedTable> TablesOf(const std::vector<TrackRow>& rows);
/// The figures that change most where a part of the tracker is left out: a line for each row.
NamedTable AblationTable(const std::vector<TrackRow>& rows);
/// Labels alone, of runs with evidence that does not know their scene.
NamedTable LeftOutTable(const std::vector<TrackRow>& rows);

}  // namespace lookout::eval
