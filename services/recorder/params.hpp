// Config of the recorder process (recorder.txtpb) as checked values.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

namespace lookout::recorder {

struct Params {
  std::filesystem::path log_folder;  // absolute, or relative to the working folder
  std::int64_t max_file_bytes = 2'000'000'000;
  std::chrono::seconds max_file_time{3600};
  std::int64_t reserve_bytes = 1'000'000'000;
  std::int64_t queue_bytes = 64'000'000;
};

/// @param config_folder  the boat's folder, holding recorder.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::recorder
