// Tight pieces: returns so close that nothing passes between them.
#pragma once

#include <cstdint>
#include <vector>

#include "services/segmenter/core/lookout/reach.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

/// How far apart in columns and rings two linked returns may lie. More than one, so that a beam that saw nothing does not cut a hull.
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

  static constexpr std::int32_t kNone = -1;
  /// As many as labels of 16 bits number. Of a scan that is in more pieces, those of one return are left out; if need be of two, and so on.
  static constexpr std::int32_t kMostPieces = 32'767;

  /// [returns] the piece of each, numbered in the order of their first return; kNone: it is left out.
  const std::vector<std::int32_t>& of_return() const { return of_return_; }
  std::int32_t count() const { return count_; }
  std::int32_t num_left_out() const { return num_left_out_; }

 private:
  struct Seen {
    std::int32_t line = 0;
    std::int32_t column = 0;
    std::int32_t index = 0;  // of the return
  };

  void LinkRings(const ScanGrid& grid, const Reach& link);
  void NumberPieces(const ScanGrid& grid);
  void FindRuns(const ScanGrid& grid, const Reach& link);
  void NameRunsBySet(const ScanGrid& grid);
  std::int32_t LookAlong(const ScanGrid& grid, const Reach& link, const Seen& from, int line, int first, int last);
  template <int kNum>
  bool IsOtherNear(const ScanGrid& grid, int line, int first, float range_m, float reach_m, std::int32_t known_run) const;
  std::int32_t& RunAt(const ScanGrid& grid, int line, int column) {
    return run_at_[static_cast<std::size_t>(line) * static_cast<std::size_t>(grid.num_columns()) + static_cast<std::size_t>(column)];
  }

  UnionFind sets_;                    // of runs
  std::size_t num_runs_ = 0;          // after linking along the lines
  std::vector<Seen> by_line_;         // the returns, line by line
  std::vector<Seen> before_end_;      // scratch: returns near the end of a run of neighbours
  std::vector<std::int32_t> run_at_;  // [lines x columns] linked returns of a line; ScanGrid::kNone = no return
  std::vector<std::int32_t> size_of_set_;
  std::vector<std::int32_t> number_of_set_;
  std::vector<std::int32_t> of_return_;
  std::int32_t count_ = 0;
  std::int32_t num_left_out_ = 0;
};

}  // namespace lookout::segmenter
