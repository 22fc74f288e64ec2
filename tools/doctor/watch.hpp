// Listens for some seconds: on the bus, and where a process is not heard there, on the sources of its config themselves, with the process's own code.
#pragma once

#include <chrono>

#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

/// Fills lidar, navigation, processes, obstacles, the rate of the disk, end and watched_s of `seen`. Sends nothing on the bus.
///
/// @param seen  config and bus are read already
void Watch(Observations& seen, std::chrono::milliseconds duration);

}  // namespace lookout::doctor
