// Where something stood in the last half minute: quays, pontoons, moored boats, as little of them as is seen at a time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>

#include "common/core/utime.hpp"

namespace lookout::tracker {

/// Square cells of the map, each with the half seconds in which it held returns of what does not move. A quay that is seen along its face, or a
/// pontoon in waves, shows a few returns, now here and now there: no scan says that it stands there, half a minute does.
///
/// Memory: some 60 bytes a cell, 12 MB at most.
class StandingGround {
 public:
  static constexpr double kCellM = 0.5;
  static constexpr int kKept = 64;  // half seconds

  /// Begins a scan. Cells that were not met for longer than is kept are forgotten now and then.
  void Begin(Utime time);
  /// @param places_m  on the map, of returns of one thing that is not known to move
  void Add(std::span<const Eigen::Vector2d> places_m);
  /// In how many half seconds before that of `before` something was met in the cell of a place, or in one of the eight beside it.
  int TimesMet(const Eigen::Vector2d& place_m, Utime before) const;
  void Clear() { cells_.clear(); }
  std::size_t num_cells() const { return cells_.size(); }

 private:
  struct Cell {
    std::int64_t last = 0;     // half second, since 1970
    std::uint64_t is_met = 0;  // bit i: i half seconds before the last
  };
  static constexpr std::size_t kMostCells = 200'000;

  std::int64_t now_ = 0;                          // half second
  std::unordered_map<std::int64_t, Cell> cells_;  // looked up only: its order decides nothing
};

}  // namespace lookout::tracker
