// The second step of the lookout method: which runs are of one piece.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/runs.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

/// How far apart in columns and rings two returns may lie and be linked. Wider than a neighbour, so that a beam that saw nothing does not cut a hull.
inline constexpr int kLinkColumns = 6;        // in a ring: 1.2 degrees at 0.2
inline constexpr int kLinkAcrossColumns = 4;  // between rings
inline constexpr int kLinkRings = 3;          // 6 degrees at 2

/// Joins runs that hold two returns which are linked:
/// - of one ring, at most kLinkColumns apart, and at most `link` apart;
/// - of rings at most kLinkRings apart, at most kLinkAcrossColumns columns apart, and at most `link` apart as seen from above: a mast over a hull;
/// - the ends of a line of three returns in neighbouring columns, evenly spaced and straight: a wall that is seen along.
/// A jetty is linked to jetties alone.
/// All relations are between pairs (or threes) of returns and do not depend on the order. Cost: about proportional to the returns.
class RunLinker {
 public:
  void Link(const ScanGrid& grid, const RunTable& runs, const Reach& link, UnionFind& sets);

  /// Runs of a line that follow each other and are joined already: columns [first, end), on over the seam of the circle. Drops between them that have
  /// nothing near them in the rings about are left out.
  struct Strand {
    std::int32_t first = 0;
    std::int32_t end = 0;
    std::int32_t run = 0;  // one of them
    float min_range_m = 0.0F;
    float most_range_m = 0.0F;  // of what may be linked to it
  };

 private:
  void FindStrands(const ScanGrid& grid, const RunTable& runs, const Reach& link, UnionFind& sets);

  std::vector<std::int32_t> in_line_;  // scratch: runs of a line that have something near them there
  std::vector<Strand> strands_;
  std::vector<std::size_t> begin_of_line_;  // [lines + 1]
};

/// Calls handle(run, other) for those of these runs of one line, in their order, with ends at most kLinkColumns apart, each pair once.
template <typename Handler>
void ForEachFollowing(const ScanGrid& grid, const RunTable& runs, std::span<const std::int32_t> of_line, Handler handle) {
  const std::size_t count = of_line.size();
  for (std::size_t i = 0; i < count; ++i) {
    const int last_column = runs[of_line[i]].first + runs[of_line[i]].length - 1;
    std::size_t j = i;
    for (std::size_t step = 1; step < count; ++step) {
      if (++j == count) j = 0;
      int gap = runs[of_line[j]].first - last_column;
      if (gap <= 0) gap += grid.num_columns();
      if (gap > kLinkColumns) break;
      handle(of_line[i], of_line[j]);
    }
  }
}

}  // namespace lookout::segmenter
