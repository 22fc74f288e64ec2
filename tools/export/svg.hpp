// SVG pictures of 1320 x 1000 pixels: the same text for the same log.
#pragma once

#include <memory>
#include <optional>

#include "tools/export/scans.hpp"

namespace lookout::exporter {

/// One scan from above: its returns with their segments, or its obstacles.
///
/// @param seq  of the scan; nullopt = the last whole one
std::unique_ptr<Sink> MakeScanSvgSink(ChosenScan::Of what, std::optional<std::int64_t> seq);

/// The track of the boat out of POSE: north up, one line for each stretch of one status. Places closer than 0.2 m to the last one are left out, so
/// that a day at anchor stays small. Poses without position break the line.
std::unique_ptr<Sink> MakeTrackSvgSink();

}  // namespace lookout::exporter
