// The labelled cloud of one turn as a PLY file (binary, little-endian), for MeshLab, CloudCompare or Open3D.
#pragma once

#include <memory>
#include <optional>

#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// @param turn  seq of the turn; nullopt = the last whole one
std::unique_ptr<Sink> MakePlySink(std::optional<std::int64_t> turn);

}  // namespace lookout::exporter
