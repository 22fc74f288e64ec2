// The boat's own map: things that stand, and land, over many days.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "common/core/geodesy.hpp"
#include "common/core/utime.hpp"

namespace lookout::exporter {

/// Bounds of a map: things and cells beyond are left out.
inline constexpr std::size_t kMostMapThings = 4000;
inline constexpr std::size_t kMostMapTiles = 40'000;
inline constexpr std::size_t kMostMapCells = 400'000;
inline constexpr std::size_t kMostMapDays = 100;  // most days of a thing or a tile: the newest are kept
inline constexpr std::int32_t kMostDayScans = 10'000'000;

/// A thing that was seen on this many days counts as known.
inline constexpr int kKnownDays = 3;

/// Days since 1970-01-01 UTC.
constexpr std::int32_t DayOf(Utime time) { return static_cast<std::int32_t>(std::chrono::floor<std::chrono::days>(time).time_since_epoch().count()); }

/// In how many scans of a day a thing was seen.
struct DayScans {
  std::int32_t day = 0;
  std::int32_t num_scans = 0;

  friend bool operator==(const DayScans&, const DayScans&) = default;
};

struct MapThing {
  std::int32_t kind = 0;  // as in track_t
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double deviation_m = 0.0;  // of the place, along its worst direction, with the error of the own position
  double length_m = 0.0;
  double width_m = 0.0;
  double length_bearing_rad = 0.0;
  double top_above_water_m = 0.0;
  Utime first;
  Utime seen;
  std::optional<Utime> gone;               // the thing's place was found empty, and the thing was not seen since
  std::vector<DayScans> days;              // rising
  std::vector<Eigen::Vector2d> outline_m;  // from the thing's centre, along the axes of the map frame in which it was measured; at least one corner
};

/// A square of 32 x 32 cells.
struct MapTile {
  std::int32_t east = 0;
  std::int32_t north = 0;

  friend bool operator==(const MapTile&, const MapTile&) = default;
  friend bool operator<(const MapTile& one, const MapTile& other) { return std::tie(one.east, one.north) < std::tie(other.east, other.north); }
};
inline constexpr std::int32_t kTileCells = 32;
inline constexpr std::int32_t kCellsOfTile = kTileCells * kTileCells;

struct MapLand {
  MapTile tile;
  Utime seen;
  std::vector<std::int32_t> days;   // rising
  std::vector<std::int16_t> cells;  // kTileCells x north + east, rising
};

struct OwnMap {
  std::vector<MapThing> things;
  std::vector<MapLand> land;
};

/// Adds a day to rising days, and forgets the oldest beyond kMostMapDays.
void AddDay(std::int32_t day, std::vector<std::int32_t>& days);
/// AddDay with a number of scans, which are added to the scans of that day.
void AddScans(DayScans scans, std::vector<DayScans>& days);

/// The grid of the land that many days share: cells of 0.50 to 0.51 m, 220 800 to a degree of latitude from the south pole up. Each row of tiles has
/// as many cells to a degree of longitude, from 180 degrees west on, as leave a cell as wide as it is high in the middle of the row, rounded down. So
/// cells of 0.5 m of another grid leave no gap in this one, and now and then two of them lie in one.
namespace earth_grid {

struct Cell {
  MapTile tile;
  std::int16_t index = 0;  // in the tile

  friend bool operator==(const Cell&, const Cell&) = default;
  friend bool operator<(const Cell& one, const Cell& other) { return std::tie(one.tile, one.index) < std::tie(other.tile, other.index); }
};

/// @param latitude_deg  -90 to 90
/// @param longitude_deg  -180 to 180
Cell CellAt(double latitude_deg, double longitude_deg);
/// The middle of a cell, on the ellipsoid.
GeodeticPlace MiddleOf(const Cell& cell);

}  // namespace earth_grid

/// Distance within which two places of a standing thing are the same place: by both deviations, and by the changes of its visible part; at most 5 m.
double SamePlaceM(double deviation_m, double other_deviation_m);
/// Whether two lengths may be of one thing that is seen from other sides.
bool AreOfOneThing(double length_m, double other_length_m);

}  // namespace lookout::exporter
