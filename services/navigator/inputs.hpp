// The inputs of navigator.txtpb as checked values.
#pragma once

#include <filesystem>

#include "config/schema/navigator.pb.h"
#include "services/navigator/params.hpp"

namespace lookout::navigator {

/// Fills connections, source_of_port and navigator.sources of `params`.
///
/// @throws config::ConfigError with every fault
void TakeInputs(const std::filesystem::path& config_folder, const config::Navigator& message, Params& params);

}  // namespace lookout::navigator
