// The inputs of the tracker in a run, kept in a file: judging it again then costs no rays and none of the services before the tracker.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "common/io/output_file.hpp"
#include "lab/eval/truth.hpp"

namespace lookout::eval {

/// By the first shot of each scan: returns by object.
using ReturnsOfScans = std::map<std::int64_t, std::map<int, int>>;

/// Digest of all that a run of a simulated scene hangs on but the programs: the boat's config without tracker.txtpb, the scene, seed and length.
std::string FingerprintOfRun(const std::filesystem::path& config_folder, const std::filesystem::path& scene_file, std::uint64_t seed, double seconds);

/// Writes a file of a run: it is there when Commit has been called.
class KeptRunWriter {
 public:
  /// A file that is there is replaced. @throws std::runtime_error as io::OutputFile
  KeptRunWriter(const std::filesystem::path& file, const std::string& fingerprint);

  /// Channels that the tracker does not read are left out.
  void AddMessage(Utime time, std::string_view channel, Bytes bytes);
  void AddReturns(std::int64_t scan_utime_us, const std::map<int, int>& num_returns) { returns_[scan_utime_us] = num_returns; }
  void Commit();

 private:
  void WriteNumber(std::int64_t value);

  io::OutputFile file_;
  std::int64_t num_bytes_ = 0;
  ReturnsOfScans returns_;
};

/// Reads it. Message by message, in the order in which they came.
class KeptRun {
 public:
  using MessageHandler = std::function<void(Utime time, std::string_view channel, Bytes bytes)>;

  /// @return whether the file is there and of this fingerprint
  static bool IsThere(const std::filesystem::path& file, const std::string& fingerprint);

  /// @throws std::runtime_error "file: reason"
  explicit KeptRun(const std::filesystem::path& file);

  const ReturnsOfScans& returns() const { return returns_; }
  /// @throws std::runtime_error "file: reason"
  void Send(const MessageHandler& on_message) const;

 private:
  std::filesystem::path file_;
  ReturnsOfScans returns_;
  std::int64_t messages_end_ = 0;  // bytes
};

}  // namespace lookout::eval
