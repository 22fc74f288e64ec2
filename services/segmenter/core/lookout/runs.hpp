// The first step of the lookout method: runs, unbroken stretches of one surface along a line.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"

namespace lookout::segmenter {

/// Columns [first, first + length) of a line, on over the seam of the circle. A run that goes all the way round starts at column 0.
struct Run {
  std::int32_t line = 0;
  std::int32_t first = 0;
  std::int32_t length = 0;
  bool is_jetty = false;  // linked to no run that is none
};

/// All runs of a scan: line by line, in the order of their columns from the first break on. Where they begin and end does not depend on where the
/// turn was cut.
class RunTable {
 public:
  static constexpr std::int32_t kNone = -1;

  /// Two returns in neighbouring columns of a line are of one run when they are at most `link` apart, at the nearer one's distance.
  void Find(const ScanGrid& grid, const Reach& link);

  /// Cuts jetties off the runs that hold a shore, too (JettyReturns), and marks them.
  void CutJetties(const ScanGrid& grid);

  std::int32_t size() const { return static_cast<std::int32_t>(runs_.size()); }
  const Run& operator[](std::int32_t run) const { return runs_[static_cast<std::size_t>(run)]; }
  std::span<const Run> OfLine(int line) const {
    return std::span(runs_).subspan(begin_of_line_[static_cast<std::size_t>(line)],
                                    begin_of_line_[static_cast<std::size_t>(line) + 1] - begin_of_line_[static_cast<std::size_t>(line)]);
  }
  std::int32_t FirstOfLine(int line) const { return static_cast<std::int32_t>(begin_of_line_[static_cast<std::size_t>(line)]); }
  std::int32_t OfReturn(std::int32_t index) const { return run_of_return_[static_cast<std::size_t>(index)]; }

 private:
  std::vector<Run> runs_;
  std::vector<std::size_t> begin_of_line_;   // [lines + 1]
  std::vector<std::int32_t> run_of_return_;  // [returns]
  // Scratch: where a line is when returns are taken column by column.
  static constexpr std::int32_t kNoColumn = -2;  // before none
  struct LineEnd {
    LevelPoint point{};  // of its last return
    std::int32_t column = kNoColumn;
    std::int32_t first_return = kNone;
    std::int32_t num_starts = 0;
    std::int32_t run = 0;  // of its last return
    std::int32_t next_run = 0;
  };
  std::vector<Run> uncut_;
  std::vector<std::size_t> begin_of_uncut_;
  std::vector<LineEnd> ends_;           // [lines]
  std::vector<std::uint8_t> is_start_;  // [returns] whether a run begins with it
};

/// Of a run, by its place in it.
inline std::int32_t ReturnOf(const ScanGrid& grid, const Run& run, int place) { return grid.At(run.line, grid.Wrap(run.first + place)); }
inline std::int32_t FirstReturn(const ScanGrid& grid, const Run& run) { return grid.At(run.line, run.first); }
inline std::int32_t LastReturn(const ScanGrid& grid, const Run& run) { return ReturnOf(grid, run, run.length - 1); }

}  // namespace lookout::segmenter
