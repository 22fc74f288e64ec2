// ais.txtpb, boat.txtpb and the field of view of segmenter.txtpb as checked parameters.
#pragma once

#include <chrono>
#include <filesystem>

#include "services/ais/core/watcher.hpp"

namespace lookout::ais {

struct Params {
  WatcherParams watcher;
  std::chrono::microseconds wait_timeout{0};  // live
};

/// @param config_folder  the boat's folder
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::ais
