// A lock between programs, on this computer or on several that share a file system.
#pragma once

#include <filesystem>
#include <functional>

namespace lookout::io {

/// Held from its making until its end, also where its program is killed. The file holds nothing.
class FileLock {
 public:
  enum class AtEnd { kStays, kIsRemoved };

  /// Waits until no other program holds it.
  ///
  /// @param on_wait  called once before it waits; may be empty
  /// @throws std::runtime_error when the file cannot be made or locked; Stopped when the program was asked to stop
  explicit FileLock(std::filesystem::path file, AtEnd at_end = AtEnd::kStays, const std::function<void()>& on_wait = {});
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::filesystem::path file_;
  AtEnd at_end_;
  int descriptor_ = -1;
};

}  // namespace lookout::io
