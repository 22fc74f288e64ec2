// The sidecar of a result: what it was made of, how it ended, and the digest of each of its files. A result is there when its sidecar holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/archive/archive_folder.hpp"
#include "tools/archive/unit.hpp"

namespace lookout::archive {

struct Sidecar {
  struct OutputFile {
    std::int64_t size_bytes = 0;
    std::string digest;  // SHA-256, hexadecimal
  };

  Recipe recipe;
  bool is_done = false;                     // else the unit failed, as the same input always will
  std::string reason;                       // why the unit failed
  std::vector<std::string> remarks;         // missing outputs, and why: "tracks: no TRACKS"
  std::map<std::string, OutputFile> files;  // by name
};

/// JSON with a digest over itself.
std::string SidecarText(const Sidecar& sidecar);

/// @throws std::runtime_error where the text is torn, was changed, or is of another format
Sidecar SidecarOfText(const std::string& text);

/// Whether a result can be used.
struct Validity {
  bool is_valid = false;
  bool is_done = false;  // of a valid one
  std::string reason;    // why a valid result failed, or why the result is not valid; empty: there is no sidecar
  std::string stamp;     // of a valid result: changes with each of its files
};

/// Reads the sidecar and all files of the result, and compares.
Validity Verify(const ArchiveFolder& archive, const std::string& key);

/// @return what Verify would give as `stamp` if nothing has changed, by the status of the files named in the sidecar alone; empty: a file is not
///         there
std::string StampOfResult(const ArchiveFolder& archive, const std::string& key, const std::string& verified_stamp);

/// Removes whatever stands in the place of the result of a key.
void RemoveResult(const ArchiveFolder& archive, const std::string& key);

}  // namespace lookout::archive
