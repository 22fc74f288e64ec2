// The boat's own map as GeoJSON.
#pragma once

#include <string>

#include "tools/export/own_map.hpp"

namespace lookout::exporter {

/// No program needs to read a larger file.
inline constexpr std::size_t kMaxMapBytes = 32UL * 1024 * 1024;

/// A FeatureCollection with "lookout_map": 1. A thing is a Polygon (LineString, Point where it has no area), land a MultiPoint: middles of cells
/// of earth_grid. README.md has the properties.
///
/// @param map  within the bounds of own_map.hpp
std::string MapText(const OwnMap& map);

}  // namespace lookout::exporter
