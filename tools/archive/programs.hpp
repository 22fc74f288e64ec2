// The programs that do the work of a unit.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lookout::archive {

struct Programs {
  std::filesystem::path folder;
  std::string digest;   // over all of them: the same where a unit gives the same bytes
  std::string version;  // as lookout-replay tells it
  bool has_eval = false;
};

/// The folder of this program.
std::filesystem::path OwnProgramFolder();

/// Reads the programs. @throws std::runtime_error where one that is needed is missing
Programs ProgramsIn(const std::filesystem::path& folder);

/// Over the programs of a folder that are there. @throws std::runtime_error as DigestOfFile
std::string DigestOfPrograms(const std::filesystem::path& folder);

/// A table that units may be asked for, and the channel that it is of.
struct UnitTable {
  const char* name;
  const char* channel;
};
const std::vector<UnitTable>& UnitTables();

}  // namespace lookout::archive
