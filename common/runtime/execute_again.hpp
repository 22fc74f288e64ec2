// Starts this program anew in its own place: same process id, same command line, nothing of the old state.
#pragma once

namespace lookout::runtime {

/// Replaces the process by a fresh start of its own program. Every descriptor but 0, 1 and 2 is closed, as far as the kernel can. Signals that wait
/// stay waiting: they reach the new start, as they are blocked here and are blocked there.
///
/// @param argv  of main
/// @throws std::runtime_error when the program cannot be started; nothing has changed then
[[noreturn]] void ExecuteAgain(char** argv);

}  // namespace lookout::runtime
