// Listens for some seconds: on the bus, and where a process is not heard there, on the sources of its config themselves, with the process's own code.
#pragma once

#include <chrono>

#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

/// Fills lidar, navigation, processes, obstacles, the rate of the disk, end and watched_s of `seen`. Sends nothing on the bus.
///
/// @param seen  config and bus are read already
void Watch(Observations& seen, std::chrono::milliseconds duration);

/// A port that could not be opened is no fault where the process that reads it has been heard after all, its first HEALTH late on a busy computer:
/// takes the faults of its ports from `seen`, which then speaks of the process.
void ForgivePortsOfProcesses(Observations& seen);

}  // namespace lookout::doctor
