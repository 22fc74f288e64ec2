// Files that belong to one run, and what a run is called.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/archive/file_stamp.hpp"
#include "tools/archive/recording.hpp"

namespace lookout::archive {

struct ScannedFile {
  std::filesystem::path path;
  FileStamp stamp;
  Recording recording;
};

/// Indices of files, in the order in which they are read.
using RunFiles = std::vector<std::size_t>;

/// The runs among the files that are used: logs of one folder where one goes on with the numbers of another (a recorder's rotated ones) are one run,
/// each other recording is one by itself.
///
/// @return in the order of the paths of their first files
std::vector<RunFiles> JoinRuns(const std::vector<ScannedFile>& files);

/// The scene of a run, by the name of its first file: "rain" of rain-11.lcmlog; of a name that begins with a digit (a recorder's) the name of its
/// folder.
std::string SceneOf(const std::filesystem::path& file);

}  // namespace lookout::archive
