#include "services/segmenter/core/lookout/run_links.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace lookout::segmenter {

namespace {

// A wall seen along at 5.7 degrees or more (sine 0.1): its returns are ten times as far apart as those of one that faces the lidar.
constexpr double kLeastGrazingSine = 0.1;
constexpr float kGreatestUnevenness = 2.5F;  // of two spacings that follow each other
// Off the straight line: noise of the range, and some of the spacing.
constexpr float kStraightM = 0.04F;
constexpr float kStraightShare = 0.15F;

using Strand = RunLinker::Strand;

class Linker {
 public:
  Linker(const ScanGrid& grid, const RunTable& runs, const Reach& link, UnionFind& sets) : grid_(grid), runs_(runs), link_(link), sets_(sets) {}

  // @param in_line  scratch
  void LinkWithinLine(int line, std::vector<std::int32_t>& in_line) {
    in_line.clear();
    const std::int32_t end_run = runs_.FirstOfLine(line + 1);
    for (std::int32_t run = runs_.FirstOfLine(line); run < end_run; ++run) {
      if (runs_[run].length > 1 || !IsAloneInLine(runs_[run])) in_line.push_back(run);
    }
    ForEachFollowing(grid_, runs_, in_line, [this](std::int32_t one, std::int32_t other) { LinkEnds(one, other); });
  }

  // Only the ends of runs: inside, neighbours are linked already.
  void LinkGrazing(std::int32_t index) {
    const Run& run = runs_[index];
    LinkGrazingAt(run.line, run.first);
    if (run.length > 1) LinkGrazingAt(run.line, grid_.Wrap(run.first + run.length - 1));
  }

  bool IsAloneInLine(const Run& run) const {
    const float range_m = grid_.RangeAt(run.line, run.first);
    return grid_.NumNear<kLinkColumns>(run.line, run.first, range_m, WidestAt(range_m)) == 1;
  }

  // Whether a run of one return has none near it in the rings about: nothing there is linked to it.
  bool IsAlone(const Run& run, int ring) const {
    const float range_m = grid_.RangeAt(run.line, run.first);
    const float widest_m = WidestAt(range_m);
    const int first_of_ring = ring * grid_.num_layers();
    const int end_of_ring = first_of_ring + grid_.num_layers();
    for (int line = std::max(0, first_of_ring - kLinkRings * grid_.num_layers()); line < first_of_ring; ++line) {
      if (grid_.NumNear<kLinkAcrossColumns>(line, run.first, range_m, widest_m) > 0) return false;
    }
    for (int line = first_of_ring; line < end_of_ring; ++line) {
      if (line != run.line && grid_.NumNear<kLinkColumns>(line, run.first, range_m, widest_m) > 0) return false;
    }
    const int end = std::min(grid_.num_lines(), end_of_ring + kLinkRings * grid_.num_layers());
    for (int line = end_of_ring; line < end; ++line) {
      if (grid_.NumNear<kLinkAcrossColumns>(line, run.first, range_m, widest_m) > 0) return false;
    }
    return true;
  }

  // All of a line with all of another line of its ring (another return of the shot) or of another ring. kWindow columns aside.
  template <int kWindow>
  void LinkAcross(std::span<const Strand> strands, int line, std::span<const Strand> others, int other_line) {
    const int num_columns = grid_.num_columns();
    const Lines lines{line, other_line, kWindow == kLinkColumns};
    std::size_t next = 0;
    for (const Strand& strand : strands) {
      const int from = strand.first - kWindow;
      const int to = strand.end + kWindow;
      while (next < others.size() && others[next].end <= from) ++next;
      for (std::size_t i = next; i < others.size() && others[i].first < to; ++i) LinkStrands<kWindow>(strand, others[i], 0, lines);
      // Over the seam.
      for (std::size_t i = others.size(); i > 0 && others[i - 1].end - num_columns > from; --i) {
        LinkStrands<kWindow>(strand, others[i - 1], -num_columns, lines);
      }
      for (std::size_t i = 0; i < others.size() && others[i].first + num_columns < to; ++i) {
        LinkStrands<kWindow>(strand, others[i], num_columns, lines);
      }
    }
  }

  float WidestAt(float range_m) const { return WidestRange(link_.At(range_m), range_m); }

