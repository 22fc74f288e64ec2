// Maps out of a log, in the formats of map_formats.hpp.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "tools/export/features.hpp"
#include "tools/export/selection.hpp"
#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// Which scans of a log are on a map.
struct Scans {
  bool is_one = false;                             // else all
  std::optional<std::int64_t> seq = std::nullopt;  // number of the one scan, the first that has it; nullopt = the last whole scan
};

/// OBSTACLES, message by message: needs as much memory for a day as for a scan. Each obstacle that has a place gives a point (`obstacle`), its
/// outline (`outline`; of land `waterline`, an open line) and the ellipse of its place (`ellipse`, 95 %).
///
/// @param near  obstacles outside are left out; Finish throws std::runtime_error when none is left
std::unique_ptr<Sink> MakeObstacleMapSink(std::unique_ptr<MapWriter> writer, const std::optional<Circle>& near, const Scans& scans);

/// The track of the boat out of POSE (`own_track`: a line for each stretch of one status, a place each 0.5 m or 10 s); with tracks also the tracker's
/// results: each confirmed track where it was last (`track`, `outline`, `ellipse`), the way of moving tracks (`way`), remembered land (`waterline`),
/// and the places of the boat where alerts came up (`alert`). For one scan: the tracks after that scan, and the boat's place (`own_place`) instead of
/// its track.
///
/// @param scans  all without tracks
/// @param near   features outside are left out; Finish throws std::runtime_error when none is left
std::unique_ptr<Sink> MakeTrackMapSink(std::unique_ptr<MapWriter> writer, bool has_tracks, const std::optional<Circle>& near, const Scans& scans);

}  // namespace lookout::exporter
