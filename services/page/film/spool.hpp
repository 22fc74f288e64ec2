// A log for each minute of a live bus, in a folder of its own. Not for several threads at once.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "common/io/output_file.hpp"

namespace lookout::page {

/// A message that waits for the disk.
struct SpooledMessage {
  Utime time;
  std::string_view channel;  // of the channel table
  std::vector<std::uint8_t> bytes;
};

/// Files are never committed, so never synced: they go with the process (io::OutputFile).
class Spool {
 public:
  /// Makes the folder, and removes the files that a killed process left in it.
  /// @throws std::runtime_error when it cannot be made
  explicit Spool(std::filesystem::path folder);

  /// Appends to the file of the minute; begins the next when the minute is over or `max_file_bytes` are in it.
  /// @return whether all were written; else none of them counts, `fault` says why, and the next call begins a new file
  bool Write(const std::vector<SpooledMessage>& messages, std::int64_t max_file_bytes);

  /// The file that was written last; empty: none.
  std::filesystem::path file() const;
  std::int64_t num_bytes() const;
  std::size_t num_files() const { return files_.size(); }
  const std::string& fault() const { return fault_; }

  /// Precondition of these: there is one.
  const std::filesystem::path& oldest_file() const { return files_.front().partial; }
  void DropOldest();

  void Clear();

 private:
  struct File {
    std::filesystem::path partial;
    std::unique_ptr<io::OutputFile> out;
    Utime first;
    std::int64_t num_events = 0;
    std::int64_t num_bytes = 0;
  };

  void Begin(Utime time);

  std::filesystem::path folder_;
  std::int64_t num_files_begun_ = 0;
  std::deque<File> files_;
  bool is_open_ = false;  // the last may be written on
  std::string fault_;
};

}  // namespace lookout::page
