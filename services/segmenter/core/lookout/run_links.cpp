#include "services/segmenter/core/lookout/run_links.hpp"

#include <algorithm>
#include <cmath>

namespace lookout::segmenter {

namespace {

// A wall seen along at 5.7 degrees or more (sine 0.1): its returns are ten times as far apart as those of one that faces the lidar.
constexpr double kLeastGrazingSine = 0.1;
constexpr float kGreatestUnevenness = 2.5F;  // of two spacings that follow each other
// Off the straight line: noise of the range, and some of the spacing.
constexpr float kStraightM = 0.04F;
constexpr float kStraightShare = 0.15F;
constexpr int kGrazingColumns = 1;  // to the next return: one may have seen nothing

class Linker {
 public:
  Linker(const TurnGrid& grid, const RunTable& runs, const Reach& link, UnionFind& sets) : grid_(grid), runs_(runs), link_(link), sets_(sets) {}

  void LinkWithinLine(int line) {
    ForEachFollowing(grid_, runs_, line, [this](std::int32_t one, std::int32_t other) { LinkEnds(one, other); });
  }

  // A run with those of another line: of its ring (another return of the shot) or of another ring. kWindow columns aside.
  template <int kWindow>
  void LinkAcross(std::int32_t index, int other_line, bool is_of_one_ring) {
    const Run& run = runs_[index];
    const int num_columns = grid_.num_columns();
    const int num_places = std::min(run.length + 2 * kWindow, num_columns);
    if (run.length == 1) {
      // A drop in most cases: what has nothing near it needs no more. The reach of a pair goes by the nearer one, so this is not too short.
      const float range_m = grid_.RangeAt(run.line, run.first);
      if (!grid_.IsAnyNear<kWindow>(other_line, run.first, range_m, static_cast<float>(link_.At(range_m)))) return;
    }
    const int begin = WrapFar(run.first - kWindow);
    for (int step = 0; step < num_places;) {
      const int from = grid_.Wrap(begin + step);
      const int column = grid_.NextOccupied(other_line, from);
      step += column - from;
      if (step >= num_places) return;
      if (column == num_columns) continue;  // on at the other side of the seam
      // As much of one run as there is before this one.
      const std::int32_t other = runs_.OfReturn(grid_.At(other_line, column));
      const int past = column - runs_[other].first;
      const int end = std::min(num_places, step + runs_[other].length - (past < 0 ? past + num_columns : past));
      if (sets_.Find(index) != sets_.Find(other) && IsLinkedToAny<kWindow>(run, other_line, begin, step, end, is_of_one_ring)) {
        sets_.Join(index, other);
      }
      step = end;
    }
  }

  // Only the ends of runs: inside, neighbours are linked already.
  void LinkGrazing(std::int32_t index) {
    const Run& run = runs_[index];
    LinkGrazingAt(run.line, run.first);
    if (run.length > 1) LinkGrazingAt(run.line, grid_.Wrap(run.first + run.length - 1));
  }

 private:
  bool AreLinked(const LevelPoint& one, const LevelPoint& other, bool is_of_one_ring) const {
    const double reach_m = link_.At(std::min(one.range_m, other.range_m));
    double squared_m2 = SquaredPlanDistance(one, other);
    if (is_of_one_ring) squared_m2 += double{one.height_m - other.height_m} * (one.height_m - other.height_m);
    return squared_m2 <= reach_m * reach_m;
  }

  // More than two returns that are linked are apart in range, however their places are rounded.
  float WidestRange(float range_m) const {
    constexpr double kRoundedM = 1e-3;
    constexpr double kRoundedShare = 4e-6;
    return static_cast<float>(link_.At(range_m) + kRoundedM + kRoundedShare * range_m);
  }

  // The returns of another line at these steps from column `begin`, which is that many columns before the run.
  template <int kWindow>
  bool IsLinkedToAny(const Run& run, int other_line, int begin, int from, int end, bool is_of_one_ring) const {
    for (int step = from; step < end; ++step) {
      const int column = grid_.Wrap(begin + step);
      const float range_m = grid_.RangeAt(other_line, column);
      const float widest_m = WidestRange(range_m);
      const bool may_be_linked = run.length == 1 ? std::abs(grid_.RangeAt(run.line, run.first) - range_m) <= widest_m
                                                 : grid_.IsAnyNear<kWindow>(run.line, column, range_m, widest_m);
      if (may_be_linked && IsLinkedTo(run, step - kWindow, kWindow, grid_.PointOf(grid_.At(other_line, column)), is_of_one_ring)) return true;
    }
    return false;
  }

  // A return beside the run, or at a place of it.
  bool IsLinkedTo(const Run& run, int place, int window, const LevelPoint& point, bool is_of_one_ring) const {
    // Where its ends come near each other round the circle, both count.
    if (run.length + 2 * window > grid_.num_columns()) {
      for (int k = place - window; k <= place + window; ++k) {
        const int on_run = (k + grid_.num_columns()) % grid_.num_columns();
        if (on_run < run.length && AreLinked(grid_.PointOf(ReturnOf(grid_, run, on_run)), point, is_of_one_ring)) return true;
      }
      return false;
    }
    const int end = std::min(run.length - 1, place + window);
    for (int k = std::max(0, place - window); k <= end; ++k) {
      if (AreLinked(grid_.PointOf(ReturnOf(grid_, run, k)), point, is_of_one_ring)) return true;
    }
    return false;
  }

