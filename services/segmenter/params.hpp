// segmenter.txtpb and boat.txtpb as checked parameters.
#pragma once

#include <filesystem>

#include "services/segmenter/core/segmenter.hpp"

namespace lookout::segmenter {

/// @param config_folder  the boat's folder
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::segmenter
