// One turn seen from above, as an SVG picture: its returns with their segments, or its obstacles.
#pragma once

#include <memory>
#include <optional>

#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// @param turn  seq of the turn; nullopt = the last whole one
std::unique_ptr<Sink> MakeReturnsSvgSink(std::optional<std::int64_t> turn);
std::unique_ptr<Sink> MakeObstaclesSvgSink(std::optional<std::int64_t> turn);

}  // namespace lookout::exporter
