#include "services/segmenter/core/lookout/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace lookout::segmenter {

namespace {

// A smaller difference is rounding of coordinates: half of the resolution of a VLP-16.
constexpr double kLeastLineM = 1e-3;
constexpr std::int32_t kNoPiece = -1;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

PieceFacts NoFacts() {
  PieceFacts facts;
  facts.min_range_m = facts.min_height_m = kInfinity;
  facts.max_range_m = facts.max_height_m = -kInfinity;
  facts.min_ring = std::numeric_limits<std::int32_t>::max();
  facts.max_ring = -1;
  return facts;
}

}  // namespace

int SharedColumns(const Arc& one, const Arc& other, int num_columns) {
  int on = other.first - one.first;
  if (on < 0) on += num_columns;
  // From its begin to the begin of the first, and from there on.
  const int end = on + other.num;
  return std::max(0, std::min(one.num, end) - on) + std::max(0, std::min(one.num, end - num_columns));
}

void PieceTable::Build(const ScanGrid& grid, std::span<const std::int32_t> piece_of_return, std::int32_t count) {
  piece_of_return_.assign(piece_of_return.begin(), piece_of_return.end());
  facts_.assign(static_cast<std::size_t>(count), NoFacts());
  is_new_.assign(facts_.size(), 1);
  SumReturns(grid);
  BuildOutlines(grid);
  FindRuns(grid);
  Measure(grid);
}

void PieceTable::Merge(const ScanGrid& grid, std::span<const std::int32_t> group_of_piece, std::int32_t count) {
  if (count == size()) return;  // each piece is a group
  for (std::int32_t& piece : piece_of_return_) piece = piece == kNoPiece ? kNoPiece : group_of_piece[static_cast<std::size_t>(piece)];
  for (Run& run : runs_) run.piece = group_of_piece[static_cast<std::size_t>(run.piece)];
  MergeFacts(group_of_piece, count);
  MergeOutlines(group_of_piece);
  Measure(grid);
}

void PieceTable::Measure(const ScanGrid& grid) {
  FindArcs(grid.num_columns());
  CountBeams(grid.num_columns());
  FitLines(grid.column_step_rad());
}

