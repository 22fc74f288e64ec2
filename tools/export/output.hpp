// Where the result goes: standard output, or a file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace lookout::exporter {

/// Thrown when nobody reads standard output any more. No fault: `| head` ends quietly.
struct BrokenPipe {};

class Output {
 public:
  /// @param file  nullopt = standard output. A regular file is written beside its place, as FILE.partial, and moved there by Commit.
  /// @throws std::runtime_error when it cannot be made
  explicit Output(const std::optional<std::filesystem::path>& file);

  /// Takes away what was not committed.
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  /// @throws BrokenPipe; std::runtime_error when it cannot be written
  void Write(std::string_view bytes);

  /// @throws std::runtime_error when the file cannot be put in its place
  void Commit();

 private:
  std::optional<std::filesystem::path> file_;
  std::filesystem::path partial_;  // empty when written in place
  int descriptor_ = -1;
};

}  // namespace lookout::exporter
