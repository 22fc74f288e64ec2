#include "services/segmenter/core/lookout/runs.hpp"

#include <algorithm>
#include <array>

#include "services/segmenter/core/lookout/jetties.hpp"

namespace lookout::segmenter {

namespace {

inline bool AreLinked(const LevelPoint& one, const LevelPoint& other, const Reach& link) {
  const float up_m = one.height_m - other.height_m;
  const auto reach_m = static_cast<float>(link.At(std::min(one.range_m, other.range_m)));
  return SquaredPlanDistance(one, other) + up_m * up_m <= reach_m * reach_m;
}

// A run as it is, or in up to three parts: jetty, shore, jetty. Columns are counted on over the seam.
struct Parts {
  std::array<Run, 3> runs{};
  int num = 0;
};

Parts PartsOf(const ScanGrid& grid, const Run& run) {
  const int num_first = JettyReturns(grid, run, false);
  const int num_last = JettyReturns(grid, run, true);
  Parts parts;
  const auto add = [&parts, &run](int first, int length, bool is_jetty) {
    if (length > 0) parts.runs[static_cast<std::size_t>(parts.num++)] = {run.line, run.first + first, length, is_jetty};
  };
  if (num_first + num_last >= run.length) {
    add(0, run.length, true);
  } else {
    add(0, num_first, true);
    add(num_first, run.length - num_first - num_last, false);
    add(run.length - num_last, num_last, true);
  }
  return parts;
}

}  // namespace

// Returns are taken column by column, as they lie in memory, twice: to find where runs begin, and to number them.
void RunTable::Find(const ScanGrid& grid, const Reach& link) {
  const auto num_lines = static_cast<std::size_t>(grid.num_lines());
  const auto points = grid.points();
  const auto by_column = grid.by_column();
  ends_.assign(num_lines, {});
  is_start_.resize(points.size());
  for (const std::int32_t index : by_column) {
    const LevelPoint& point = grid.PointOf(index);
    const std::int32_t column = grid.ColumnOf(index);
    LineEnd& end = ends_[static_cast<std::size_t>(grid.LineOf(index))];
    // Without a branch: in rain nobody can guess where runs begin.
    const int is_start = static_cast<int>(end.column + 1 != column) | static_cast<int>(!AreLinked(end.point, point, link));
    if (end.first_return == kNone) end.first_return = index;
    end.point = point;
    end.column = column;
    end.num_starts += is_start;
    is_start_[static_cast<std::size_t>(index)] = static_cast<std::uint8_t>(is_start);
  }

  runs_.clear();
  begin_of_line_.clear();
  for (std::size_t line = 0; line < num_lines; ++line) {
    LineEnd& end = ends_[line];
    const auto begin = static_cast<std::int32_t>(runs_.size());
    begin_of_line_.push_back(runs_.size());
    if (end.first_return == kNone) continue;
    // Over the seam.
    const LevelPoint& first = grid.PointOf(end.first_return);
    const bool is_seam_closed = grid.ColumnOf(end.first_return) == 0 && end.column + 1 == grid.num_columns() && AreLinked(end.point, first, link);
    if (is_seam_closed && end.num_starts > 1) {
      is_start_[static_cast<std::size_t>(end.first_return)] = 0;
      --end.num_starts;
    }
    // What goes on over the seam is of the last run, which begins at the last start.
    runs_.resize(runs_.size() + static_cast<std::size_t>(end.num_starts), {static_cast<std::int32_t>(line), 0, 0});
    end.run = begin + end.num_starts - 1;
    end.next_run = begin;
  }
  begin_of_line_.push_back(runs_.size());

  run_of_return_.resize(points.size());
  for (const std::int32_t index : by_column) {
    const auto at = static_cast<std::size_t>(index);
    LineEnd& end = ends_[static_cast<std::size_t>(grid.LineOf(index))];
    const bool is_start = is_start_[at] != 0;
    end.run = is_start ? end.next_run : end.run;
    end.next_run += is_start_[at];
    Run& run = runs_[static_cast<std::size_t>(end.run)];
    run.first = is_start ? grid.ColumnOf(index) : run.first;
    ++run.length;
    run_of_return_[at] = end.run;
  }
}

void RunTable::CutJetties(const ScanGrid& grid) {
  uncut_.swap(runs_);
  begin_of_uncut_.swap(begin_of_line_);
  runs_.clear();
  begin_of_line_.clear();
  bool is_any_cut = false;
  const auto add = [&](const Run& run) {
    // Before the first cut, runs have the numbers that they had.
    for (int place = 0; is_any_cut && place < run.length; ++place) run_of_return_[static_cast<std::size_t>(ReturnOf(grid, run, place))] = size();
    runs_.push_back(run);
  };
  for (std::size_t line = 0; line + 1 < begin_of_uncut_.size(); ++line) {
    begin_of_line_.push_back(runs_.size());
    const std::size_t begin = begin_of_uncut_[line];
    const std::size_t end = begin_of_uncut_[line + 1];
    if (begin == end) continue;
    // Parts of the last run that begin beyond the seam come first.
    Parts last = PartsOf(grid, uncut_[end - 1]);
    is_any_cut = is_any_cut || last.num > 1;
    for (int i = 0; i < last.num; ++i) {
      Run& part = last.runs[static_cast<std::size_t>(i)];
      if (part.first < grid.num_columns()) continue;
      part.first -= grid.num_columns();
      add(part);
      part.length = 0;
    }
    for (std::size_t i = begin; i + 1 < end; ++i) {
      const Parts parts = PartsOf(grid, uncut_[i]);
      is_any_cut = is_any_cut || parts.num > 1;
      for (int k = 0; k < parts.num; ++k) add(parts.runs[static_cast<std::size_t>(k)]);
    }
    for (int i = 0; i < last.num; ++i) {
      if (last.runs[static_cast<std::size_t>(i)].length > 0) add(last.runs[static_cast<std::size_t>(i)]);
    }
  }
  begin_of_line_.push_back(runs_.size());
}

}  // namespace lookout::segmenter
