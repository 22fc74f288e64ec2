// The index of an archive: files, runs, versions and units, in SQLite. Its tables are those that lookout-archive query shows (README.md).
#pragma once

#include <memory>
#include <string>

#include "tools/archive/archive_folder.hpp"
#include "tools/archive/database.hpp"

namespace lookout::archive {

/// Format of the tables, and of the sidecars and keys of results: results of another format are not used.
inline constexpr int kFormat = 1;

/// Makes folder and index where they are missing.
/// @throws std::runtime_error when they cannot be made or are of another version of Lookout
Database OpenIndex(const ArchiveFolder& archive);

/// @throws std::runtime_error also where there is no index: "... lookout-archive scan makes one"
Database ReadIndex(const ArchiveFolder& archive);

}  // namespace lookout::archive
