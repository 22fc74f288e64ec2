#include "common/io/disk_reserve.hpp"

#include <sys/stat.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <system_error>

namespace lookout::io {

namespace {

namespace fs = std::filesystem;

std::string Megabytes(std::int64_t size_bytes) { return std::to_string(size_bytes / 1'000'000) + " MB"; }

fs::path Existing(const fs::path& path) {
  std::error_code error;
  auto existing = fs::absolute(path, error);
  while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
  return existing;
}

}  // namespace

std::int64_t FreeBytes(const fs::path& path) {
  struct statvfs state {};
  if (::statvfs(Existing(path).c_str(), &state) != 0) return -1;
  return static_cast<std::int64_t>(state.f_bavail) * static_cast<std::int64_t>(state.f_frsize);
}

std::int64_t DiskBytes(const fs::path& path) {
  struct statvfs state {};
  if (::statvfs(Existing(path).c_str(), &state) != 0) return -1;
  return static_cast<std::int64_t>(state.f_blocks) * static_cast<std::int64_t>(state.f_frsize);
}

bool AreOnOneDisk(const fs::path& path, const fs::path& other) {
  struct stat one {};
  struct stat another {};
  return ::stat(Existing(path).c_str(), &one) == 0 && ::stat(Existing(other).c_str(), &another) == 0 && one.st_dev == another.st_dev;
}

std::string DiskReserve::Text(std::int64_t free_bytes) const {
  return Megabytes(free_bytes) + " are free, " + Megabytes(reserve_bytes_) + " of the disk are kept in reserve";
}

DiskReserve ReserveAt(const fs::path& folder, const std::optional<fs::path>& log_folder, std::int64_t reserve_bytes) {
  if (log_folder && AreOnOneDisk(folder, *log_folder)) return DiskReserve(reserve_bytes);
  constexpr std::int64_t kShareOfOtherDisk = 10;
  const auto disk_bytes = DiskBytes(folder);
  return DiskReserve(disk_bytes < 0 ? reserve_bytes : std::min(reserve_bytes, disk_bytes / kShareOfOtherDisk));
}

}  // namespace lookout::io
