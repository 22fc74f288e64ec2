#include "tools/archive/file_stamp.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "common/bus/schema.hpp"
#include "common/core/printable.hpp"
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

std::vector<std::filesystem::path> FilesOfConfig(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  constexpr int kMostDepth = 8;
  constexpr std::size_t kMostFiles = 10'000;
  constexpr std::uintmax_t kMostBytes = 1'000'000'000;
  const auto refuse = [&folder](const std::string& why) { throw std::runtime_error(PrintableLines(folder.string()) + ": " + why); };
  std::vector<fs::path> files;
  std::uintmax_t num_bytes = 0;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::follow_directory_symlink, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    io::ThrowIfStopAsked();
    std::error_code gone;  // a link to nothing
    if (entry->is_directory(gone)) {
      if (entry->path().filename().native().starts_with('.')) entry.disable_recursion_pending();
      if (entry.depth() == kMostDepth) refuse("its folders are more than 8 deep, or lead in a circle");
    } else if (entry->is_regular_file(gone)) {
      files.push_back(entry->path().lexically_relative(folder));
      num_bytes += entry->file_size(gone);
      if (files.size() > kMostFiles || num_bytes > kMostBytes) refuse("holds more than a config and its files: 10 000 files or 1 GB");
    }
  }
  if (error) refuse("cannot be read: " + error.message());
  std::ranges::sort(files, {}, [](const fs::path& file) { return file.native(); });
  return files;
}

std::string DigestOfConfig(const std::filesystem::path& folder) {
  std::string lines;
  for (const auto& file : FilesOfConfig(folder)) {
    const auto& name = file.native();
    lines += std::to_string(name.size()) + " " + name + " " + DigestOfFile(folder / file) + "\n";
  }
  return DigestOfText(lines);
}

}  // namespace lookout::archive
