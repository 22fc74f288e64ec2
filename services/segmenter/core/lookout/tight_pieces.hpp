// The first step of the lookout method: pieces so tight that nothing passes between their returns.
#pragma once

#include <cstdint>
#include <vector>

#include "services/segmenter/core/lookout/reach.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

/// How far apart in columns and rings two returns may lie and be linked. Wider than a neighbour, so that a beam that saw nothing does not cut a hull.
inline constexpr int kLinkColumns = 8;        // in a ring: 1.6 degrees at 0.2
inline constexpr int kLinkAcrossColumns = 4;  // between rings
inline constexpr int kLinkRings = 2;          // 4 degrees at 2

/// Joins returns that are linked:
/// - of one ring, at most kLinkColumns columns apart, and at most `link` apart;
/// - of rings at most kLinkRings apart, at most kLinkAcrossColumns columns apart, and at most `link` apart as seen from above: a mast over a hull.
/// All links are between two returns and do not depend on the order.
class TightPieces {
 public:
  /// Cost: about proportional to the returns. Allocates nothing once it has seen a scan of that size.
  void Find(const ScanGrid& grid, const Reach& link);

  /// [returns] the piece of each, numbered in the order of their first return.
  const std::vector<std::int32_t>& of_return() const { return of_return_; }
  std::int32_t count() const { return count_; }

 private:
  void FindRuns(const ScanGrid& grid, const Reach& link);
  std::int32_t LookAlong(const ScanGrid& grid, const Reach& link, std::int32_t index, int line, int first, int last);
  template <int kNum>
  bool IsOtherNear(const ScanGrid& grid, int line, int first, float range_m, float reach_m, std::int32_t known_run) const;
  std::int32_t& RunAt(const ScanGrid& grid, int line, int column) {
    return run_at_[static_cast<std::size_t>(line) * static_cast<std::size_t>(grid.num_columns()) + static_cast<std::size_t>(column)];
  }

  UnionFind sets_;                     // of runs
  std::vector<std::int32_t> by_line_;  // the returns, line by line
  std::vector<std::int32_t> run_at_;   // [lines x columns] what is linked in a line; ScanGrid::kNone = no return
  std::vector<std::int32_t> number_of_run_;
  std::vector<std::int32_t> of_return_;
  std::int32_t count_ = 0;
};

}  // namespace lookout::segmenter
