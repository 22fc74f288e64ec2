#include "services/tracker/core/land.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lookout::tracker {

namespace {

// Evidence of one scan. Land after four scans; bounds let a change of mind in within seconds.
constexpr int kForLand = 3;
constexpr int kAgainst = 4;
constexpr int kPerhapsAgainst = 3;
constexpr int kLookedThrough = 8;
constexpr int kMost = 60;
constexpr int kIsLand = 12;
// Beams seldom pass through low land, but over it.
constexpr double kLeastTopM = 0.3;
constexpr double kBelowTopM = 0.2;

}  // namespace

LandMemory::Cell LandMemory::CellOf(const Eigen::Vector2d& place_m) {
  return {static_cast<std::int32_t>(std::floor(place_m.x() / kCellM)), static_cast<std::int32_t>(std::floor(place_m.y() / kCellM))};
}

void LandMemory::Change(Tile& tile, std::size_t index, int by) {
  auto& evidence = tile.evidence[index];
  const bool was_land = evidence >= kIsLand;
  evidence = static_cast<std::int8_t>(std::clamp(evidence + by, -kMost, kMost));
  tile.num_land += static_cast<int>(evidence >= kIsLand) - static_cast<int>(was_land);
  if (evidence <= 0) tile.top_dm[index] = 0;
}

void LandMemory::Add(std::span<const Eigen::Vector2d> places_m, std::span<const double> tops_m, Said said) {
  const bool is_land = said == Said::kLand;
  const int change = is_land ? kForLand : said == Said::kThing ? -kAgainst : -kPerhapsAgainst;
  std::vector<std::pair<Cell, std::uint8_t>> cells;
  cells.reserve(places_m.size());
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    const double top_dm = tops_m.empty() ? 0.0 : std::clamp(10.0 * tops_m[i], 1.0, 255.0);
    cells.emplace_back(CellOf(places_m[i]), static_cast<std::uint8_t>(top_dm));
  }
  std::ranges::sort(cells);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [cell, top_dm] = cells[i];
    if (i + 1 < cells.size() && cells[i + 1].first == cell) continue;  // the last of a cell is its highest
    const Cell tile_of{cell.first >> 5, cell.second >> 5};
    auto tile = tiles_.find(tile_of);
    if (tile == tiles_.end()) {
      if (!is_land) continue;
      tile = tiles_.emplace(tile_of, Tile{}).first;
    }
    const std::size_t index = IndexOf(cell);
    Change(tile->second, index, change);
    if (is_land) tile->second.top_dm[index] = std::max(tile->second.top_dm[index], top_dm);
  }
}

void LandMemory::LookThrough(const Sight& sight) {
  std::size_t num_looked = 0;
  auto next = tiles_.upper_bound(looked_);
  for (std::size_t i = 0; i < tiles_.size() && num_looked < kMostLooked; ++i, ++next) {
    if (next == tiles_.end()) next = tiles_.begin();
    auto& [number, tile] = *next;
    looked_ = number;
    const Eigen::Vector2d corner_m(number.first * kTileCells * kCellM, number.second * kTileCells * kCellM);
    if (tile.num_land == 0 || !sight.Reaches(corner_m, kTileCells * kCellM)) continue;
    for (int north = 0; north < kTileCells; ++north) {
      for (int east = 0; east < kTileCells; ++east) {
        const auto index = IndexOf(east, north);
        if (tile.evidence[index] < kIsLand) continue;
        const double top_m = 0.1 * tile.top_dm[index];
        if (top_m < kLeastTopM) continue;
        ++num_looked;
        const Cell cell{number.first * kTileCells + east, number.second * kTileCells + north};
        if (sight.IsFree(MiddleOf(cell), top_m - kBelowTopM)) Change(tile, index, -kLookedThrough);
      }
    }
  }
}

bool LandMemory::IsLandCell(Cell cell) const {
  const auto tile = tiles_.find({cell.first >> 5, cell.second >> 5});
  return tile != tiles_.end() && tile->second.evidence[IndexOf(cell)] >= kIsLand;
}

bool LandMemory::IsLand(const Eigen::Vector2d& place_m) const {
  const auto [east, north] = CellOf(place_m);
  for (std::int32_t dn = -1; dn <= 1; ++dn) {
    for (std::int32_t de = -1; de <= 1; ++de) {
      if (IsLandCell({east + de, north + dn})) return true;
    }
  }
  return false;
}

double LandMemory::Share(std::span<const Eigen::Vector2d> places_m, std::size_t most) const {
  if (places_m.empty() || tiles_.empty()) return 0.0;
  const std::size_t step = 1 + places_m.size() / most;
  std::size_t num_asked = 0;
  std::size_t num_land = 0;
  for (std::size_t i = 0; i < places_m.size(); i += step) {
    ++num_asked;
    if (IsLand(places_m[i])) ++num_land;
  }
  return static_cast<double>(num_land) / static_cast<double>(num_asked);
}

std::vector<Eigen::Vector2d> LandMemory::Waterline(const Eigen::Vector2d& near_m, double range_m, std::size_t most) const {
  constexpr int kFreeBefore = 3;  // cells
  std::vector<Eigen::Vector2d> places_m;
  for (const auto& [number, tile] : tiles_) {
    const Eigen::Vector2d corner_m(number.first * kTileCells * kCellM, number.second * kTileCells * kCellM);
    if (tile.num_land == 0 || (corner_m - near_m).norm() > range_m + 2.0 * kTileCells * kCellM) continue;
    for (int north = 0; north < kTileCells; ++north) {
      for (int east = 0; east < kTileCells; ++east) {
        if (tile.evidence[IndexOf(east, north)] < kIsLand) continue;
        const Cell cell{number.first * kTileCells + east, number.second * kTileCells + north};
        const Eigen::Vector2d place_m = MiddleOf(cell);
        const double range = (place_m - near_m).norm();
        if (range > range_m) continue;
        const Eigen::Vector2d towards = range > 0.0 ? Eigen::Vector2d((near_m - place_m) / range) : Eigen::Vector2d::Zero();
        bool is_edge = true;
        for (int i = 1; i <= kFreeBefore && is_edge; ++i) {
          const Cell before = CellOf(place_m + i * kCellM * towards);
          is_edge = before == cell || !IsLandCell(before);
        }
        if (is_edge) places_m.push_back(place_m);
      }
    }
  }
  std::ranges::stable_sort(places_m, {}, [&near_m](const Eigen::Vector2d& place_m) { return (place_m - near_m).squaredNorm(); });
  if (places_m.size() > most) places_m.resize(most);
  return places_m;
}

void LandMemory::Forget(const Eigen::Vector2d& own_m) {
  if (tiles_.size() <= kMostTiles) return;
  // A quarter at once, so that this is rare.
  std::vector<std::pair<double, Cell>> by_distance;
  for (const auto& [tile, evidence] : tiles_) {
    by_distance.emplace_back((Eigen::Vector2d(tile.first + 0.5, tile.second + 0.5) * kTileCells * kCellM - own_m).squaredNorm(), tile);
  }
  std::ranges::sort(by_distance);
  for (std::size_t i = kMostTiles * 3 / 4; i < by_distance.size(); ++i) tiles_.erase(by_distance[i].second);
}

}  // namespace lookout::tracker
