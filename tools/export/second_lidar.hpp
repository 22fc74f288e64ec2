// The outputs of one lidar made of the second's channels: LIDAR_SCAN_2 in the place of LIDAR_SCAN, and so on.
#pragma once

#include <memory>

#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// The same output of the second lidar. Its mounting (`lidar_2` of boat.txtpb in RUN_INFO) takes the place of the first's. TRACKS do not reach it:
/// they name the segments of the first.
std::unique_ptr<Sink> OfSecondLidar(std::unique_ptr<Sink> sink);

}  // namespace lookout::exporter
