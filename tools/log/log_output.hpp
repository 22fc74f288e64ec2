// An lcm-log that appears whole or not at all.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/bus/log_file.hpp"

namespace lookout::log {

class LogOutput {
 public:
  /// The log is written beside its place, as FILE.partial, and moved there by Commit; an older one is replaced.
  ///
  /// @param inputs  none of them may be the output
  /// @throws std::runtime_error when it is an input, or cannot be made
  LogOutput(std::filesystem::path file, const std::vector<std::filesystem::path>& inputs);

  /// Takes away what was not committed.
  ~LogOutput();
  LogOutput(const LogOutput&) = delete;
  LogOutput& operator=(const LogOutput&) = delete;

  /// Events are numbered from 0, without a gap. @throws std::runtime_error when the disk does not take it
  void Write(const bus::LogEvent& event) { Write(event.time, event); }
  void Write(Utime time, const bus::LogEvent& event);

  /// @throws std::runtime_error when it cannot be put in its place
  void Commit();

  std::int64_t num_events() const { return num_events_; }

 private:
  std::filesystem::path file_;
  std::filesystem::path partial_;
  std::optional<bus::LogWriter> writer_;
  std::int64_t num_events_ = 0;
};

}  // namespace lookout::log