  int WrapFar(int column) const { return grid_.Wrap(grid_.Wrap(column)); }

  // The last columns of one with the first of the other that follows it.
  void LinkEnds(std::int32_t one, std::int32_t other) {
    if (sets_.Find(one) == sets_.Find(other)) return;
    const Run& before = runs_[one];
    const Run& after = runs_[other];
    int gap = after.first - (before.first + before.length - 1);
    while (gap <= 0) gap += grid_.num_columns();
    for (int back = 0; back < before.length && gap + back <= kLinkColumns; ++back) {
      const int from_column = grid_.Wrap(before.first + before.length - 1 - back);
      const float range_m = grid_.RangeAt(before.line, from_column);
      const float widest_m = WidestRange(range_m);
      for (int on = 0; on < after.length && gap + back + on <= kLinkColumns; ++on) {
        const int column = grid_.Wrap(after.first + on);
        if (!(std::abs(grid_.RangeAt(after.line, column) - range_m) <= widest_m)) continue;
        if (!AreLinked(grid_.PointOf(grid_.At(before.line, from_column)), grid_.PointOf(grid_.At(after.line, column)), true)) continue;
        sets_.Join(one, other);
        return;
      }
    }
  }

  std::int32_t NextReturn(int line, int column, int direction) const {
    for (int step = 1; step <= kGrazingColumns; ++step) {
      const std::int32_t index = grid_.At(line, WrapFar(column + direction * step));
      if (index != TurnGrid::kNone) return index;
    }
    return TurnGrid::kNone;
  }

  void LinkGrazingAt(int line, int column) {
    const std::int32_t middle = grid_.At(line, column);
    const std::int32_t before = NextReturn(line, column, -1);
    const std::int32_t after = NextReturn(line, column, 1);
    if (before == TurnGrid::kNone || after == TurnGrid::kNone || before == after) return;
    if (sets_.Find(runs_.OfReturn(before)) == sets_.Find(runs_.OfReturn(middle)) &&
        sets_.Find(runs_.OfReturn(middle)) == sets_.Find(runs_.OfReturn(after)))
      return;
    const LevelPoint& at = grid_.PointOf(middle);
    const LevelPoint& from = grid_.PointOf(before);
    const LevelPoint& to = grid_.PointOf(after);
    const float in_x_m = at.x_m - from.x_m;
    const float in_y_m = at.y_m - from.y_m;
    const float out_x_m = to.x_m - at.x_m;
    const float out_y_m = to.y_m - at.y_m;
    const float in_m = std::sqrt(in_x_m * in_x_m + in_y_m * in_y_m);
    const float out_m = std::sqrt(out_x_m * out_x_m + out_y_m * out_y_m);
    const float least_m = std::min(in_m, out_m);
    const float greatest_m = std::max(in_m, out_m);
    const double spacing_m = grid_.column_step_rad() / kLeastGrazingSine * at.range_m;
    if (greatest_m > spacing_m || least_m <= 0.0F || greatest_m > kGreatestUnevenness * least_m) return;
    if (in_x_m * out_x_m + in_y_m * out_y_m <= 0.0F) return;
    const float off_m = std::abs(in_x_m * out_y_m - in_y_m * out_x_m) / greatest_m;
    if (off_m > kStraightShare * least_m + kStraightM) return;
    sets_.Join(runs_.OfReturn(before), runs_.OfReturn(middle));
    sets_.Join(runs_.OfReturn(middle), runs_.OfReturn(after));
  }

  const TurnGrid& grid_;
  const RunTable& runs_;
  const Reach& link_;
  UnionFind& sets_;
};

}  // namespace

void LinkRuns(const TurnGrid& grid, const RunTable& runs, const Reach& link, UnionFind& sets) {
  Linker linker(grid, runs, link, sets);
  for (int line = 0; line < grid.num_lines(); ++line) linker.LinkWithinLine(line);
  for (int line = 0; line < grid.num_lines(); ++line) {
    const int ring = grid.RingOf(line);
    const int end = std::min(grid.num_lines(), (ring + kLinkRings + 1) * grid.num_layers());
    const std::int32_t end_run = runs.FirstOfLine(line + 1);
    for (std::int32_t run = runs.FirstOfLine(line); run < end_run; ++run) {
      for (int other_line = line + 1; other_line < end; ++other_line) {
        if (grid.RingOf(other_line) == ring) {
          linker.LinkAcross<kLinkColumns>(run, other_line, true);
        } else {
          linker.LinkAcross<kLinkAcrossColumns>(run, other_line, false);
        }
      }
    }
  }
  for (std::int32_t run = 0; run < runs.size(); ++run) linker.LinkGrazing(run);
}

}  // namespace lookout::segmenter
