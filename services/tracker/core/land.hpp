// What is land, remembered on the map.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace lookout::tracker {

/// Cells of half a metre that hold evidence of land: more with each return of a segment that is land, less with each of one that is not. So one scan
/// that takes a boat for land does not make it land, nor one that takes a bank for a boat a boat. Memory: 1 kB for each tile of 16 m x 16 m, at most
/// kMostTiles; beyond, the farthest from the boat are forgotten.
class LandMemory {
 public:
  static constexpr double kCellM = 0.5;
  static constexpr std::size_t kMostTiles = 4096;

  void Add(const Eigen::Vector2d& place_m, bool is_land);
  /// Whether land is remembered there, or in a cell beside it.
  bool IsLand(const Eigen::Vector2d& place_m) const;
  /// Share of some places that are land; of more than `most` every so many is asked for.
  double Share(std::span<const Eigen::Vector2d> places_m, std::size_t most) const;

  /// Cells of land with a neighbour that is none, at most `range_m` from a place, nearest first, at most `most`.
  std::vector<Eigen::Vector2d> Waterline(const Eigen::Vector2d& near_m, double range_m, std::size_t most) const;

  void Forget(const Eigen::Vector2d& own_m);
  void Clear() { tiles_.clear(); }
  std::size_t num_tiles() const { return tiles_.size(); }

 private:
  static constexpr int kTileCells = 32;
  using Tile = std::array<std::int8_t, static_cast<std::size_t>(kTileCells) * kTileCells>;
  using Cell = std::pair<std::int32_t, std::int32_t>;

  static Cell CellOf(const Eigen::Vector2d& place_m);
  int EvidenceAt(Cell cell) const;

  std::map<Cell, Tile> tiles_;  // by the tile's number east, north
};

}  // namespace lookout::tracker
