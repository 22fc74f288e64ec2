// The programs that do the work of a unit.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/archive/file_stamp.hpp"

namespace lookout::archive {

struct Programs {
  std::filesystem::path folder;
  std::string digest;   // over all programs: equal digests mean that a unit gives equal bytes
  std::string version;  // as lookout-replay states it
  bool has_eval = false;
};

/// The folder of this program; empty where /proc is not mounted.
std::filesystem::path OwnProgramFolder();

/// Reads the programs. @throws std::invalid_argument if the folder is empty, std::runtime_error where a program that is needed is missing
Programs ProgramsIn(const std::filesystem::path& folder);

/// Digest over the programs of a folder that exist. @throws std::runtime_error as DigestOfFile
std::string DigestOfPrograms(const std::filesystem::path& folder);

/// The files that DigestOfPrograms reads, whether or not they exist.
std::vector<std::filesystem::path> FilesOfPrograms(const std::filesystem::path& folder);

/// Digests of the programs of folders, which are read again only when a file of them changed.
class KnownPrograms {
 public:
  /// @throws std::runtime_error as DigestOfPrograms
  std::string DigestOf(const std::filesystem::path& folder);

 private:
  struct Known {
    std::vector<std::optional<FileStamp>> stamps;
    std::string digest;
  };
  std::map<std::filesystem::path, Known> known_;
};

/// A table that units may be asked for, and the channel that it is of.
struct UnitTable {
  const char* name;
  const char* channel;
};
const std::vector<UnitTable>& UnitTables();

}  // namespace lookout::archive