  std::pair<float, float> RangesOf(const Run& run) const {
    float min_m = grid_.RangeAt(run.line, run.first);
    float max_m = min_m;
    const auto look_at = [&](int from, int to) {
      for (int column = from; column < to; ++column) {
        min_m = std::min(min_m, grid_.RangeAt(run.line, column));
        max_m = std::max(max_m, grid_.RangeAt(run.line, column));
      }
    };
    const int end = run.first + run.length;
    look_at(run.first, std::min(end, grid_.num_columns()));
    look_at(0, end - grid_.num_columns());
    return {min_m, max_m};
  }

 private:
  struct Lines {
    int one = 0;
    int other = 0;
    bool are_of_one_ring = false;
  };

  // The columns of the other one are counted from `shift` on.
  template <int kWindow>
  void LinkStrands(const Strand& one, const Strand& other, int shift, const Lines& lines) {
    if (one.min_range_m > other.most_range_m || other.min_range_m > one.most_range_m) return;
    const auto are_joined = [&] { return sets_.Find(one.run) == sets_.Find(other.run); };
    if (are_joined()) return;
    const int end = std::min(one.end + kWindow, other.end + shift);
    for (int at = std::max(one.first - kWindow, other.first + shift); at < end; ++at) {
      const int column = WrapFar(at);
      const int next = grid_.NextOccupied(lines.other, column);
      at += next - column;
      if (at >= end) return;
      if (next == grid_.num_columns()) {
        --at;  // on at the other side of the seam
        continue;
      }
      const int from = std::max(at - kWindow, one.first);
      if (LinkReturn<kWindow>(lines, next, from, std::min(at + kWindow, one.end - 1)) && are_joined()) return;
    }
  }

  // The return of the other line in this column with those of the first line in columns [from, to]. @return whether there is any to join
  template <int kWindow>
  bool LinkReturn(const Lines& lines, int other_column, int from, int to) {
    const float other_range_m = grid_.RangeAt(lines.other, other_column);
    const float widest_m = WidestAt(other_range_m);
    const bool may_be_linked = from == to ? std::abs(grid_.RangeAt(lines.one, WrapFar(from)) - other_range_m) <= widest_m
                                          : grid_.NumNear<kWindow>(lines.one, other_column, other_range_m, widest_m) > 0;
    if (!may_be_linked) return false;
    const std::int32_t other = grid_.At(lines.other, other_column);
    for (int at = from; at <= to; ++at) {
      const int column = WrapFar(at);
      const std::int32_t one = grid_.At(lines.one, column);
      if (one == ScanGrid::kNone || !AreLinked(grid_.PointOf(one), grid_.PointOf(other), lines.are_of_one_ring)) continue;
      const std::int32_t run = runs_.OfReturn(one);
      if (!MayBeLinked(run, runs_.OfReturn(other))) continue;
      if (runs_[run].length == 1) {
        // A single return must have one of the other line near it in range, too, as ranges are rounded.
        const float range_m = grid_.RangeAt(lines.one, column);
        if (grid_.NumNear<kWindow>(lines.other, column, range_m, static_cast<float>(link_.At(range_m))) == 0) continue;
      }
      sets_.Join(run, runs_.OfReturn(other));
      return true;
    }
    return false;
  }

  bool MayBeLinked(std::int32_t run, std::int32_t other) const { return runs_[run].is_jetty == runs_[other].is_jetty; }

  bool AreLinked(const LevelPoint& one, const LevelPoint& other, bool is_of_one_ring) const {
    const double reach_m = link_.At(std::min(one.range_m, other.range_m));
    double squared_m2 = SquaredPlanDistance(one, other);
    if (is_of_one_ring) squared_m2 += double{one.height_m - other.height_m} * (one.height_m - other.height_m);
    return squared_m2 <= reach_m * reach_m;
  }

  int WrapFar(int column) const { return grid_.Wrap(grid_.Wrap(column)); }

  // The last columns of one with the first of the other that follows it.
  void LinkEnds(std::int32_t one, std::int32_t other) {
    if (sets_.Find(one) == sets_.Find(other) || !MayBeLinked(one, other)) return;
    const Run& before = runs_[one];
    const Run& after = runs_[other];
    int gap = after.first - (before.first + before.length - 1);
    while (gap <= 0) gap += grid_.num_columns();
    for (int back = 0; back < before.length && gap + back <= kLinkColumns; ++back) {
      const int from_column = grid_.Wrap(before.first + before.length - 1 - back);
      const float range_m = grid_.RangeAt(before.line, from_column);
      const float widest_m = WidestAt(range_m);
      for (int on = 0; on < after.length && gap + back + on <= kLinkColumns; ++on) {
        const int column = grid_.Wrap(after.first + on);
        if (!(std::abs(grid_.RangeAt(after.line, column) - range_m) <= widest_m)) continue;
        if (!AreLinked(grid_.PointOf(grid_.At(before.line, from_column)), grid_.PointOf(grid_.At(after.line, column)), true)) continue;
        sets_.Join(one, other);
        return;
      }
    }
  }

