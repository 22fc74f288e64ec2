// From when to when logs go, without reading all of them.
#pragma once

#include <filesystem>
#include <vector>

#include "common/core/log_time.hpp"

namespace lookout::log {

/// @param files  lcm-logs that are read in this order as one
/// @return the time of the first event of the first that holds one, and the latest of the last events of each
/// @throws std::runtime_error when one cannot be opened, or none holds an event; io::Stopped
LogSpan SpanOf(const std::vector<std::filesystem::path>& files);

}  // namespace lookout::log
