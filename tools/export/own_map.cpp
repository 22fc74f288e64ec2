#include "tools/export/own_map.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::exporter {

void AddDay(std::int32_t day, std::vector<std::int32_t>& days) {
  const auto place = std::ranges::lower_bound(days, day);
  if (place == days.end() || *place != day) days.insert(place, day);
  if (days.size() > kMostMapDays) days.erase(days.begin());
}

void AddScans(DayScans scans, std::vector<DayScans>& days) {
  const auto place = std::ranges::lower_bound(days, scans.day, {}, &DayScans::day);
  if (place != days.end() && place->day == scans.day) {
    place->num_scans = static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{place->num_scans} + scans.num_scans, kMostDayScans));
  } else {
    days.insert(place, scans);
  }
  if (days.size() > kMostMapDays) days.erase(days.begin());
}

namespace earth_grid {

namespace {

constexpr std::int32_t kCellsPerDeg = 220'800;
constexpr std::int32_t kRows = 180 * kCellsPerDeg;  // of cells
static_assert(kRows % kTileCells == 0);

// Cells to a degree of longitude in a row of tiles. A degree of longitude at the equator is 0.7 % longer than one of latitude: cells are wider by it.
std::int32_t CellsPerDegOf(std::int32_t tile_north) {
  const double middle_deg = (tile_north + 0.5) * kTileCells / kCellsPerDeg - 90.0;
  return std::max(1, static_cast<std::int32_t>(std::floor(kCellsPerDeg * Cos(DegToRad(middle_deg)))));
}

}  // namespace

Cell CellAt(double latitude_deg, double longitude_deg) {
  const auto row = std::clamp(static_cast<std::int32_t>(std::floor((latitude_deg + 90.0) * kCellsPerDeg)), 0, kRows - 1);
  const std::int32_t north = row / kTileCells;
  const std::int32_t per_deg = CellsPerDegOf(north);
  // 180 degrees east is 180 degrees west.
  const auto column = static_cast<std::int32_t>(std::floor((longitude_deg + 180.0) * per_deg)) % (360 * per_deg);
  return {{column / kTileCells, north}, static_cast<std::int16_t>(row % kTileCells * kTileCells + column % kTileCells)};
}

GeodeticPlace MiddleOf(const Cell& cell) {
  const std::int32_t row = cell.tile.north * kTileCells + cell.index / kTileCells;
  const std::int32_t column = cell.tile.east * kTileCells + cell.index % kTileCells;
  return {(row + 0.5) / kCellsPerDeg - 90.0, (column + 0.5) / CellsPerDegOf(cell.tile.north) - 180.0, 0.0};
}

}  // namespace earth_grid

double SamePlaceM(double deviation_m, double other_deviation_m) {
  constexpr double kSeenOtherwiseM = 1.0;
  constexpr double kDeviations = 2.0;
  constexpr double kMostM = 5.0;
  return std::min(kMostM, kSeenOtherwiseM + kDeviations * Hypot(deviation_m, other_deviation_m));
}

bool AreOfOneThing(double length_m, double other_length_m) {
  constexpr double kMostRatio = 2.0;
  constexpr double kBesideM = 1.0;
  return length_m <= kMostRatio * other_length_m + kBesideM && other_length_m <= kMostRatio * length_m + kBesideM;
}

}  // namespace lookout::exporter
