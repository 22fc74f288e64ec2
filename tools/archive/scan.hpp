// lookout-archive scan: folders of recordings into the index.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iosfwd>
#include <vector>

#include "tools/archive/archive_folder.hpp"

namespace lookout::archive {

struct ScanRequest {
  std::vector<std::filesystem::path> folders;
  std::FILE* progress = nullptr;  // for people; nullptr: silent
};

/// Reads each file that is new or has changed since the last scan, and forgets those that are gone from the given folders. Files of other folders
/// stay. A scan that was ended goes on where it was: each file is in the index once it has been read.
///
/// @param out  what was found, and each file that is not used, with the reason
/// @throws std::runtime_error when a folder cannot be read, or the index not written; io::Stopped
void Scan(const ArchiveFolder& archive, const ScanRequest& request, std::ostream& out);

}  // namespace lookout::archive
