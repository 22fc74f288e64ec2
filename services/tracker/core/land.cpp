#include "services/tracker/core/land.hpp"

#include <algorithm>
#include <cmath>

namespace lookout::tracker {

namespace {

// Evidence of one return; land speaks louder, as a bank is seen by more returns than it is taken for a boat by. Bounds let a change of mind in within
// seconds.
constexpr int kForLand = 3;
constexpr int kAgainst = 4;
constexpr int kMost = 120;
constexpr int kIsLand = 12;

}  // namespace

LandMemory::Cell LandMemory::CellOf(const Eigen::Vector2d& place_m) {
  return {static_cast<std::int32_t>(std::floor(place_m.x() / kCellM)), static_cast<std::int32_t>(std::floor(place_m.y() / kCellM))};
}

void LandMemory::Add(const Eigen::Vector2d& place_m, bool is_land) {
  const auto [east, north] = CellOf(place_m);
  const Cell tile_of{east >> 5, north >> 5};
  auto tile = tiles_.find(tile_of);
  if (tile == tiles_.end()) {
    if (!is_land) return;
    tile = tiles_.emplace(tile_of, Tile{}).first;
  }
  auto& evidence = tile->second[static_cast<std::size_t>((north & 31) * kTileCells + (east & 31))];
  evidence = static_cast<std::int8_t>(std::clamp(evidence + (is_land ? kForLand : -kAgainst), -kMost, kMost));
}

int LandMemory::EvidenceAt(Cell cell) const {
  const auto tile = tiles_.find({cell.first >> 5, cell.second >> 5});
  return tile == tiles_.end() ? 0 : tile->second[static_cast<std::size_t>((cell.second & 31) * kTileCells + (cell.first & 31))];
}

bool LandMemory::IsLand(const Eigen::Vector2d& place_m) const {
  const auto [east, north] = CellOf(place_m);
  for (std::int32_t dn = -1; dn <= 1; ++dn) {
    for (std::int32_t de = -1; de <= 1; ++de) {
      if (EvidenceAt({east + de, north + dn}) >= kIsLand) return true;
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
  std::vector<Eigen::Vector2d> places_m;
  for (const auto& [tile, evidence] : tiles_) {
    const Eigen::Vector2d corner_m(tile.first * kTileCells * kCellM, tile.second * kTileCells * kCellM);
    if ((corner_m - near_m).norm() > range_m + 2.0 * kTileCells * kCellM) continue;
    for (int north = 0; north < kTileCells; ++north) {
      for (int east = 0; east < kTileCells; ++east) {
        if (evidence[static_cast<std::size_t>(north * kTileCells + east)] < kIsLand) continue;
        const Cell cell{tile.first * kTileCells + east, tile.second * kTileCells + north};
        const bool is_edge = EvidenceAt({cell.first - 1, cell.second}) < kIsLand || EvidenceAt({cell.first + 1, cell.second}) < kIsLand ||
                             EvidenceAt({cell.first, cell.second - 1}) < kIsLand || EvidenceAt({cell.first, cell.second + 1}) < kIsLand;
        const Eigen::Vector2d place_m((cell.first + 0.5) * kCellM, (cell.second + 0.5) * kCellM);
        if (is_edge && (place_m - near_m).norm() <= range_m) places_m.push_back(place_m);
      }
    }
  }
  std::ranges::stable_sort(places_m, {}, [&near_m](const Eigen::Vector2d& place_m) { return (place_m - near_m).squaredNorm(); });
  if (places_m.size() > most) places_m.resize(most);
  return places_m;
}

void LandMemory::Forget(const Eigen::Vector2d& own_m) {
  if (tiles_.size() <= kMostTiles) return;
  // A quarter at once, so that it is rare.
  std::vector<std::pair<double, Cell>> by_distance;
  for (const auto& [tile, evidence] : tiles_) {
    by_distance.emplace_back((Eigen::Vector2d(tile.first + 0.5, tile.second + 0.5) * kTileCells * kCellM - own_m).squaredNorm(), tile);
  }
  std::ranges::sort(by_distance);
  for (std::size_t i = kMostTiles * 3 / 4; i < by_distance.size(); ++i) tiles_.erase(by_distance[i].second);
}

}  // namespace lookout::tracker
