// lookout-archive plan: the units of a version, and which of them have a result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "tools/archive/archive_folder.hpp"

namespace lookout::archive {

struct PlanRequest {
  std::vector<std::filesystem::path> configs;  // a version each
  std::vector<std::string> names;              // of the versions; empty: as the folders are called
  std::filesystem::path programs;              // folder of the programs that do the work
  std::vector<std::string> tables;             // that a unit exports
  std::vector<std::string> scenes;             // empty: all
  double cut_minutes = 30;                     // a run is cut where that is exact and the part has so many; 0: never
  bool verifies = false;                       // reads every result again
};

/// Checks each config by the programs' own lookout-replay, keeps a copy of it, and writes the units of each version in place of those of its last
/// plan.
/// @throws config::ConfigError for a config that is wrong, before anything is changed; std::runtime_error; io::Stopped
void MakePlan(const ArchiveFolder& archive, const PlanRequest& request, std::ostream& out);

struct Part {
  std::optional<std::int64_t> from_us;
  std::optional<std::int64_t> to_us;
};

/// The parts of a run that begins at `start_us`: it is cut where the part before has so many minutes.
std::vector<Part> PartsOf(std::int64_t start_us, const std::vector<std::int64_t>& cuts_us, double cut_minutes);

}  // namespace lookout::archive
