#include "services/segmenter/core/lookout/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lookout::segmenter {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

PieceFacts NoFacts() {
  PieceFacts facts;
  facts.min_range_m = kInfinity;
  facts.max_range_m = facts.max_height_m = -kInfinity;
  facts.min_ring = std::numeric_limits<std::int32_t>::max();
  facts.max_ring = -1;
  return facts;
}

void Add(const PieceFacts& other, PieceFacts& facts) {
  facts.num_returns += other.num_returns;
  facts.min_range_m = std::min(facts.min_range_m, other.min_range_m);
  facts.max_range_m = std::max(facts.max_range_m, other.max_range_m);
  facts.max_height_m = std::max(facts.max_height_m, other.max_height_m);
  facts.min_ring = std::min(facts.min_ring, other.min_ring);
  facts.max_ring = std::max(facts.max_ring, other.max_ring);
  facts.is_land = facts.is_land || other.is_land;
  facts.is_dock = facts.is_dock || other.is_dock;
}

// Begins out of counts: counts stand one place on.
void SumUp(std::vector<std::int32_t>& counts) {
  for (std::size_t i = 1; i < counts.size(); ++i) counts[i] += counts[i - 1];
}

}  // namespace

void PieceTable::Build(const ScanGrid& grid, const RunTable& runs, UnionFind& sets_of_runs) {
  NumberPieces(grid, runs, sets_of_runs);
  SumReturns(grid, runs);
  BuildOutlines(grid);
  FindArcs(runs, grid.num_columns());

  sets_.Reset(facts_.size());
  next_member_.assign(facts_.size(), kNone);
  last_member_.resize(facts_.size());
  roots_.resize(facts_.size());
  root_of_piece_.resize(facts_.size());
  for (std::int32_t piece = 0; piece < size(); ++piece) {
    const auto at = static_cast<std::size_t>(piece);
    roots_[at] = last_member_[at] = root_of_piece_[at] = piece;
    FitLine(piece);
  }
  joins_.clear();
  new_land_.clear();
}

void PieceTable::NumberPieces(const ScanGrid& grid, const RunTable& runs, UnionFind& sets_of_runs) {
  const auto num_runs = static_cast<std::size_t>(runs.size());
  piece_of_run_.resize(num_runs);
  number_of_root_.assign(num_runs, kNone);
  facts_.clear();
  for (int line = 0; line < grid.num_lines(); ++line) {
    const int ring = grid.RingOf(line);
    const std::int32_t end = runs.FirstOfLine(line + 1);
    for (std::int32_t run = runs.FirstOfLine(line); run < end; ++run) {
      auto& number = number_of_root_[static_cast<std::size_t>(sets_of_runs.Find(run))];
      if (number == kNone) {
        number = size();
        facts_.push_back(NoFacts());
      }
      piece_of_run_[static_cast<std::size_t>(run)] = number;
      PieceFacts& facts = facts_[static_cast<std::size_t>(number)];
      facts.min_ring = std::min(facts.min_ring, ring);
      facts.max_ring = std::max(facts.max_ring, ring);
    }
  }
}

void PieceTable::SumReturns(const ScanGrid& grid, const RunTable& runs) {
  const auto points = grid.points();
  piece_of_return_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) piece_of_return_[i] = OfRun(runs.OfReturn(static_cast<std::int32_t>(i)));
  sums_.assign(facts_.size(), {});
  for (std::size_t i = 0; i < points.size();) {
    // Returns that follow each other are of one piece in most cases.
    const std::int32_t piece = piece_of_return_[i];
    PieceFacts& facts = facts_[static_cast<std::size_t>(piece)];
    Sums sums = sums_[static_cast<std::size_t>(piece)];
    float min_range_m = facts.min_range_m;
    float max_range_m = facts.max_range_m;
    float max_height_m = facts.max_height_m;
    const std::size_t first = i;
    for (; i < points.size() && piece_of_return_[i] == piece; ++i) {
      const LevelPoint& point = points[i];
      sums.x_m += point.x_m;
      sums.y_m += point.y_m;
      sums.xx_m2 += double{point.x_m} * point.x_m;
      sums.xy_m2 += double{point.x_m} * point.y_m;
      sums.yy_m2 += double{point.y_m} * point.y_m;
      min_range_m = std::min(min_range_m, point.range_m);
      max_range_m = std::max(max_range_m, point.range_m);
      max_height_m = std::max(max_height_m, point.height_m);
    }
    facts.num_returns += static_cast<std::int32_t>(i - first);
    facts.min_range_m = min_range_m;
    facts.max_range_m = max_range_m;
    facts.max_height_m = max_height_m;
    sums_[static_cast<std::size_t>(piece)] = sums;
  }
}

