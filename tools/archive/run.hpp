// lookout-archive run: what has no result yet, by an engine.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/archive/archive_folder.hpp"

namespace lookout::archive {

struct RunRequest {
  std::vector<std::string> versions;  // empty: all
  std::string engine = "local";       // local, a name of kEngineScripts, or a file with commands for bash
  int num_jobs = 1;                   // at a time
  std::int64_t limit = 0;             // units at most; 0: all
  std::string only;                   // condition in SQL over run and unit; empty: all
  int num_retries = 2;                // rounds for units that were killed or whose computer failed
  bool again_failed = false;          // failed units too
  std::int64_t batch_units = 0;       // units a batch; 0: as many as make 1000 batches
  std::filesystem::path own_program;  // lookout-archive, of which engines start "work"
  std::FILE* progress = nullptr;      // for people; nullptr: silent
};

/// How the units of a run ended.
struct RunSummary {
  std::int64_t num_units = 0;  // to do at its start
  std::int64_t num_done = 0;
  std::int64_t num_failed = 0;
  std::int64_t num_not_done = 0;
};

/// Waits while another run works on the archive. @param out  a line per failed or unfinished unit, and the summary
/// @throws std::invalid_argument for a version, engine or condition that is none; std::runtime_error; io::Stopped
RunSummary RunUnits(const ArchiveFolder& archive, const RunRequest& request, std::ostream& out);

/// The commands of an engine. @throws std::invalid_argument as RunUnits
std::string EngineText(const std::string& engine);

}  // namespace lookout::archive