void PieceTable::SumReturns(const ScanGrid& grid) {
  const auto points = grid.points();
  sums_.assign(facts_.size(), {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (piece_of_return_[i] == kNoPiece) continue;
    const LevelPoint& point = points[i];
    const auto piece = static_cast<std::size_t>(piece_of_return_[i]);
    const std::int32_t ring = grid.RingOf(grid.LineOf(static_cast<std::int32_t>(i)));
    Sums& sums = sums_[piece];
    sums.x_m += point.x_m;
    sums.y_m += point.y_m;
    sums.height_m += point.height_m;
    sums.xx_m2 += double{point.x_m} * point.x_m;
    sums.xy_m2 += double{point.x_m} * point.y_m;
    sums.yy_m2 += double{point.y_m} * point.y_m;
    PieceFacts& facts = facts_[piece];
    ++facts.num_returns;
    facts.weight += grid.WeightOfRing(ring);
    facts.min_range_m = std::min(facts.min_range_m, point.range_m);
    facts.max_range_m = std::max(facts.max_range_m, point.range_m);
    facts.min_height_m = std::min(facts.min_height_m, point.height_m);
    facts.max_height_m = std::max(facts.max_height_m, point.height_m);
    facts.min_ring = std::min(facts.min_ring, ring);
    facts.max_ring = std::max(facts.max_ring, ring);
  }
}

// The entry of a piece among those that follow each other; nullptr = it has none.
OutlineEntry* PieceTable::EntryOf(std::int32_t piece, std::size_t first_of_column, std::size_t end) {
  for (std::size_t at = end; at > first_of_column; --at) {
    if (entries_[at - 1].piece == piece) return &entries_[at - 1];
  }
  return nullptr;
}

void PieceTable::SortColumn(std::size_t first, std::size_t end) {
  std::ranges::sort(std::span(entries_).subspan(first, end - first), [](const OutlineEntry& one, const OutlineEntry& other) {
    return one.near_point.range_m < other.near_point.range_m || (one.near_point.range_m == other.near_point.range_m && one.min_ring < other.min_ring);
  });
}

void PieceTable::BuildOutlines(const ScanGrid& grid) {
  entries_.clear();
  begin_of_column_.assign(1, 0);
  const auto by_column = grid.by_column();
  std::size_t i = 0;
  for (int column = 0; column < grid.num_columns(); ++column) {
    const std::size_t first_of_column = entries_.size();
    for (; i < by_column.size() && grid.ColumnOf(by_column[i]) == column; ++i) {
      const std::int32_t index = by_column[i];
      const LevelPoint& point = grid.PointOf(index);
      const std::int32_t ring = grid.RingOf(grid.LineOf(index));
      const std::int32_t piece = piece_of_return_[static_cast<std::size_t>(index)];
      if (piece == kNoPiece) continue;
      OutlineEntry* const entry = EntryOf(piece, first_of_column, entries_.size());
      if (entry == nullptr) {
        entries_.push_back({piece, column, index, index, ring, ring, point.height_m, point.height_m, point, point});
        continue;
      }
      if (point.range_m < entry->near_point.range_m) {  // of equals the first
        entry->nearest = index;
        entry->near_point = point;
      }
      if (point.range_m > entry->far_point.range_m) {
        entry->farthest = index;
        entry->far_point = point;
      }
      entry->min_ring = std::min(entry->min_ring, ring);
      entry->max_ring = std::max(entry->max_ring, ring);
      entry->min_height_m = std::min(entry->min_height_m, point.height_m);
      entry->max_height_m = std::max(entry->max_height_m, point.height_m);
    }
    SortColumn(first_of_column, entries_.size());
    begin_of_column_.push_back(entries_.size());
  }
}

void PieceTable::FindRuns(const ScanGrid& grid) {
  runs_.clear();
  for (int line = 0; line < grid.num_lines(); ++line) {
    for (int column = grid.NextOccupied(line, 0); column < grid.num_columns();
         column = column + 1 < grid.num_columns() ? grid.NextOccupied(line, column + 1) : grid.num_columns()) {
      const std::int32_t piece = piece_of_return_[static_cast<std::size_t>(grid.At(line, column))];
      if (piece == kNoPiece) continue;
      if (!runs_.empty() && runs_.back().line == line && runs_.back().piece == piece && runs_.back().last == column - 1) {
        runs_.back().last = column;
      } else {
        runs_.push_back({line, column, column, piece});
      }
    }
  }
}

// In place: a group's number is at most that of its first piece.
void PieceTable::MergeFacts(std::span<const std::int32_t> group_of_piece, std::int32_t count) {
  is_new_.assign(static_cast<std::size_t>(count), 0);
  std::size_t num_groups = 0;
  for (std::size_t piece = 0; piece < group_of_piece.size(); ++piece) {
    const auto group = static_cast<std::size_t>(group_of_piece[piece]);
    if (group == num_groups) {
      facts_[group] = facts_[piece];
      sums_[group] = sums_[piece];
      ++num_groups;
      continue;
    }
    is_new_[group] = 1;
    PieceFacts& facts = facts_[group];
    const PieceFacts& other = facts_[piece];
    facts.num_returns += other.num_returns;
    facts.weight += other.weight;
    facts.min_range_m = std::min(facts.min_range_m, other.min_range_m);
    facts.max_range_m = std::max(facts.max_range_m, other.max_range_m);
    facts.min_height_m = std::min(facts.min_height_m, other.min_height_m);
    facts.max_height_m = std::max(facts.max_height_m, other.max_height_m);
    facts.min_ring = std::min(facts.min_ring, other.min_ring);
    facts.max_ring = std::max(facts.max_ring, other.max_ring);
    Sums& sums = sums_[group];
    const Sums& of_other = sums_[piece];
    sums.x_m += of_other.x_m;
    sums.y_m += of_other.y_m;
    sums.height_m += of_other.height_m;
    sums.xx_m2 += of_other.xx_m2;
    sums.xy_m2 += of_other.xy_m2;
    sums.yy_m2 += of_other.yy_m2;
  }
  facts_.resize(static_cast<std::size_t>(count));
  sums_.resize(static_cast<std::size_t>(count));
}

void PieceTable::MergeOutlines(std::span<const std::int32_t> group_of_piece) {
  std::size_t num = 0;  // merged entries stand before the others
  std::size_t i = 0;
  for (std::size_t column = 0; column + 1 < begin_of_column_.size(); ++column) {
    const std::size_t first_of_column = num;
    bool has_new = false;
    for (; i < begin_of_column_[column + 1]; ++i) {
      OutlineEntry other = entries_[i];
      other.piece = group_of_piece[static_cast<std::size_t>(other.piece)];
      const bool is_new = is_new_[static_cast<std::size_t>(other.piece)] != 0;
      has_new = has_new || is_new;
      OutlineEntry* const entry = is_new ? EntryOf(other.piece, first_of_column, num) : nullptr;
      if (entry == nullptr) {
        entries_[num++] = other;
        continue;
      }
      // Of equals the first, as in the order of the returns.
      const float nearer_m = other.near_point.range_m - entry->near_point.range_m;
      if (nearer_m < 0.0F || (nearer_m == 0.0F && other.nearest < entry->nearest)) {
        entry->nearest = other.nearest;
        entry->near_point = other.near_point;
      }
      const float farther_m = other.far_point.range_m - entry->far_point.range_m;
      if (farther_m > 0.0F || (farther_m == 0.0F && other.farthest < entry->farthest)) {
        entry->farthest = other.farthest;
        entry->far_point = other.far_point;
      }
      entry->min_ring = std::min(entry->min_ring, other.min_ring);
      entry->max_ring = std::max(entry->max_ring, other.max_ring);
      entry->min_height_m = std::min(entry->min_height_m, other.min_height_m);
      entry->max_height_m = std::max(entry->max_height_m, other.max_height_m);
    }
    begin_of_column_[column] = first_of_column;
    if (has_new) SortColumn(first_of_column, num);
  }
  begin_of_column_.back() = num;
  entries_.resize(num);
}

// Arc of a piece: the circle minus the widest gap between its columns. Of equal gaps it is the one with the farther ends, so that neither the start
// of the scan nor mirroring matters. Where the ends are equal to the bit too, it is the first: in a ring that looks the same all round no rule could
// tell.
void PieceTable::FindArcs(int num_columns) {
  columns_.assign(facts_.size(), {});
  for (const OutlineEntry& entry : entries_) {
    const auto piece = static_cast<std::size_t>(entry.piece);
    if (is_new_[piece] == 0) continue;
    Columns& columns = columns_[piece];
    ++columns.num;
    if (columns.first < 0) {
      columns.first = entry.column;
      columns.first_m = entry.near_point.range_m;
    } else {
      WidenGap(columns, entry.column, entry.column, entry.near_point.range_m);
    }
    columns.last = entry.column;
    columns.last_m = entry.near_point.range_m;
  }
  for (std::size_t piece = 0; piece < facts_.size(); ++piece) {
    if (is_new_[piece] == 0) continue;
    Columns& columns = columns_[piece];
    WidenGap(columns, columns.first + num_columns, columns.first, columns.first_m);  // over the seam
    facts_[piece].num_columns = columns.num;
    facts_[piece].arc = {columns.widest.after, num_columns - columns.widest.num};
  }
}

// @param column  that of `after`, counted on over the seam
void PieceTable::WidenGap(Columns& columns, std::int32_t column, std::int32_t after, float range_m) {
  Gap& widest = columns.widest;
  const Gap gap{column - columns.last - 1, std::min(columns.last_m, range_m), std::max(columns.last_m, range_m), after};
  if (std::tie(gap.num, gap.nearer_end_m, gap.farther_end_m) > std::tie(widest.num, widest.nearer_end_m, widest.farther_end_m)) widest = gap;
}

// In each line the circle without the widest gap between its returns there: also of a piece all round, whatever column the scan begins with.
void PieceTable::CountBeams(int num_columns) {
  spans_.assign(facts_.size(), {});
  for (std::size_t piece = 0; piece < facts_.size(); ++piece) {
    if (is_new_[piece] != 0) facts_[piece].num_beams = 0;
  }
  const auto close = [this, num_columns](std::size_t piece) {
    const Span& span = spans_[piece];
    const std::int32_t over_seam = span.first + num_columns - span.last - 1;
    if (span.line >= 0) facts_[piece].num_beams += num_columns - std::max(over_seam, span.widest_gap);
  };
  for (const Run& run : runs_) {
    const auto piece = static_cast<std::size_t>(run.piece);
    if (is_new_[piece] == 0) continue;
    Span& span = spans_[piece];
    if (span.line != run.line) {
      close(piece);
      span = {run.line, run.first, run.last, 0};
      continue;
    }
    span.widest_gap = std::max(span.widest_gap, run.first - span.last - 1);
    span.last = run.last;
  }
  for (std::size_t piece = 0; piece < facts_.size(); ++piece) close(piece);
}

void PieceTable::FitLines(double column_step_rad) {
  extents_.assign(facts_.size(), {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0.0});
  for (std::size_t piece = 0; piece < facts_.size(); ++piece) {
    if (is_new_[piece] == 0) continue;
    PieceFacts& facts = facts_[piece];
    const Sums& sums = sums_[piece];
    const double count = facts.num_returns;
    facts.mean_m = {sums.x_m / count, sums.y_m / count};
    facts.mean_height_m = sums.height_m / count;
    facts.width_m = facts.arc.num * column_step_rad * facts.min_range_m;
    // No line goes through one return, or through some above each other: then across the line of sight, which turns as the scene does.
    const double from_lidar_m = std::sqrt(facts.mean_m.squaredNorm());
    facts.direction = Eigen::Vector2d::UnitX();
    if (from_lidar_m > 0.0) facts.direction = Eigen::Vector2d(-facts.mean_m.y(), facts.mean_m.x()) / from_lidar_m;
    if (facts.num_returns == 1) continue;
    const double xx_m2 = sums.xx_m2 / count - facts.mean_m.x() * facts.mean_m.x();
    const double xy_m2 = sums.xy_m2 / count - facts.mean_m.x() * facts.mean_m.y();
    const double yy_m2 = sums.yy_m2 / count - facts.mean_m.y() * facts.mean_m.y();
    const double half_difference_m2 = (xx_m2 - yy_m2) / 2.0;
    const double radius_m2 = std::sqrt(half_difference_m2 * half_difference_m2 + xy_m2 * xy_m2);
    if (radius_m2 > kLeastLineM * kLeastLineM) {
      // Half of the angle whose cosine is half_difference / radius.
      const double cosine = half_difference_m2 / radius_m2;
      facts.direction = {std::sqrt(std::max(0.0, 1.0 + cosine) / 2.0), std::copysign(std::sqrt(std::max(0.0, 1.0 - cosine) / 2.0), xy_m2)};
    }
    facts.off_m = std::sqrt(std::max(0.0, (xx_m2 + yy_m2) / 2.0 - radius_m2));
  }
  for (const OutlineEntry& entry : entries_) {
    const auto piece = static_cast<std::size_t>(entry.piece);
    const PieceFacts& facts = facts_[piece];
    if (is_new_[piece] == 0 || facts.num_returns == 1) continue;
    Extent& extent = extents_[piece];
    for (const LevelPoint* point : {&entry.near_point, &entry.far_point}) {
      const Eigen::Vector2d from_mean_m = Eigen::Vector2d(point->x_m, point->y_m) - facts.mean_m;
      const double along_m = from_mean_m.dot(facts.direction);
      extent.least_m = std::min(extent.least_m, along_m);
      extent.greatest_m = std::max(extent.greatest_m, along_m);
      extent.radius_m2 = std::max(extent.radius_m2, from_mean_m.squaredNorm());
    }
  }
  for (std::size_t piece = 0; piece < facts_.size(); ++piece) {
    if (is_new_[piece] == 0 || facts_[piece].num_returns == 1) continue;
    facts_[piece].length_m = extents_[piece].greatest_m - extents_[piece].least_m;
    facts_[piece].radius_m = std::sqrt(extents_[piece].radius_m2);
  }
}

}  // namespace lookout::segmenter
