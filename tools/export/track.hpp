// The track of the boat out of POSE, as an SVG picture.
#pragma once

#include <memory>

#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// North up, 1320 x 1000 pixels, one line for each stretch of one status. Places closer than 0.2 m to the last one are left out, so that a day at
/// anchor stays small. Poses without position break the line.
std::unique_ptr<Sink> MakeTrackSvgSink();

}  // namespace lookout::exporter
