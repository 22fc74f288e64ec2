// The labelled cloud of one scan as a PLY file (binary, little-endian), for MeshLab, CloudCompare or Open3D.
#pragma once

#include <memory>
#include <optional>

#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// @param seq  of the scan; nullopt = the last whole one
std::unique_ptr<Sink> MakePlySink(std::optional<std::int64_t> seq);

}  // namespace lookout::exporter
