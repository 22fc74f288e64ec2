#include "tools/archive/file_stamp.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "common/bus/schema.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"

namespace lookout::archive {

namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;
std::int64_t Nanoseconds(const timespec& time) { return time.tv_sec * kNsPerS + time.tv_nsec; }

}  // namespace

std::optional<FileStamp> StampOf(const std::filesystem::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return std::nullopt;
  return FileStamp{found.st_size, Nanoseconds(found.st_mtim), Nanoseconds(found.st_ctim), static_cast<std::int64_t>(found.st_ino)};
}

std::string DigestOfFile(const std::filesystem::path& file) {
  constexpr std::size_t kPieceBytes = 1024UL * 1024;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read: " + io::ErrnoText());
  bus::Sha256 sha256;
  std::vector<char> piece(kPieceBytes);
  errno = 0;
  while (in) {
    io::ThrowIfStopAsked();
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    sha256.Add(piece.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (!in.eof()) throw std::runtime_error(file.string() + ": cannot be read: " + io::ErrnoText());
  return sha256.Finish();
}

std::string DigestOfText(const std::string& text) {
  bus::Sha256 sha256;
  sha256.Add(text.data(), text.size());
  return sha256.Finish();
}

std::string DigestOfFolder(const std::filesystem::path& folder) {
  auto files = io::FilesIn(folder);
  std::ranges::sort(files);
  std::string lines;
  for (const auto& file : files) {
    const auto name = file.filename().string();
    lines += std::to_string(name.size()) + " " + name + " " + DigestOfFile(file) + "\n";
  }
  return DigestOfText(lines);
}

}  // namespace lookout::archive
