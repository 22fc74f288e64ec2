// An lcm-log that appears whole or not at all.
#pragma once

#include <filesystem>
#include <utility>

#include "common/bus/log_file.hpp"
#include "common/io/output_file.hpp"

namespace lookout::log {

class LogOutput {
 public:
  /// @throws std::runtime_error as io::OutputFile
  LogOutput(const std::filesystem::path& file, io::OutputOptions options)
      : file_(file, std::move(options)), writer_([this](Bytes bytes) { file_.Write(bytes); }) {}

  /// Events are numbered from 0, without a gap. @throws std::runtime_error when the disk does not take it
  void Write(Utime time, std::string_view channel, Bytes bytes) {
    writer_.Write(time, channel, bytes);
    ++num_events_;
  }

  /// The beginning of an event, or all of it, with the number that it has. @throws as Write
  void WriteNumbered(std::int64_t number, Utime time, std::string_view channel, Bytes bytes, std::size_t num_data_bytes) {
    writer_.WriteNumbered(number, time, channel, bytes, num_data_bytes);
    ++num_events_;
  }
  /// Goes on with it. @throws as Write
  void Append(Bytes bytes) { writer_.Append(bytes); }

  /// @throws std::runtime_error when it cannot be put in its place
  void Commit() {
    writer_.Flush();
    file_.Commit();
  }

  /// As of io::OutputFile; to be asked before Commit.
  bool IsStandardOutput() const { return file_.IsStandardOutput(); }

  std::int64_t num_events() const { return num_events_; }
  std::int64_t next_number() const { return writer_.next_number(); }

 private:
  io::OutputFile file_;
  bus::LogWriter writer_;
  std::int64_t num_events_ = 0;
};

}  // namespace lookout::log
