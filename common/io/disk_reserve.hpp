// The part of a disk that programs which write as they run leave free: reserve_bytes of recorder.txtpb.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace lookout::io {

/// Bytes that any user may still write where `path` is, or will be: the nearest folder above it that exists. -1 = not known.
std::int64_t FreeBytes(const std::filesystem::path& path);

/// Size of the file system where `path` is, or will be. -1 = not known.
std::int64_t DiskBytes(const std::filesystem::path& path);

/// Whether both are, or will be, on one file system.
bool AreOnOneDisk(const std::filesystem::path& path, const std::filesystem::path& other);

/// One rule for all programs that write on one disk. The recorder writes while no less than the reserve would be left; once it has stopped, it goes
/// on where some more is free, else each freed byte would make one more small file. All others (the spool of the page) are worth less than a log:
/// they leave as much as the recorder needs to go on, and give their files back when another program fills the disk.
class DiskReserve {
 public:
  explicit DiskReserve(std::int64_t reserve_bytes) : reserve_bytes_(reserve_bytes) {}

  std::int64_t bytes() const { return reserve_bytes_; }
  /// Free bytes that a stopped writer needs to go on.
  std::int64_t bytes_to_go_on() const { return reserve_bytes_ + reserve_bytes_ / kShareToGoOn + kMoreToGoOn; }

  /// How many bytes a program other than the recorder may hold in all.
  /// @param held_bytes  bytes that it holds now, and could give back
  std::int64_t BytesForOthers(std::int64_t free_bytes, std::int64_t held_bytes) const { return free_bytes + held_bytes - bytes_to_go_on(); }

  /// "12 MB are free, 1000 MB of the disk are kept in reserve"
  std::string Text(std::int64_t free_bytes) const;

 private:
  static constexpr std::int64_t kShareToGoOn = 10;
  static constexpr std::int64_t kMoreToGoOn = 2 * 1024 * 1024;  // some blocks of the recorder

  std::int64_t reserve_bytes_;
};

/// The reserve where `folder` is: the recorder's on the disk of its logs; on another disk at most a tenth of it, so that a small disk for the spool
/// alone can be used.
DiskReserve ReserveAt(const std::filesystem::path& folder, const std::optional<std::filesystem::path>& log_folder, std::int64_t reserve_bytes);

}  // namespace lookout::io
