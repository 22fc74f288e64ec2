#include "tools/archive/joining.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>

#include "tools/archive/path_text.hpp"

namespace lookout::archive {

namespace {

// Most messages, and longest time, that a recorder may lose between two files of one run.
constexpr std::int64_t kMostLost = 1000;
constexpr std::int64_t kLongestGapUs = 10'000'000;

bool GoesOn(const StreamEnds& before, const StreamEnds& after) {
  return !before.ends_with_end && !after.begins_with_start && after.first_seq > before.last_seq && after.first_seq - before.last_seq <= kMostLost;
}

bool IsNext(const Recording& before, const Recording& after) {
  if (before.kind != "lcm-log" || after.kind != "lcm-log" || !before.end_us || !after.start_us) return false;
  if (*after.start_us < *before.end_us - kLongestGapUs || *after.start_us > *before.end_us + kLongestGapUs) return false;
  bool is_any = false;
  for (const auto stream : {&Recording::lidar, &Recording::navigator}) {
    const auto& a = before.*stream;
    const auto& b = after.*stream;
    if (!a.is_there || !b.is_there) continue;
    if (!GoesOn(a, b)) return false;
    is_any = true;
  }
  return is_any;
}

}  // namespace

std::vector<RunFiles> JoinRuns(const std::vector<ScannedFile>& files) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].recording.IsUsed()) order.push_back(i);
  }
  // By folder and time: a run is a stretch of this order.
  std::ranges::sort(order, [&files](std::size_t a, std::size_t b) {
    const auto key = [&files](std::size_t i) {
      const auto& file = files[i];
      return std::tuple(file.path.parent_path().native(), file.recording.start_us.value_or(0), file.path.native());
    };
    return key(a) < key(b);
  });
  std::vector<RunFiles> runs;
  for (const auto i : order) {
    const bool joins = !runs.empty() && files[runs.back().back()].path.parent_path() == files[i].path.parent_path() &&
                       IsNext(files[runs.back().back()].recording, files[i].recording);
    if (joins) {
      runs.back().push_back(i);
    } else {
      runs.push_back({i});
    }
  }
  std::ranges::sort(runs, {}, [&files](const RunFiles& run) { return files[run.front()].path.native(); });
  return runs;
}

std::string SceneOf(const std::filesystem::path& file) {
  auto stem = file.stem().native();
  if (stem.empty() || std::isdigit(static_cast<unsigned char>(stem.front())) != 0) return PathText(file.parent_path().filename());
  const auto dash = stem.rfind('-');
  const bool is_numbered =
      dash != std::string::npos && dash > 0 && dash + 1 < stem.size() &&
      std::all_of(stem.begin() + static_cast<std::ptrdiff_t>(dash) + 1, stem.end(), [](unsigned char letter) { return std::isdigit(letter) != 0; });
  return PathText(is_numbered ? stem.substr(0, dash) : stem);
}

}  // namespace lookout::archive
