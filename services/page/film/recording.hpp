// One source: its logs and their contents. Not for several threads at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/log_file.hpp"
#include "services/page/core/recordings.hpp"
#include "services/page/film/log_part.hpp"
#include "services/page/film/timeline.hpp"

namespace lookout::page {

inline constexpr std::int64_t kMaxAnswerBytes = std::int64_t{16} * 1024 * 1024;  // of the messages of one answer

class Recording {
 public:
  /// Opens a log, which stands behind all that were added before.
  /// @return its number. @throws std::runtime_error when it cannot be opened, or there were 65 535
  std::uint16_t AddLog(const std::filesystem::path& log);

  /// Adds entries of a log. A log that begins before the end of the previous log is shown behind that log, and an event says by how much it was
  /// shifted.
  void Append(std::uint16_t log, const LogPart& part);

  /// Forgets entries before this time, and closes logs without entries, except the last log.
  void DropBefore(Utime time);

  /// Closes logs that were removed: else their bytes stay on the disk, and they were removed to make room. Their messages are left out of answers.
  void CloseRemoved();

  /// The time of the log's last entry, as it is shown; nullopt: the log was closed, or has no entry yet.
  std::optional<Utime> LastOf(std::uint16_t log) const;

  const Timeline& timeline() const { return timeline_; }

  Answer Find(const At& request);
  Answer Find(const Range& request);

  /// The bytes of the first RUN_INFO; empty: there is none, or it cannot be read.
  std::vector<std::uint8_t> RunInfo();

  /// Messages that were not found where the index says: a log was cut, or its index is forged.
  std::int64_t num_missing() const { return num_missing_; }

 private:
  struct Log {
    std::filesystem::path file;
    std::unique_ptr<bus::LogReader> reader;  // nullptr: the file was removed
    bool is_begun = false;
    std::chrono::microseconds shift{0};
    Utime last{std::chrono::microseconds(kMinUtimeUs)};
  };

  bool Read(ChannelIndex channel, const Place& place, std::vector<std::uint8_t>& bytes);

  std::map<std::uint16_t, Log> logs_;
  std::uint32_t num_logs_ = 0;  // all so far
  Timeline timeline_;
  std::int64_t num_missing_ = 0;
};

}  // namespace lookout::page
