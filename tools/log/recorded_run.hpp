// What RUN_INFO of a log says of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/bus/log_file.hpp"
#include "common/core/printable.hpp"
#include "lookout/run_info_t.hpp"

namespace lookout::log {

/// RUN_INFO of an event, where it is one that this version can read.
std::optional<run_info_t> RunInfoOf(const bus::LogEvent& event);

/// The computer in one line: the values of "machine.txt" of its RUN_INFO, comma by comma. Empty when it has none.
std::string MachineOf(const run_info_t& run_info);

/// Texts of a log come from outside.
using lookout::Printable;

}  // namespace lookout::log
