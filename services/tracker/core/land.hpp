// Land, remembered on the map.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "services/tracker/core/sight.hpp"

namespace lookout::tracker {

/// Cells of half a metre that hold evidence of land: more with each scan that sees land there, less with each scan that sees something else, and less
/// where beams pass below the height of earlier returns. So one scan that takes a boat for land makes no land, one scan that takes a bank for a boat
/// makes no boat, and a thing that left leaves no land behind.
///
/// Memory: 2 kB for each tile of 16 m x 16 m, at most kMostTiles and those that one scan adds (8 MB); beyond, the farthest from the boat are
/// forgotten.
class LandMemory {
 public:
  static constexpr double kCellM = 0.5;
  static constexpr std::size_t kMostTiles = 4096;

  enum class Said { kLand, kThing, kMaybeThing };

  /// One segment of one scan: each cell counts once, however many returns lie in it.
  /// @param tops_m  [places] heights over the water; empty where they are not known: then the cells do not become free by being looked through
  void Add(std::span<const Eigen::Vector2d> places_m, std::span<const double> tops_m, Said said);
  /// Looks for beams that passed where land is remembered: at most kMostLooked cells a scan, one tile after the other, so that each cell has its turn
  /// within a second or two.
  void LookThrough(const Sight& sight);

  /// Whether land is remembered there, or in a cell beside it.
  bool IsLand(const Eigen::Vector2d& place_m) const;
  /// Share of the places that are land; of more than `most` places, at most so many, evenly spread, count.
  double Share(std::span<const Eigen::Vector2d> places_m, std::size_t most) const;

  /// Cells of land with free cells before them, as seen from `near_m`: at most `most`, at most `range_m` off, the nearest first.
  std::vector<Eigen::Vector2d> Waterline(const Eigen::Vector2d& near_m, double range_m, std::size_t most) const;

  void Forget(const Eigen::Vector2d& own_m);
  void Clear() { *this = {}; }
  std::size_t num_tiles() const { return tiles_.size(); }

 private:
  static constexpr std::size_t kMostLooked = 300;
  static constexpr std::int32_t kTileCells = 32;  // along each side
  struct Tile {
    std::array<std::int8_t, static_cast<std::size_t>(kTileCells) * kTileCells> evidence{};
    std::array<std::uint8_t, static_cast<std::size_t>(kTileCells) * kTileCells> top_dm{};  // over the water; 0: not known
    int num_land = 0;                                                                      // cells
  };
  using Cell = std::pair<std::int32_t, std::int32_t>;

  static Cell CellOf(const Eigen::Vector2d& place_m);
  static Eigen::Vector2d MiddleOf(Cell cell) { return {(cell.first + 0.5) * kCellM, (cell.second + 0.5) * kCellM}; }
  static std::size_t IndexOf(std::int32_t east, std::int32_t north) {
    return static_cast<std::size_t>(north) * kTileCells + static_cast<std::size_t>(east);
  }
  static std::size_t IndexOf(Cell cell) { return IndexOf(cell.first & 31, cell.second & 31); }
  static void Change(Tile& tile, std::size_t index, int by);
  bool IsLandCell(Cell cell) const;

  std::map<Cell, Tile> tiles_;  // by the tile's number east, north
  Cell looked_{};               // the tile that was looked through last
};

}  // namespace lookout::tracker
