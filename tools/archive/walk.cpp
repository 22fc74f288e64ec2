#include "tools/archive/walk.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/core/printable.hpp"
#include "common/io/stop_signal.hpp"

namespace lookout::archive {

namespace {

namespace fs = std::filesystem;
using Identity = std::pair<dev_t, ino_t>;

std::optional<struct stat> StatusOf(const fs::path& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return std::nullopt;
  return found;
}

bool IsTruth(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "truth.lcmlog", error) || (fs::exists(folder / "objects.csv", error) && fs::exists(folder / "returns.csv", error));
}

class Walker {
 public:
  Walker(Walk& walk, const fs::path& left_out) : walk_(walk) {
    if (const auto status = StatusOf(left_out)) seen_.insert({status->st_dev, status->st_ino});
  }

  void Enter(const fs::path& folder) {
    const auto status = StatusOrFault(folder);
    if (!status || !seen_.insert({status->st_dev, status->st_ino}).second) return;
    if (IsTruth(folder)) return;
    std::error_code error;
    std::vector<fs::path> paths;
    fs::directory_iterator entry(folder, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) paths.push_back(entry->path());
    if (error) walk_.faults.emplace_back(folder, error.message());
    std::ranges::sort(paths);
    for (const auto& path : paths) {
      io::ThrowIfStopAsked();
      Take(path);
    }
  }

 private:
  // A link to nothing or in a circle, or a path that is gone meanwhile, is skipped. Any other path whose status cannot be read is a fault.
  std::optional<struct stat> StatusOrFault(const fs::path& path) {
    const auto status = StatusOf(path);
    if (!status && errno != ENOENT && errno != ELOOP) walk_.faults.emplace_back(path, std::system_category().message(errno));
    return status;
  }

  void Take(const fs::path& path) {
    const auto status = StatusOrFault(path);
    if (!status) return;
    if (S_ISDIR(status->st_mode)) return Enter(path);
    if (!S_ISREG(status->st_mode) || !seen_.insert({status->st_dev, status->st_ino}).second) return;
    if (const auto stamp = StampOf(path)) walk_.files.push_back({path, *stamp});
  }

  Walk& walk_;
  std::set<Identity> seen_;
};

}  // namespace

Walk FilesBelow(const std::vector<fs::path>& folders, const fs::path& left_out) {
  Walk walk;
  Walker walker(walk, left_out);
  for (const auto& folder : folders) {
    std::error_code error;
    const auto whole = fs::canonical(folder, error);
    if (error || !fs::is_directory(whole)) throw std::runtime_error(PrintableLines(folder.string()) + ": is no folder");
    walker.Enter(whole);
  }
  std::ranges::sort(walk.files, {}, [](const FoundFile& file) { return file.path.native(); });
  return walk;
}

fs::path TruthOf(const fs::path& file, bool is_only_one) {
  auto own = file.parent_path() / (file.stem().native() + ".truth");
  if (IsTruth(own)) return own;
  const auto shared = file.parent_path() / "truth";
  return is_only_one && IsTruth(shared) ? shared : fs::path();
}

std::vector<fs::path> FilesOfTruth(const fs::path& folder) {
  return {folder / "objects.csv", folder / "outlines.csv", folder / "pose.csv", folder / "returns.csv"};
}

std::string DigestOfTruth(const fs::path& folder, const std::function<std::string(const fs::path&)>& digest_of) {
  std::string lines;
  for (const auto& file : FilesOfTruth(folder)) {
    if (StampOf(file)) lines += file.filename().string() + " " + digest_of(file) + "\n";
  }
  return DigestOfText(lines);
}

}  // namespace lookout::archive
