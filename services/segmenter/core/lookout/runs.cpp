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
    std::int32_t last = TurnGrid::kNone;
    for (int step = 0; step < num_columns; ++step) {
      const int column = grid.Wrap(start + step);
      const std::int32_t index = grid.At(line, column);
      if (index != TurnGrid::kNone) {
        if (last == TurnGrid::kNone || !AreLinked(grid.PointOf(last), grid.PointOf(index), link)) runs_.push_back({line, column, 0});
        ++runs_.back().length;
        run_of_return_[static_cast<std::size_t>(index)] = size() - 1;
      }
      last = index;
    }
  }
  begin_of_line_.push_back(runs_.size());
}

}  // namespace lookout::segmenter