void PieceTable::BuildOutlines(const ScanGrid& grid) {
  entries_.clear();
  begin_of_column_.assign(1, 0);
  begin_of_piece_.assign(facts_.size() + 1, 0);
  last_entry_.assign(facts_.size(), kNone);
  gaps_.assign(facts_.size(), {});
  const auto by_column = grid.by_column();
  std::size_t i = 0;
  for (int column = 0; column < grid.num_columns(); ++column) {
    const auto first_of_column = static_cast<std::int32_t>(entries_.size());
    while (i < by_column.size() && grid.ColumnOf(by_column[i]) == column) {
      // Returns that follow each other are of one piece in most cases. Of equal ones the first.
      const std::int32_t piece = piece_of_return_[static_cast<std::size_t>(by_column[i])];
      std::int32_t nearest = by_column[i];
      std::int32_t farthest = nearest;
      float near_m = grid.PointOf(nearest).range_m;
      float far_m = near_m;
      for (++i; i < by_column.size() && grid.ColumnOf(by_column[i]) == column; ++i) {
        const std::int32_t index = by_column[i];
        if (piece_of_return_[static_cast<std::size_t>(index)] != piece) break;
        const float range_m = grid.PointOf(index).range_m;
        nearest = range_m < near_m ? index : nearest;
        near_m = range_m < near_m ? range_m : near_m;
        farthest = range_m > far_m ? index : farthest;
        far_m = range_m > far_m ? range_m : far_m;
      }
      AddToOutline(piece, column, first_of_column, nearest, farthest, grid);
    }
    begin_of_column_.push_back(static_cast<std::int32_t>(entries_.size()));
  }
  SumUp(begin_of_piece_);
  entries_of_piece_.resize(entries_.size());
  cursor_.assign(begin_of_piece_.begin(), begin_of_piece_.end() - 1);
  for (std::size_t entry = 0; entry < entries_.size(); ++entry) {
    entries_of_piece_[static_cast<std::size_t>(cursor_[static_cast<std::size_t>(entries_[entry].piece)]++)] = static_cast<std::int32_t>(entry);
  }
}

void PieceTable::AddToOutline(std::int32_t piece, std::int32_t column, std::int32_t first_of_column, std::int32_t nearest, std::int32_t farthest,
                              const ScanGrid& grid) {
  const auto at = static_cast<std::size_t>(piece);
  const LevelPoint& near_point = grid.PointOf(nearest);
  const LevelPoint& far_point = grid.PointOf(farthest);
  const std::int32_t last = last_entry_[at];
  if (last >= first_of_column) {
    OutlineEntry& entry = entries_[static_cast<std::size_t>(last)];
    if (near_point.range_m < entry.near_point.range_m) {
      entry.nearest = nearest;
      entry.near_point = near_point;
    }
    if (far_point.range_m > entry.far_point.range_m) entry.far_point = far_point;
    return;
  }
  Gap& gap = gaps_[at];
  if (last == kNone) {
    gap.first_column = column;
  } else if (const std::int32_t free = column - entries_[static_cast<std::size_t>(last)].column - 1; free > gap.widest) {
    gap.widest = free;
    gap.after_widest = column;
  }
  last_entry_[at] = static_cast<std::int32_t>(entries_.size());
  entries_.push_back({piece, column, nearest, near_point, far_point});
  ++begin_of_piece_[at + 1];
}

// The circle without the widest gap between the columns of a piece; of equal gaps that over the seam, else the first.
void PieceTable::FindArcs(const RunTable& runs, int num_columns) {
  arcs_.resize(facts_.size());
  bool is_any_closed = false;
  for (std::size_t piece = 0; piece < facts_.size(); ++piece) {
    const Gap& gap = gaps_[piece];
    const std::int32_t last_column = entries_[static_cast<std::size_t>(last_entry_[piece])].column;
    const std::int32_t over_seam = gap.first_column + num_columns - last_column - 1;
    const bool is_seam_widest = over_seam >= gap.widest;
    arcs_[piece] = {is_seam_widest ? gap.first_column : gap.after_widest, num_columns - std::max(over_seam, gap.widest)};
    is_any_closed = is_any_closed || arcs_[piece].num == num_columns;
  }
  if (is_any_closed) {
    // What goes all the way round begins with the first of its runs.
    for (std::size_t piece = 0; piece < facts_.size(); ++piece) {
      if (arcs_[piece].num == num_columns) arcs_[piece].first = num_columns;
    }
    for (std::int32_t run = 0; run < runs.size(); ++run) {
      Arc& arc = arcs_[static_cast<std::size_t>(OfRun(run))];
      if (arc.num == num_columns) arc.first = std::min(arc.first, runs[run].first);
    }
  }
  for (std::size_t piece = 0; piece < facts_.size(); ++piece) facts_[piece].arc = arcs_[piece];
}