  void LinkGrazingAt(int line, int column) {
    const int last_column = grid_.Wrap(column - 1);
    const int next_column = grid_.Wrap(column + 1);
    const float range_m = grid_.RangeAt(line, column);
    const double spacing_m = grid_.column_step_rad() / kLeastGrazingSine * range_m;
    const float widest_m = WidestRange(spacing_m, range_m);
    if (!(std::abs(grid_.RangeAt(line, last_column) - range_m) <= widest_m && std::abs(grid_.RangeAt(line, next_column) - range_m) <= widest_m))
      return;
    const std::int32_t middle = grid_.At(line, column);
    const std::int32_t before = grid_.At(line, last_column);
    const std::int32_t after = grid_.At(line, next_column);
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
    if (greatest_m > spacing_m || least_m <= 0.0F || greatest_m > kGreatestUnevenness * least_m) return;
    if (in_x_m * out_x_m + in_y_m * out_y_m <= 0.0F) return;
    const float off_m = std::abs(in_x_m * out_y_m - in_y_m * out_x_m) / greatest_m;
    if (off_m > kStraightShare * least_m + kStraightM) return;
    for (const std::int32_t beside : {before, after}) {
      if (MayBeLinked(runs_.OfReturn(beside), runs_.OfReturn(middle))) sets_.Join(runs_.OfReturn(beside), runs_.OfReturn(middle));
    }
  }

  const ScanGrid& grid_;
  const RunTable& runs_;
  const Reach& link_;
  UnionFind& sets_;
};

}  // namespace

void RunLinker::FindStrands(const ScanGrid& grid, const RunTable& runs, const Reach& link, UnionFind& sets) {
  const Linker linker(grid, runs, link, sets);
  strands_.clear();
  begin_of_line_.clear();
  for (int line = 0; line < grid.num_lines(); ++line) {
    begin_of_line_.push_back(strands_.size());
    const int ring = grid.RingOf(line);
    const std::int32_t end_run = runs.FirstOfLine(line + 1);
    for (std::int32_t run = runs.FirstOfLine(line); run < end_run; ++run) {
      const Run& one = runs[run];
      if (one.length == 1 && linker.IsAlone(one, ring)) continue;
      const auto [min_m, max_m] = linker.RangesOf(one);
      const float most_m = max_m + linker.WidestAt(max_m);
      if (strands_.size() > begin_of_line_.back() && sets.Find(strands_.back().run) == sets.Find(run)) {
        Strand& strand = strands_.back();
        strand.end = one.first + one.length;
        strand.min_range_m = std::min(strand.min_range_m, min_m);
        strand.most_range_m = std::max(strand.most_range_m, most_m);
      } else {
        strands_.push_back({one.first, one.first + one.length, run, min_m, most_m});
      }
    }
  }
  begin_of_line_.push_back(strands_.size());
}

void RunLinker::Link(const ScanGrid& grid, const RunTable& runs, const Reach& link, UnionFind& sets) {
  Linker linker(grid, runs, link, sets);
  for (int line = 0; line < grid.num_lines(); ++line) linker.LinkWithinLine(line, in_line_);
  for (std::int32_t run = 0; run < runs.size(); ++run) linker.LinkGrazing(run);
  FindStrands(grid, runs, link, sets);
  const auto of_line = [this](int line) {
    const auto at = static_cast<std::size_t>(line);
    return std::span<const Strand>(strands_).subspan(begin_of_line_[at], begin_of_line_[at + 1] - begin_of_line_[at]);
  };
  for (int line = 0; line < grid.num_lines(); ++line) {
    const int ring = grid.RingOf(line);
    const int end = std::min(grid.num_lines(), (ring + kLinkRings + 1) * grid.num_layers());
    for (int other = line + 1; other < end; ++other) {
      if (grid.RingOf(other) == ring) {
        linker.LinkAcross<kLinkColumns>(of_line(line), line, of_line(other), other);
      } else {
        linker.LinkAcross<kLinkAcrossColumns>(of_line(line), line, of_line(other), other);
      }
    }
  }
}

}  // namespace lookout::segmenter
