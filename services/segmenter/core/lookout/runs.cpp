#include "services/segmenter/core/lookout/runs.hpp"

#include <algorithm>

namespace lookout::segmenter {

namespace {

bool AreLinked(const LevelPoint& one, const LevelPoint& other, const Reach& link) {
  const float up_m = one.height_m - other.height_m;
  const auto reach_m = static_cast<float>(link.At(std::min(one.range_m, other.range_m)));
  return SquaredPlanDistance(one, other) + up_m * up_m <= reach_m * reach_m;
}

}  // namespace

void RunTable::Find(const TurnGrid& grid, const Reach& link) {
  runs_.clear();
  begin_of_line_.clear();
  run_of_return_.assign(grid.points().size(), kNone);
  const int num_columns = grid.num_columns();
  occupied_.resize(static_cast<std::size_t>(num_columns) + 1);
  for (int line = 0; line < grid.num_lines(); ++line) {
    begin_of_line_.push_back(runs_.size());
    const auto goes_on = [&](int from, int to) {
      const std::int32_t one = grid.At(line, from);
      const std::int32_t other = grid.At(line, to);
      return one != TurnGrid::kNone && other != TurnGrid::kNone && AreLinked(grid.PointOf(one), grid.PointOf(other), link);
    };
    // From the first column at which nothing goes on from the one before.
    int start = 0;
    while (start < num_columns && goes_on(grid.Wrap(start - 1), start)) ++start;
    const bool is_closed = start == num_columns;
    if (is_closed) start = 0;
    // The columns with a return, without a branch for each cell; then on from `start` over the seam.
    std::int32_t num_occupied = 0;
    for (int column = 0; column < num_columns; ++column) {
      occupied_[static_cast<std::size_t>(num_occupied)] = column;
      num_occupied += grid.At(line, column) != TurnGrid::kNone ? 1 : 0;
    }
    const auto end = occupied_.begin() + num_occupied;
    const auto first = std::lower_bound(occupied_.begin(), end, start);
    int last_column = kNone;
    const auto take = [&](int column) {
      const std::int32_t index = grid.At(line, column);
      const bool follows = last_column != kNone && column == grid.Wrap(last_column + 1);
      if (!follows || !AreLinked(grid.PointOf(grid.At(line, last_column)), grid.PointOf(index), link)) runs_.push_back({line, column, 0});
      ++runs_.back().length;
      run_of_return_[static_cast<std::size_t>(index)] = size() - 1;
      last_column = column;
    };
    std::for_each(first, end, take);
    std::for_each(occupied_.begin(), first, take);
  }
  begin_of_line_.push_back(runs_.size());
}

}  // namespace lookout::segmenter