void PieceTable::FitLine(std::int32_t root) {
  PieceFacts& facts = facts_[static_cast<std::size_t>(root)];
  const Sums& sums = sums_[static_cast<std::size_t>(root)];
  if (facts.num_returns == 1) {  // a drop: no line, no length
    facts.mean_m = {sums.x_m, sums.y_m};
    return;
  }
  const double count = facts.num_returns;
  facts.mean_m = {sums.x_m / count, sums.y_m / count};
  const double xx_m2 = sums.xx_m2 / count - facts.mean_m.x() * facts.mean_m.x();
  const double xy_m2 = sums.xy_m2 / count - facts.mean_m.x() * facts.mean_m.y();
  const double yy_m2 = sums.yy_m2 / count - facts.mean_m.y() * facts.mean_m.y();
  const double half_difference_m2 = (xx_m2 - yy_m2) / 2.0;
  const double radius_m2 = std::sqrt(half_difference_m2 * half_difference_m2 + xy_m2 * xy_m2);
  // Half of the angle whose cosine is half_difference / radius.
  const double cosine = radius_m2 > 0.0 ? half_difference_m2 / radius_m2 : 1.0;
  facts.direction = {std::sqrt((1.0 + cosine) / 2.0), std::copysign(std::sqrt(std::max(0.0, 1.0 - cosine) / 2.0), xy_m2)};
  facts.off_m = std::sqrt(std::max(0.0, (xx_m2 + yy_m2) / 2.0 - radius_m2));
  double least_m = std::numeric_limits<double>::infinity();
  double greatest_m = -least_m;
  double radius_of_m2 = 0.0;
  for (std::int32_t piece = root; piece != kNone; piece = NextMember(piece)) {
    for (const std::int32_t index : OutlineOf(piece)) {
      const OutlineEntry& entry = Entry(index);
      for (const LevelPoint* point : {&entry.near_point, &entry.far_point}) {
        const Eigen::Vector2d from_mean_m = Eigen::Vector2d(point->x_m, point->y_m) - facts.mean_m;
        const double along_m = from_mean_m.dot(facts.direction);
        least_m = std::min(least_m, along_m);
        greatest_m = std::max(greatest_m, along_m);
        radius_of_m2 = std::max(radius_of_m2, from_mean_m.squaredNorm());
      }
    }
  }
  facts.length_m = greatest_m - least_m;
  facts.radius_m = std::sqrt(radius_of_m2);
}

// The least arc that holds all of to_cover_: the circle without the widest gap between them.
Arc PieceTable::CoveringArc(int num_columns) {
  if (to_cover_.size() == 1) return to_cover_.front();
  std::ranges::sort(to_cover_, {}, &Arc::first);
  int end = 0;
  for (const Arc& arc : to_cover_) end = std::max(end, arc.first + arc.num);
  end -= num_columns;  // where the last one ends, a revolution earlier: so the gap over the seam is like the others
  int widest = 0;
  int after_widest = to_cover_.front().first;
  for (const Arc& arc : to_cover_) {
    if (arc.first - end > widest) {
      widest = arc.first - end;
      after_widest = arc.first;
    }
    end = std::max(end, arc.first + arc.num);
  }
  return {after_widest, num_columns - widest};
}

