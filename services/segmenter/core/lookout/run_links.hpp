// The second step of the lookout method: which runs are of one piece.
#pragma once

#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/runs.hpp"
#include "services/segmenter/core/lookout/turn_grid.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

/// How far apart in columns and rings two returns may lie and be linked. Wider than a neighbour, so that a beam that saw nothing does not cut a hull.
inline constexpr int kLinkColumns = 6;        // in a ring: 1.2 degrees at 0.2
inline constexpr int kLinkAcrossColumns = 4;  // between rings
inline constexpr int kLinkRings = 3;          // 6 degrees at 2

/// Joins runs that hold two returns which are linked:
/// - of one ring, at most kLinkColumns apart, and at most `link` apart;
/// - of rings at most kLinkRings apart, at most kLinkAcrossColumns columns apart, and at most `link` apart as seen from above: a mast over a hull;
/// - the ends of a line of three returns in neighbouring columns, evenly spaced and straight: a wall that is seen along (JoinGrazing).
/// All relations are between pairs (or threes) of returns and do not depend on the order. Cost: about proportional to the returns.
void LinkRuns(const TurnGrid& grid, const RunTable& runs, const Reach& link, UnionFind& sets);

/// Calls handle(run, other) for runs of one line with ends at most kLinkColumns apart, each pair once.
template <typename Handler>
void ForEachFollowing(const TurnGrid& grid, const RunTable& runs, int line, Handler handle) {
  const auto of_line = runs.OfLine(line);
  const auto count = static_cast<std::int32_t>(of_line.size());
  const std::int32_t first_run = runs.FirstOfLine(line);
  for (std::int32_t i = 0; i < count; ++i) {
    const Run& run = of_line[static_cast<std::size_t>(i)];
    const int last_column = run.first + run.length - 1;
    std::int32_t j = i;
    for (std::int32_t step = 1; step < count; ++step) {
      if (++j == count) j = 0;
      int gap = of_line[static_cast<std::size_t>(j)].first - last_column;
      if (gap <= 0) gap += grid.num_columns();
      if (gap > kLinkColumns) break;
      handle(first_run + i, first_run + j);
    }
  }
}

}  // namespace lookout::segmenter
