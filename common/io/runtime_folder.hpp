// The folder in which one process leaves something to the next.
#pragma once

#include <filesystem>

namespace lookout::io {

/// $RUNTIME_DIRECTORY, which the supervisor (systemd, lookout-up) keeps from one start of a process to the next; empty: there is none.
std::filesystem::path RuntimeFolder();

}  // namespace lookout::io
