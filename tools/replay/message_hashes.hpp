// A hash of each computed message: to find where two replays differ first without keeping their logs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "common/core/bytes.hpp"
#include "common/io/output_file.hpp"

namespace lookout::replay {

class MessageHashes {
 public:
  /// @throws std::runtime_error as io::OutputFile: the file cannot be written, exists without `force`, or is one of the inputs
  MessageHashes(const std::filesystem::path& file, io::OutputOptions options);

  /// A message of any channel; raw ones and those that replay does not make are left out. The columns are channel, number (from 0 in its channel),
  /// utime_us (of the message) and xxh3 (XXH3 with 64 bits over the payload, hexadecimal).
  void Add(std::string_view channel, Bytes bytes);

  /// @throws as io::OutputFile::Commit
  void Commit();

 private:
  io::OutputFile file_;
  std::map<std::string, std::int64_t, std::less<>> num_of_;  // messages so far, by channel
  std::string line_;
};

}  // namespace lookout::replay
