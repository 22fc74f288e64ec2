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

void Add(const LevelPoint& point, PieceFacts& facts) {
  ++facts.num_returns;
  facts.sum_x_m += point.x_m;
  facts.sum_y_m += point.y_m;
  facts.sum_xx_m2 += double{point.x_m} * point.x_m;
  facts.sum_xy_m2 += double{point.x_m} * point.y_m;
  facts.sum_yy_m2 += double{point.y_m} * point.y_m;
  facts.min_range_m = std::min(facts.min_range_m, point.range_m);
  facts.max_range_m = std::max(facts.max_range_m, point.range_m);
  facts.max_height_m = std::max(facts.max_height_m, point.height_m);
}

void Add(const PieceFacts& other, PieceFacts& facts) {
  facts.num_returns += other.num_returns;
  facts.sum_x_m += other.sum_x_m;
  facts.sum_y_m += other.sum_y_m;
  facts.sum_xx_m2 += other.sum_xx_m2;
  facts.sum_xy_m2 += other.sum_xy_m2;
  facts.sum_yy_m2 += other.sum_yy_m2;
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

void PieceTable::Build(const TurnGrid& grid, const RunTable& runs, UnionFind& sets_of_runs) {
  const auto num_runs = static_cast<std::size_t>(runs.size());
  piece_of_run_.resize(num_runs);
  number_of_root_.assign(num_runs, kNone);
  facts_.clear();
  for (std::int32_t run = 0; run < runs.size(); ++run) {
    auto& number = number_of_root_[static_cast<std::size_t>(sets_of_runs.Find(run))];
    if (number == kNone) {
      number = size();
      facts_.push_back(NoFacts());
    }
    piece_of_run_[static_cast<std::size_t>(run)] = number;
    PieceFacts& facts = facts_[static_cast<std::size_t>(number)];
    const int ring = grid.RingOf(runs[run].line);
    facts.min_ring = std::min(facts.min_ring, ring);
    facts.max_ring = std::max(facts.max_ring, ring);
  }
  for (std::size_t i = 0; i < grid.points().size(); ++i) {
    const std::int32_t run = runs.OfReturn(static_cast<std::int32_t>(i));
    Add(grid.points()[i], facts_[static_cast<std::size_t>(OfRun(run))]);
  }

  begin_of_runs_.assign(facts_.size() + 1, 0);
  for (const std::int32_t piece : piece_of_run_) ++begin_of_runs_[static_cast<std::size_t>(piece) + 1];
  SumUp(begin_of_runs_);
  runs_of_piece_.resize(num_runs);
  cursor_.assign(begin_of_runs_.begin(), begin_of_runs_.end() - 1);
  for (std::int32_t run = 0; run < runs.size(); ++run) {
    runs_of_piece_[static_cast<std::size_t>(cursor_[static_cast<std::size_t>(OfRun(run))]++)] = run;
  }

  sets_.Reset(facts_.size());
  next_member_.assign(facts_.size(), kNone);
  last_member_.resize(facts_.size());
  arcs_.resize(facts_.size());
  roots_.resize(facts_.size());
  root_of_piece_.resize(facts_.size());
  for (std::int32_t piece = 0; piece < size(); ++piece) {
    const auto at = static_cast<std::size_t>(piece);
    roots_[at] = last_member_[at] = root_of_piece_[at] = piece;
    to_cover_.clear();
    for (const std::int32_t run : Part(runs_of_piece_, begin_of_runs_, piece)) to_cover_.push_back({runs[run].first, runs[run].length});
    arcs_[at] = facts_[at].arc = CoveringArc(grid.num_columns());
  }
  joins_.clear();
  new_land_.clear();
  BuildOutlines(grid, runs);
  for (std::int32_t piece = 0; piece < size(); ++piece) FitLine(piece);
}

void PieceTable::BuildOutlines(const TurnGrid& grid, const RunTable& runs) {
  entries_.clear();
  begin_of_column_.assign(1, 0);
  begin_of_piece_.assign(facts_.size() + 1, 0);
  last_entry_.assign(facts_.size(), kNone);
  const auto by_column = grid.by_column();
  std::size_t i = 0;
  for (int column = 0; column < grid.num_columns(); ++column) {
    const auto first_of_column = static_cast<std::int32_t>(entries_.size());
    for (; i < by_column.size() && grid.ColumnOf(by_column[i]) == column; ++i) {
      const std::int32_t index = by_column[i];
      const std::int32_t piece = OfRun(runs.OfReturn(index));
      auto& last = last_entry_[static_cast<std::size_t>(piece)];
      if (last < first_of_column) {
        last = static_cast<std::int32_t>(entries_.size());
        entries_.push_back({piece, column, index, grid.PointOf(index), grid.PointOf(index)});
        ++begin_of_piece_[static_cast<std::size_t>(piece) + 1];
        continue;
      }
      OutlineEntry& entry = entries_[static_cast<std::size_t>(last)];
      const LevelPoint& point = grid.PointOf(index);
      if (point.range_m < entry.near_point.range_m) {
        entry.nearest = index;
        entry.near_point = point;
      }
      if (point.range_m > entry.far_point.range_m) entry.far_point = point;
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

void PieceTable::FitLine(std::int32_t root) {
  PieceFacts& facts = facts_[static_cast<std::size_t>(root)];
  const double count = facts.num_returns;
  facts.mean_m = {facts.sum_x_m / count, facts.sum_y_m / count};
  if (facts.num_returns == 1) return;  // a drop: no line, no length
  const double xx_m2 = facts.sum_xx_m2 / count - facts.mean_m.x() * facts.mean_m.x();
  const double xy_m2 = facts.sum_xy_m2 / count - facts.mean_m.x() * facts.mean_m.y();
  const double yy_m2 = facts.sum_yy_m2 / count - facts.mean_m.y() * facts.mean_m.y();
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
  end -= num_columns;  // where the last one ends, a turn before: so the gap over the seam is one like the others
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

bool PieceTable::Settle(const TurnGrid& grid) {
  bool is_changed = false;
  for (const std::int32_t piece : new_land_) {
    bool& is_land = facts_[static_cast<std::size_t>(RootOf(piece))].is_land;
    is_changed = is_changed || !is_land;
    is_land = true;
  }
  new_land_.clear();
  has_changed_.assign(facts_.size(), false);
  bool is_joined = false;
  for (const auto& [one, other] : joins_) {
    const std::int32_t a = sets_.Find(one);
    const std::int32_t b = sets_.Find(other);
    if (!sets_.Join(a, b)) continue;
    const auto root = static_cast<std::size_t>(std::min(a, b));
    const auto joined = static_cast<std::size_t>(std::max(a, b));
    Add(facts_[joined], facts_[root]);
    next_member_[static_cast<std::size_t>(last_member_[root])] = static_cast<std::int32_t>(joined);
    last_member_[root] = last_member_[joined];
    has_changed_[root] = is_joined = true;
  }
  joins_.clear();
  if (!is_joined) return is_changed;
  for (std::int32_t piece = 0; piece < size(); ++piece) root_of_piece_[static_cast<std::size_t>(piece)] = sets_.Find(piece);
  std::erase_if(roots_, [this](std::int32_t root) { return RootOf(root) != root; });
  for (const std::int32_t root : roots_) {
    if (!has_changed_[static_cast<std::size_t>(root)]) continue;
    to_cover_.clear();
    for (std::int32_t piece = root; piece != kNone; piece = NextMember(piece)) to_cover_.push_back(arcs_[static_cast<std::size_t>(piece)]);
    facts_[static_cast<std::size_t>(root)].arc = CoveringArc(grid.num_columns());
    FitLine(root);
  }
  return true;
}

int SharedColumns(const Arc& one, const Arc& other, int num_columns) {
  int on = other.first - one.first;
  if (on < 0) on += num_columns;
  if (on < one.num) return std::min(one.num - on, other.num);
  const int back = num_columns - on;
  return back < other.num ? std::min(other.num - back, one.num) : 0;
}

double PlanGap(const TurnGrid& grid, const PieceTable& pieces, std::int32_t one, std::int32_t other, double limit_m) {
  if (pieces.OutlineOf(one).size() > pieces.OutlineOf(other).size()) std::swap(one, other);
  const auto inner = pieces.OutlineOf(other);
  const auto first_column = pieces.Entry(inner.front()).column;
  const auto last_column = pieces.Entry(inner.back()).column;
  auto least_m2 = static_cast<float>(limit_m * limit_m);
  bool is_within = false;
  const auto look_at = [&](const OutlineEntry& entry, std::int32_t from, std::int32_t to) {  // columns
    if (to < first_column || from > last_column) return;
    const auto begin = std::ranges::lower_bound(inner, from, {}, [&](std::int32_t index) { return pieces.Entry(index).column; });
    for (auto at = begin; at != inner.end(); ++at) {
      const OutlineEntry& facing = pieces.Entry(*at);
      if (facing.column > to) break;
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
