// An lcm-log that a test writes.
#pragma once

#include <filesystem>
#include <fstream>

#include "common/bus/log_file.hpp"

namespace lookout::support {

/// Replaces a file that exists. What was written is in the file when this is gone.
class FileLog {
 public:
  explicit FileLog(const std::filesystem::path& file) : out_(file, std::ios::binary) {}
  ~FileLog() { writer_.Flush(); }
  FileLog(const FileLog&) = delete;
  FileLog& operator=(const FileLog&) = delete;

  void Write(Utime time, std::string_view channel, Bytes bytes) { writer_.Write(time, channel, bytes); }

 private:
  std::ofstream out_;
  bus::LogWriter writer_{
      [this](Bytes bytes) { out_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())); }};
};

}  // namespace lookout::support
