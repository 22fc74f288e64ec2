// The files that the house rules look into.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

namespace lookout::structure_test {

/// All .cpp and .hpp, in the order of their paths; empty where there is no such folder.
inline std::vector<std::filesystem::path> SourcesBelow(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::exists(folder)) return files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const auto ending = entry.path().extension();
    if (entry.is_regular_file() && (ending == ".cpp" || ending == ".hpp")) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace lookout::structure_test
