// What tells that a file has changed, without reading it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lookout::archive {

struct FileStamp {
  std::int64_t size_bytes = 0;
  std::int64_t modified_ns = 0;
  std::int64_t changed_ns = 0;  // of its bytes or its attributes: no program can set it
  std::int64_t inode = 0;

  bool operator==(const FileStamp&) const = default;
};

/// Symbolic links are followed. @return nullopt where there is no regular file
std::optional<FileStamp> StampOf(const std::filesystem::path& file);

/// SHA-256 of the bytes of a file, hexadecimal. @throws std::runtime_error when it cannot be read; io::Stopped
std::string DigestOfFile(const std::filesystem::path& file);

/// SHA-256 of a text.
std::string DigestOfText(const std::string& text);

/// The regular files below a folder of a config, relative to it and sorted; folders whose names begin with a dot are left out. Links are followed.
/// @throws std::runtime_error when a folder cannot be read, folders are more than 8 deep, or there are more than 10 000 files or 1 GB
std::vector<std::filesystem::path> FilesOfConfig(const std::filesystem::path& folder);

/// SHA-256 over names and bytes of FilesOfConfig. @throws std::runtime_error as FilesOfConfig and DigestOfFile; io::Stopped
std::string DigestOfConfig(const std::filesystem::path& folder);

}  // namespace lookout::archive