bool PieceTable::Settle(const ScanGrid& grid) {
  bool is_changed = false;
  for (const std::int32_t piece : new_land_) {
    bool& is_land = facts_[static_cast<std::size_t>(RootOf(piece))].is_land;
    is_changed = is_changed || !is_land;
    is_land = true;
  }
  new_land_.clear();
  changed_.clear();
  for (const auto& [one, other] : joins_) {
    const std::int32_t a = sets_.Find(one);
    const std::int32_t b = sets_.Find(other);
    if (!sets_.Join(a, b)) continue;
    const auto root = static_cast<std::size_t>(std::min(a, b));
    const auto joined = static_cast<std::size_t>(std::max(a, b));
    Add(facts_[joined], facts_[root]);
    sums_[root].x_m += sums_[joined].x_m;
    sums_[root].y_m += sums_[joined].y_m;
    sums_[root].xx_m2 += sums_[joined].xx_m2;
    sums_[root].xy_m2 += sums_[joined].xy_m2;
    sums_[root].yy_m2 += sums_[joined].yy_m2;
    next_member_[static_cast<std::size_t>(last_member_[root])] = static_cast<std::int32_t>(joined);
    last_member_[root] = last_member_[joined];
    changed_.push_back(static_cast<std::int32_t>(root));
  }
  joins_.clear();
  if (changed_.empty()) return is_changed;
  std::ranges::sort(changed_);
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  for (const std::int32_t root : changed_) {
    if (sets_.Find(root) != root) continue;
    to_cover_.clear();
    for (std::int32_t piece = root; piece != kNone; piece = NextMember(piece)) {
      root_of_piece_[static_cast<std::size_t>(piece)] = root;
      to_cover_.push_back(arcs_[static_cast<std::size_t>(piece)]);
    }
    facts_[static_cast<std::size_t>(root)].arc = CoveringArc(grid.num_columns());
    FitLine(root);
  }
  std::erase_if(roots_, [this](std::int32_t root) { return RootOf(root) != root; });
  return true;
}

int SharedColumns(const Arc& one, const Arc& other, int num_columns) {
  int on = other.first - one.first;
  if (on < 0) on += num_columns;
  if (on < one.num) return std::min(one.num - on, other.num);
  const int back = num_columns - on;
  return back < other.num ? std::min(other.num - back, one.num) : 0;
}

double PlanGap(const ScanGrid& grid, const PieceTable& pieces, std::int32_t one, std::int32_t other, double limit_m) {
  if (pieces.OutlineOf(one).size() > pieces.OutlineOf(other).size()) std::swap(one, other);
  const auto inner = pieces.OutlineOf(other);
  const auto first_column = pieces.Entry(inner.front()).column;
  const auto last_column = pieces.Entry(inner.back()).column;
  auto least_m2 = static_cast<float>(limit_m * limit_m);
  bool is_within = false;
  const auto look_at = [&](const OutlineEntry& entry, std::int32_t from, std::int32_t to) {  // columns
    if (to < first_column || from > last_column) return;
    const auto begin = from <= first_column
                           ? inner.begin()
                           : std::ranges::lower_bound(inner, from, {}, [&](std::int32_t index) { return pieces.Entry(index).column; });
    // What is farther apart in range is farther apart.
    const float least_m = entry.near_point.range_m - WidestRange(limit_m, entry.near_point.range_m);
    const float greatest_m = entry.far_point.range_m + WidestRange(limit_m, entry.far_point.range_m);
    for (auto at = begin; at != inner.end(); ++at) {
      const OutlineEntry& facing = pieces.Entry(*at);
      if (facing.column > to) break;
      if (facing.near_point.range_m > greatest_m || facing.far_point.range_m < least_m) continue;
      const float distance_m2 =
          std::min(std::min(SquaredPlanDistance(entry.near_point, facing.near_point), SquaredPlanDistance(entry.near_point, facing.far_point)),
                   std::min(SquaredPlanDistance(entry.far_point, facing.near_point), SquaredPlanDistance(entry.far_point, facing.far_point)));
      if (distance_m2 > least_m2) continue;
      least_m2 = distance_m2;
      is_within = true;
    }
  };
  constexpr std::size_t kFewPairs = 256;  // fewer than it takes to find out which entries lie within reach
  if (pieces.OutlineOf(one).size() * inner.size() <= kFewPairs) {
    for (const std::int32_t index : pieces.OutlineOf(one)) look_at(pieces.Entry(index), first_column, last_column);
    return is_within ? std::sqrt(double{least_m2}) : std::numeric_limits<double>::infinity();
  }
  for (const std::int32_t index : pieces.OutlineOf(one)) {
    const OutlineEntry& entry = pieces.Entry(index);
    const int window = grid.ColumnsOf(limit_m, entry.near_point.range_m);
    const int from = entry.column - window;
    const int to = entry.column + window;
    look_at(entry, std::max(0, from), std::min(to, grid.num_columns() - 1));
    if (from < 0) look_at(entry, from + grid.num_columns(), grid.num_columns() - 1);
    if (to >= grid.num_columns()) look_at(entry, 0, to - grid.num_columns());
  }
  return is_within ? std::sqrt(double{least_m2}) : std::numeric_limits<double>::infinity();
}

}  // namespace lookout::segmenter
