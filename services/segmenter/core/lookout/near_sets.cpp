#include "services/segmenter/core/lookout/near_sets.hpp"

#include <algorithm>

namespace lookout::segmenter {

namespace {

bool AreNear(const OutlineEntry& one, const OutlineEntry& other, const Reach& reach) {
  const auto are_near = [&reach](const LevelPoint& from, const LevelPoint& to) {
    const double reach_m = reach.At(std::min(from.range_m, to.range_m));
    return SquaredPlanDistance(from, to) <= reach_m * reach_m;
  };
  return are_near(one.near_point, other.near_point) || are_near(one.near_point, other.far_point) || are_near(one.far_point, other.near_point) ||
         are_near(one.far_point, other.far_point);
}

}  // namespace

void NearSets::Reset(std::size_t num_pieces) {
  is_added_.assign(num_pieces, 0);
  groups_.Reset(num_pieces);
}

void NearSets::Group(const ScanGrid& grid, const PieceTable& pieces, const Reach& reach) {
  for (int column = 0; column < grid.num_columns(); ++column) {
    for (const OutlineEntry& entry : pieces.InColumn(column)) {
      if (is_added_[static_cast<std::size_t>(pieces.RootOf(entry.piece))] == 0) continue;
      for (const int way : {1, -1}) LookFrom(entry, way, grid, pieces, reach);
    }
  }
}

void NearSets::LookFrom(const OutlineEntry& entry, int way, const ScanGrid& grid, const PieceTable& pieces, const Reach& reach) {
  const std::int32_t root = pieces.RootOf(entry.piece);
  // By the farthest reach that can be.
  const int window = grid.ColumnsOf(reach.At(entry.far_point.range_m), entry.near_point.range_m);
  bool goes_on = false;
  for (int step = 0; step <= window && !goes_on; ++step) {
    for (const OutlineEntry& other : pieces.InColumn(grid.Wrap(entry.column + way * step))) {
      const std::int32_t other_root = pieces.RootOf(other.piece);
      goes_on = goes_on || (step > 0 && other_root == root);
      if (other_root == root || is_added_[static_cast<std::size_t>(other_root)] == 0) continue;
      if (groups_.Find(root) != groups_.Find(other_root) && AreNear(entry, other, reach)) groups_.Join(root, other_root);
    }
  }
}

}  // namespace lookout::segmenter
