// Which sets of pieces come near each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

/// Groups of sets of pieces, each within reach of another of its group. Only those count that were added.
class NearSets {
 public:
  void Reset(std::size_t num_pieces);
  void Add(std::int32_t root) { is_added_[static_cast<std::size_t>(root)] = 1; }

  /// Groups sets of which two entries of the outlines are at most `reach` apart, by the nearer of them. From each entry it looks to both sides as far
  /// as the next entry of the same set, which looks on from there. Cost: about proportional to the entries.
  void Group(const ScanGrid& grid, const PieceTable& pieces, const Reach& reach);

  /// The set that names the group of this one.
  std::int32_t GroupOf(std::int32_t root) { return groups_.Find(root); }

 private:
  void LookFrom(const OutlineEntry& entry, int way, const ScanGrid& grid, const PieceTable& pieces, const Reach& reach);

  std::vector<std::uint8_t> is_added_;  // [pieces] of roots
  UnionFind groups_;
};

}  // namespace lookout::segmenter
