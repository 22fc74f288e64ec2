#include "services/segmenter/core/lookout/tight_pieces.hpp"

#include <algorithm>
#include <cmath>

namespace lookout::segmenter {

namespace {

bool AreLinked(const LevelPoint& one, const LevelPoint& other, bool are_of_one_ring, const Reach& link) {
  const auto reach_m = static_cast<float>(link.At(std::min(one.range_m, other.range_m)));
  float squared_m2 = SquaredPlanDistance(one, other);
  if (are_of_one_ring) squared_m2 += (one.height_m - other.height_m) * (one.height_m - other.height_m);
  return squared_m2 <= reach_m * reach_m;
}

}  // namespace

// Neighbours in a line are linked first: most links are found so, and what is of one run needs no further look.
void TightPieces::FindRuns(const ScanGrid& grid, const Reach& link) {
  run_of_return_.resize(grid.points().size());
  num_runs_ = 0;
  for (int line = 0; line < grid.num_lines(); ++line) {
    std::int32_t last = ScanGrid::kNone;
    int last_column = 0;
    for (int column = grid.NextOccupied(line, 0); column < grid.num_columns();
         column = column + 1 < grid.num_columns() ? grid.NextOccupied(line, column + 1) : grid.num_columns()) {
      const std::int32_t index = grid.At(line, column);
      const bool goes_on = last != ScanGrid::kNone && column - last_column == 1 && AreLinked(grid.PointOf(last), grid.PointOf(index), true, link);
      if (!goes_on) ++num_runs_;
      run_of_return_[static_cast<std::size_t>(index)] = num_runs_ - 1;
      last = index;
      last_column = column;
    }
  }
}

void TightPieces::Find(const ScanGrid& grid, const Reach& link) {
  FindRuns(grid, link);
  sets_.Reset(static_cast<std::size_t>(num_runs_));
  const auto points = grid.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto index = static_cast<std::int32_t>(i);
    const LevelPoint& point = points[i];
    const int line = grid.LineOf(index);
    const int column = grid.ColumnOf(index);
    const int ring = grid.RingOf(line);
    const float widest_m = WidestRange(link.At(point.range_m), point.range_m);
    std::int32_t run = sets_.Find(run_of_return_[i]);
    const auto look_at = [&](int other_line, int other_column, bool are_of_one_ring) {
      if (!(std::abs(grid.RangeAt(other_line, other_column) - point.range_m) <= widest_m)) return;
      const std::int32_t other = grid.At(other_line, other_column);
      const std::int32_t other_run = sets_.Find(run_of_return_[static_cast<std::size_t>(other)]);
      if (other_run == run || !AreLinked(point, grid.PointOf(other), are_of_one_ring, link)) return;
      sets_.Join(run, other_run);
      run = std::min(run, other_run);
    };
    // Each pair once: on in its own line, and all of the lines above.
    for (int step = 1; step <= kLinkColumns; ++step) look_at(line, grid.Wrap(column + step), true);
    const int end = std::min(grid.num_lines(), (ring + kLinkRings + 1) * grid.num_layers());
    for (int other_line = line + 1; other_line < end; ++other_line) {
      const bool are_of_one_ring = grid.RingOf(other_line) == ring;
      if (!are_of_one_ring && grid.NumNear<kLinkAcrossColumns>(other_line, column, point.range_m, widest_m) == 0) continue;
      const int window = are_of_one_ring ? kLinkColumns : kLinkAcrossColumns;
      for (int step = -window; step <= window; ++step) look_at(other_line, grid.Wrap(column + step), are_of_one_ring);
    }
  }
  number_of_run_.assign(static_cast<std::size_t>(num_runs_), ScanGrid::kNone);
  of_return_.resize(points.size());
  count_ = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::int32_t& number = number_of_run_[static_cast<std::size_t>(sets_.Find(run_of_return_[i]))];
    if (number == ScanGrid::kNone) number = count_++;
    of_return_[i] = number;
  }
}

}  // namespace lookout::segmenter
