// Where something stood in the last half minute: quays, pontoons, moored boats, of which a scan shows a few returns.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>

#include "common/core/utime.hpp"

namespace lookout::tracker {

/// Square cells of the map, each with the half seconds in which it held returns of things that do not move. A quay that is seen along its face, or a
/// pontoon in waves, shows a few returns, now here and now there: no single scan says that it stands there, half a minute does. Returns high over the
/// water, as of a bridge, are remembered apart: a boat passes below them.
///
/// Memory: some 60 bytes a cell, 24 MB at most.
class StandingGround {
 public:
  static constexpr double kCellM = 0.5;
  static constexpr int kKept = 64;           // half seconds
  static constexpr double kOverheadM = 2.5;  // over the water: higher than the hull of a small boat

  /// Begins a scan. Cells that were not met for longer than is kept are forgotten now and then.
  void Begin(Utime time);
  /// @param places_m   on the map, of returns of one thing that is not known to move
  /// @param heights_m  over the water, of each of them; empty: not known, which counts as low
  void Add(std::span<const Eigen::Vector2d> places_m, std::span<const double> heights_m);
  /// Number of kept half seconds before `before` in which the cell of the place, or one of its eight neighbours, held returns: in the overhead layer
  /// for heights from kOverheadM on, else in the low one.
  int TimesMet(const Eigen::Vector2d& place_m, double height_m, Utime before) const;
  void Clear() { layers_ = {}; }
  std::size_t num_cells() const { return layers_[0].size() + layers_[1].size(); }

 private:
  struct Cell {
    std::int64_t last = 0;     // half second, since 1970
    std::uint64_t is_met = 0;  // bit i: i half seconds before the last
  };
  using Layer = std::unordered_map<std::int64_t, Cell>;  // looked up only: its order decides nothing
  static constexpr std::size_t kMostCells = 200'000;
  static std::size_t LayerOf(double height_m) { return height_m >= kOverheadM ? 1 : 0; }

  std::int64_t now_ = 0;           // half second
  std::array<Layer, 2> layers_{};  // low, overhead
};

}  // namespace lookout::tracker
