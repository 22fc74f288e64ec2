// lookout-archive query: SQL over the index and the tables of the results.
#pragma once

#include <iosfwd>
#include <string>

#include "tools/archive/archive_folder.hpp"

namespace lookout::archive {

/// Runs one SELECT, and prints its rows as CSV with a header. Besides the tables of the index there is a table for each kind of exported table
/// (tracks, alerts, ...), and `channels` and `truth`: the rows of all done results, with the columns version, run, scene and part before their own.
///
/// @throws std::invalid_argument for SQL that is none or would write; std::runtime_error
void Query(const ArchiveFolder& archive, const std::string& sql, std::ostream& out);

}  // namespace lookout::archive
