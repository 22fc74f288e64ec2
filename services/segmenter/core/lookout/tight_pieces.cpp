#include "services/segmenter/core/lookout/tight_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lookout::segmenter {

namespace {

constexpr std::size_t kMostLayers = 2;  // returns of a shot
// More are noise: 128 rings of 2048 columns in heavy rain have half as many.
constexpr std::size_t kMostRuns = 100'000;
constexpr std::int32_t kLargestLeftOut = 64;  // 2^21 cells in pieces of more are less than kMostPieces

bool AreLinked(const LevelPoint& one, const LevelPoint& other, bool are_of_one_ring, const Reach& link) {
  const auto reach_m = static_cast<float>(link.At(std::min(one.range_m, other.range_m)));
  float squared_m2 = SquaredPlanDistance(one, other);
  if (are_of_one_ring) squared_m2 += (one.height_m - other.height_m) * (one.height_m - other.height_m);
  return squared_m2 <= reach_m * reach_m;
}

}  // namespace

// Whether a line has in columns [first, last] a return at a range at most reach_m off that is not of a known run.
template <int kNum>
bool TightPieces::IsOtherNear(const ScanGrid& grid, int line, int first, float range_m, float reach_m, std::int32_t known_run) const {
  static_assert(kNum < ScanGrid::kMinColumns);
  const float* const range = grid.RangesOf(line).data();
  const std::int32_t* const run = run_at_.data() + static_cast<std::size_t>(line) * static_cast<std::size_t>(grid.num_columns());
  int num_near = 0;
  if (first < 0 || first + kNum > grid.num_columns()) {
    for (int step = 0; step < kNum; ++step) {
      const int column = grid.Wrap(first + step);
      num_near += (std::abs(range[column] - range_m) <= reach_m ? 1 : 0) & (run[column] != known_run ? 1 : 0);
    }
    return num_near > 0;
  }
  for (int column = first; column < first + kNum; ++column) {
    num_near += (std::abs(range[column] - range_m) <= reach_m ? 1 : 0) & (run[column] != known_run ? 1 : 0);
  }
  return num_near > 0;
}

// Neighbours in a line are linked first, then returns farther apart in it: most links are found so, and returns of one run need no further look.
void TightPieces::FindRuns(const ScanGrid& grid, const Reach& link) {
  by_line_.clear();
  run_at_.assign(static_cast<std::size_t>(grid.num_lines()) * static_cast<std::size_t>(grid.num_columns()), ScanGrid::kNone);
  std::int32_t num_runs = 0;
  for (int line = 0; line < grid.num_lines(); ++line) {
    std::int32_t last = ScanGrid::kNone;
    int last_column = 0;
    for (int column = grid.NextOccupied(line, 0); column < grid.num_columns();
         column = column + 1 < grid.num_columns() ? grid.NextOccupied(line, column + 1) : grid.num_columns()) {
      const std::int32_t index = grid.At(line, column);
      const bool goes_on = last != ScanGrid::kNone && column - last_column == 1 && AreLinked(grid.PointOf(last), grid.PointOf(index), true, link);
      if (!goes_on) ++num_runs;
      RunAt(grid, line, column) = num_runs - 1;
      by_line_.push_back({line, column, index});
      last = index;
      last_column = column;
    }
  }
  sets_.Reset(static_cast<std::size_t>(num_runs));
  const auto look = [&](const Seen& seen) {
    const auto [line, column, index] = seen;
    const float range_m = grid.RangeAt(line, column);
    const float widest_m = WidestRange(link.At(range_m), range_m);
    if (!IsOtherNear<kLinkColumns>(grid, line, column + 1, range_m, widest_m, RunAt(grid, line, column))) return;
    LookAlong(grid, link, seen, line, column + 1, column + kLinkColumns);
  };
  const auto is_run_at = [&](const Seen& seen, int columns_on) {
    const int column = seen.column + columns_on;
    return column < grid.num_columns() && RunAt(grid, seen.line, column) == RunAt(grid, seen.line, seen.column);
  };
  // The last return of each run looks first. Where a drop splits a wall, this already links both sides; the returns before the end then find the drop
  // alone.
  before_end_.clear();
  for (const Seen& seen : by_line_) {
    if (is_run_at(seen, kLinkColumns)) continue;
    if (is_run_at(seen, 1)) {
      before_end_.push_back(seen);
    } else {
      look(seen);
    }
  }
  NameRunsBySet(grid);
  for (const Seen& seen : before_end_) look(seen);
  NameRunsBySet(grid);
  // Runs are counted after they were linked along their line, not as neighbours alone make them: a scan in which every other beam meets nothing is no
  // noise, and the cut of a scan parts runs too.
  num_runs_ = 0;
  for (std::int32_t run = 0; run < num_runs; ++run) num_runs_ += sets_.Find(run) == run ? 1U : 0U;
}

