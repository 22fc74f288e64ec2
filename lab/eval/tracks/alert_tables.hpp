// Tables of scores of alerts. ALERTS.md defines the columns.
#pragma once

#include <string>
#include <vector>

#include "lab/eval/table.hpp"
#include "lab/eval/tracks/alert_scores.hpp"

namespace lookout::eval {

/// Scores of alerts on the runs of a scene.
struct AlertRow {
  std::string scene;  // with "second world: " before it, or as it is
  AlertScores scores;
};

/// Scenes of one world, called `name`.
struct AlertWorld {
  std::string name;
  std::vector<AlertRow> scenes;  // one row of each (AddUpAlerts)
  std::string over_all;          // name of the row over all of them
};

/// One row of each scene: runs of one are added. Order: as they come first.
std::vector<AlertRow> AddUpAlerts(const std::vector<AlertRow>& runs);

/// Targets first, then the scenes, and behind the scenes of a world one row over all of them. Without a world the tables are there without rows.
std::vector<NamedTable> AlertTablesOf(const std::vector<AlertWorld>& worlds);

/// Header and a row of a list of events, as CSV.
std::string AlertEventHeader();
std::string AlertEventRow(const std::string& scene, std::uint64_t seed, const AlertEvent& event);

}  // namespace lookout::eval
