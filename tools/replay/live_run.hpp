// The live run of the tracker, as the logs tell it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "services/tracker/core/script.hpp"

namespace lookout::replay {

/// Reads ALERTS, and of all else no more than the head. ALERTS of a second tracker, between two of the process that goes on, are left out.
///
/// @param show  is told how many bytes were read, of all logs; may be empty
/// @return at which scans its processes began and ended, and with which an acknowledgement was taken; nullopt where the logs hold no ALERTS
/// @throws std::runtime_error when a log cannot be read; io::Stopped
std::optional<tracker::Script> ReadScript(const std::vector<std::filesystem::path>& logs, const std::function<void(std::int64_t)>& show = {});

}  // namespace lookout::replay
