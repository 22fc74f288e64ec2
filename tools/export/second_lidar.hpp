// The outputs of one lidar made of the second's channels: LIDAR_SCAN_2 in the place of LIDAR_SCAN, and so on.
#pragma once

#include <memory>

#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// Makes a sink of the first lidar one of the second. The second's mounting (`lidar_2` of boat.txtpb in RUN_INFO) replaces the first's. TRACKS do not
/// reach the sink: they name segments of the first lidar.
std::unique_ptr<Sink> OfSecondLidar(std::unique_ptr<Sink> sink);

}  // namespace lookout::exporter
