// The boat's own map as a file: GeoJSON, which lookout-export writes and the tracker reads.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "services/tracker/core/own_map.hpp"

namespace lookout::tracker {

/// Why a file is no map of ours, with the feature and the property.
class MapFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline constexpr std::size_t kMaxMapBytes = 32UL * 1024 * 1024;

/// A FeatureCollection with "lookout_map": 1. A thing is a Polygon (LineString, Point where it has no area), land a MultiPoint: middles of cells
/// of earth_grid. README.md has the properties.
///
/// @param map  land on earth_grid; within the bounds of own_map.hpp
/// @return text that ParseMap reads to a map of the same text
std::string MapText(const OwnMap& map);

/// @return things with ids from 1 in the order of the file, none seen by this process; land on earth_grid
/// @throws MapFileError
OwnMap ParseMap(std::string_view text);

/// @throws MapFileError, with the path; also where it is no regular file, or greater than kMaxMapBytes
OwnMap ReadMapFile(const std::filesystem::path& file);

/// "2026-11-23T13:45:01Z", to the second, rounded down.
std::string MapTimeText(Utime time);
/// "2026-11-23"
std::string MapDayText(std::int32_t day);

}  // namespace lookout::tracker
