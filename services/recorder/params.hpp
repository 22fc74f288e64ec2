// Config of the recorder process (recorder.txtpb) as checked values.
#pragma once

#include <filesystem>

namespace lookout::recorder {

struct Params {
  std::filesystem::path log_folder;  // absolute, or relative to the working folder
};

/// @param config_folder  the boat's folder, holding recorder.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::recorder