void TightPieces::NameRunsBySet(const ScanGrid& grid) {
  for (const Seen& seen : by_line_) {
    std::int32_t& run = RunAt(grid, seen.line, seen.column);
    run = sets_.Find(run);
  }
}

// Links a return with those of a line in columns [first, last], over the seam, too. @return a run there that is linked with it; kNone = there is none
std::int32_t TightPieces::LookAlong(const ScanGrid& grid, const Reach& link, const Seen& from, int line, int first, int last) {
  const LevelPoint& point = grid.PointOf(from.index);
  const bool are_of_one_ring = grid.RingOf(line) == grid.RingOf(from.line);
  const float widest_m = WidestRange(link.At(point.range_m), point.range_m);
  const std::int32_t own_run = RunAt(grid, from.line, from.column);
  std::int32_t linked = ScanGrid::kNone;
  for (int step = first; step <= last; ++step) {
    const int column = grid.Wrap(step);
    if (!(std::abs(grid.RangeAt(line, column) - point.range_m) <= widest_m)) continue;
    const std::int32_t run = RunAt(grid, line, column);
    if (run == linked) continue;
    const bool is_of_set = sets_.Find(run) == sets_.Find(own_run);
    if (!is_of_set && !AreLinked(point, grid.PointOf(grid.At(line, column)), are_of_one_ring, link)) continue;
    if (!is_of_set) sets_.Join(own_run, run);
    linked = run;
  }
  return linked;
}

void TightPieces::Find(const ScanGrid& grid, const Reach& link) {
  FindRuns(grid, link);
  if (num_runs_ <= kMostRuns) LinkRings(grid, link);
  NumberPieces(grid);
}

void TightPieces::LinkRings(const ScanGrid& grid, const Reach& link) {
  // Runs that were linked last, by how many lines lie between them: those of the next return will be the same.
  struct Linked {
    std::int32_t own_run = ScanGrid::kNone;
    std::int32_t run = ScanGrid::kNone;
  };
  std::array<Linked, (kLinkRings + 1) * kMostLayers> linked;
  for (const Seen& seen : by_line_) {
    const auto [line, column, index] = seen;
    const int ring = grid.RingOf(line);
    const float range_m = grid.RangeAt(line, column);
    const float widest_m = WidestRange(link.At(range_m), range_m);
    const std::int32_t own_run = RunAt(grid, line, column);
    // Each pair once: all of the lines above.
    const int end = std::min(grid.num_lines(), (ring + kLinkRings + 1) * grid.num_layers());
    for (int other_line = line + 1; other_line < end; ++other_line) {
      Linked& last = linked[static_cast<std::size_t>(other_line - line)];
      const std::int32_t known_run = last.own_run == own_run ? last.run : ScanGrid::kNone;
      const bool are_of_one_ring = grid.RingOf(other_line) == ring;
      const int window = are_of_one_ring ? kLinkColumns : kLinkAcrossColumns;
      const bool is_other_near = are_of_one_ring
                                     ? IsOtherNear<2 * kLinkColumns + 1>(grid, other_line, column - window, range_m, widest_m, known_run)
                                     : IsOtherNear<2 * kLinkAcrossColumns + 1>(grid, other_line, column - window, range_m, widest_m, known_run);
      if (!is_other_near) continue;
      const std::int32_t run = LookAlong(grid, link, seen, other_line, column - window, column + window);
      if (run != ScanGrid::kNone) last = {own_run, run};
    }
  }
}

void TightPieces::NumberPieces(const ScanGrid& grid) {
  of_return_.resize(grid.points().size());
  size_of_set_.assign(sets_.size(), 0);
  std::int32_t num_pieces = 0;
  num_left_out_ = 0;
  for (std::size_t i = 0; i < of_return_.size(); ++i) {
    const auto index = static_cast<std::int32_t>(i);
    of_return_[i] = sets_.Find(RunAt(grid, grid.LineOf(index), grid.ColumnOf(index)));
    std::int32_t& size = size_of_set_[static_cast<std::size_t>(of_return_[i])];
    if (size == 0) ++num_pieces;
    ++size;
  }
  std::array<std::int32_t, kLargestLeftOut + 1> num_of_size{};
  for (const std::int32_t size : size_of_set_) ++num_of_size[static_cast<std::size_t>(std::min(size, kLargestLeftOut))];
  std::int32_t least_size = 1;
  for (std::int32_t num = num_pieces; num > kMostPieces && least_size <= kLargestLeftOut; ++least_size) {
    num -= num_of_size[static_cast<std::size_t>(least_size)];
  }
  number_of_set_.assign(sets_.size(), kNone);
  count_ = 0;
  for (std::int32_t& piece : of_return_) {
    const auto set = static_cast<std::size_t>(piece);
    if (size_of_set_[set] < least_size) {
      piece = kNone;
      continue;
    }
    if (number_of_set_[set] == kNone) number_of_set_[set] = count_++;
    piece = number_of_set_[set];
  }
  num_left_out_ = num_pieces - count_;
}

}  // namespace lookout::segmenter
