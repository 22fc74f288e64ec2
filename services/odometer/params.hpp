// odometer.txtpb and boat.txtpb as checked parameters.
#pragma once

#include <filesystem>

#include "services/odometer/core/odometer.hpp"

namespace lookout::odometer {

using Params = OdometerParams;

/// @param config_folder  the boat's folder
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::odometer
