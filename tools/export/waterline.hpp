// The land that the tracker remembers, as lines.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "common/core/geodesy.hpp"
#include "tools/export/map_geometry.hpp"

namespace lookout::exporter {

/// Joins the cells of TRACKS' waterline, which come without an order, along their neighbours: lines from middle to middle. A cell without neighbour
/// is a line of its own width. A cell that was told once stays.
class Waterline {
 public:
  static constexpr double kCellM = 0.5;  // of the land memory

  /// @param datum      of the map frame of `middles_m`
  /// @param middles_m  of cells; below 1000 km from the datum
  void Add(const GeodeticPlace& datum, std::span<const Eigen::Vector2d> middles_m);

  void Clear() { cells_.clear(); }

  /// @param near  cells outside are left out; nullptr = none
  std::vector<std::vector<MapPlace>> Lines(const Near* near) const;

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;  // east, north; of kCellM

  static std::vector<std::vector<Cell>> Chains(std::set<Cell> cells);
  static Eigen::Vector2d MiddleOf(const Cell& cell);
  static std::vector<Eigen::Vector2d> Corners(const std::vector<Cell>& chain);

  std::vector<std::pair<GeodeticPlace, std::set<Cell>>> cells_;  // of each datum, in the order of the log
};

}  // namespace lookout::exporter
