// What tells that a file has changed, without reading it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace lookout::archive {

struct FileStamp {
  std::int64_t size_bytes = 0;
  std::int64_t modified_ns = 0;
  std::int64_t changed_ns = 0;  // of its bytes or its attributes: no program can set it
  std::int64_t inode = 0;

  bool operator==(const FileStamp&) const = default;

  /// The same file as seen on another computer, or copied with its time.
  bool IsSameContent(const FileStamp& other) const { return size_bytes == other.size_bytes && modified_ns == other.modified_ns; }
};

/// Symbolic links are followed. @return nullopt where there is no regular file
std::optional<FileStamp> StampOf(const std::filesystem::path& file);

/// SHA-256 of the bytes of a file, hexadecimal. @throws std::runtime_error when it cannot be read; io::Stopped
std::string DigestOfFile(const std::filesystem::path& file);

/// SHA-256 of a text.
std::string DigestOfText(const std::string& text);

/// SHA-256 over names and bytes of the regular files of a folder, in the order of the names. @throws std::runtime_error as DigestOfFile
std::string DigestOfFolder(const std::filesystem::path& folder);

}  // namespace lookout::archive
