#include "common/config/boat_folder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "common/core/printable.hpp"

namespace lookout::config {

std::string BoatFolderFault(const std::string& folder) {
  namespace fs = std::filesystem;
  constexpr const char* kBoatFile = "boat.txtpb";
  std::error_code error;
  if (fs::exists(fs::path(folder) / kBoatFile, error)) return {};
  std::vector<std::string> boats;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code no_right;
    if (fs::exists(entry->path() / kBoatFile, no_right)) boats.push_back(entry->path().lexically_normal().string());
  }
  if (boats.empty()) return {};  // the reader of the config says which file is missing
  std::ranges::sort(boats);
  constexpr std::size_t kMost = 20;
  const bool is_cut = boats.size() > kMost;
  if (is_cut) boats.resize(kMost);
  return Printable(
      fmt::format("{} is no boat's folder (it has no boat.txtpb), but holds boats: {}{}", folder, fmt::join(boats, ", "), is_cut ? ", ..." : ""));
}

}  // namespace lookout::config
