#include "services/segmenter/core/lookout/land.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "common/core/elementary.hpp"
#include "services/segmenter/core/lookout/run_links.hpp"

namespace lookout::segmenter {

namespace {

constexpr std::int32_t kNoLand = PieceTable::kNone;

// Straight pieces.
constexpr double kLeastStraightM = 1.5;
constexpr double kLeastStraightSumM = 5.0;  // of the two that are to be in line
constexpr double kStraightOffM = 0.2;
constexpr double kInLineCosine = 0.990;  // 8 degrees
constexpr Reach kInLineOff{0.25, 0.01};  // of the middle of one off the line through the other, by their distance
constexpr double kHiddenM = 0.2;         // by which what hides a line is nearer than it
constexpr int kFreeColumns = 2;          // between pieces in line that need not be hidden, and a tenth of them
constexpr int kFreeShare = 10;
constexpr std::ptrdiff_t kMostStraight = 256;

// The water's edge.
constexpr std::int32_t kLeastShoreReturns = 10;
constexpr double kBeforeM = 0.3;              // by which what stands before a shore is nearer than it on both sides
constexpr double kGreatestBeforeShare = 0.8;  // of the length of land: what is longer is itself a shore
constexpr double kLeastShoreShare = 0.6;      // of the length of land that its fragments fill

// What is of land.
constexpr double kWallOffM = 0.5;   // off its line at most
constexpr float kDeepM = 2.0F;      // from the nearest to the farthest return in a column
constexpr int kDeepPercent = 20;    // of the columns of land
constexpr int kBehindPercent = 70;  // of the columns of a piece
constexpr int kNearColumns = 3;
// A pier with a bend is no straight line either, and a boat may lie behind it: land that shows no depth takes in trees alone, which give it depth.
constexpr std::uint8_t kTakesNothing = 0;
constexpr std::uint8_t kTakesTall = 1;
constexpr std::uint8_t kTakesAll = 2;
// Of the returns above tall_m, so many, and so far from their middle (root mean square): a mast is no tree.
constexpr std::int32_t kLeastTallReturns = 5;
constexpr double kLeastTreeM = 0.5;
constexpr int kMaxRounds = 6;

// Groves.
constexpr int kLeastTrees = 3;
constexpr double kLeastGroveShare = 0.6;  // of the length of land that its trees fill

double Distance(const LevelPoint& one, const LevelPoint& other) { return std::sqrt(double{SquaredPlanDistance(one, other)}); }

double Distance3d(const LevelPoint& one, const LevelPoint& other) {
  const double up_m = double{one.height_m} - other.height_m;
  return std::sqrt(SquaredPlanDistance(one, other) + up_m * up_m);
}

}  // namespace

void LandFinder::Find(const ScanGrid& grid, const RunTable& runs, PieceTable& pieces) {
  MeasureTall(grid, pieces);
  JoinInLine(grid, pieces);
  pieces.Settle(grid);
  FindShores(grid, runs, pieces);
  pieces.Settle(grid);
  for (const std::int32_t root : pieces.roots()) {
    if (pieces.FactsOf(root).length_m >= params_.land_length_m) pieces.MarkLand(root);
  }
  pieces.Settle(grid);
  Complete(grid, pieces);
}

void LandFinder::FindGroves(const ScanGrid& grid, PieceTable& pieces) {
  JoinTrees(grid, pieces);
  if (pieces.Settle(grid)) Complete(grid, pieces);
}

void LandFinder::Complete(const ScanGrid& grid, PieceTable& pieces) {
  for (int round = 0; round < kMaxRounds && TakeIn(grid, pieces); ++round) pieces.Settle(grid);
  JoinLand(grid, pieces);
  pieces.Settle(grid);
}

void LandFinder::JoinInLine(const ScanGrid& grid, PieceTable& pieces) {
  candidates_.clear();
  for (const std::int32_t root : pieces.roots()) {
    const PieceFacts& facts = pieces.FactsOf(root);
    if (facts.length_m >= kLeastStraightM && facts.off_m <= kStraightOffM) candidates_.push_back(root);
  }
  if (std::ssize(candidates_) > kMostStraight) {
    // Rubble. A wall is among the longest.
    const auto longer = [&](std::int32_t one, std::int32_t other) {
      return std::pair(-pieces.FactsOf(one).length_m, one) < std::pair(-pieces.FactsOf(other).length_m, other);
    };
    std::nth_element(candidates_.begin(), candidates_.begin() + kMostStraight, candidates_.end(), longer);
    candidates_.resize(static_cast<std::size_t>(kMostStraight));
  }
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const PieceFacts& one = pieces.FactsOf(candidates_[i]);
    for (std::size_t j = i + 1; j < candidates_.size(); ++j) {
      const PieceFacts& other = pieces.FactsOf(candidates_[j]);
      if (std::abs(one.direction.dot(other.direction)) < kInLineCosine || one.length_m + other.length_m < kLeastStraightSumM) continue;
      const bool is_one_longer = one.length_m >= other.length_m;
      const PieceFacts& longer = is_one_longer ? one : other;
      const PieceFacts& shorter = is_one_longer ? other : one;
      const Eigen::Vector2d between_m = shorter.mean_m - longer.mean_m;
      const double off_m = std::abs(longer.direction.x() * between_m.y() - longer.direction.y() * between_m.x());
      if (off_m > kInLineOff.At(between_m.norm()) || SharedColumns(one.arc, other.arc, grid.num_columns()) > 0) continue;
      if (IsHiddenBetween(grid, pieces, longer, shorter)) pieces.Join(candidates_[i], candidates_[j]);
    }
  }
}

bool LandFinder::IsHiddenBetween(const ScanGrid& grid, const PieceTable& pieces, const PieceFacts& line, const PieceFacts& other) const {
  const int num_columns = grid.num_columns();
  const auto free_between = [num_columns](const Arc& from, const Arc& to) {  // going up in columns
    const int begin = (from.first + from.num) % num_columns;
    return Arc{begin, (to.first - begin + num_columns) % num_columns};
  };
  const Arc after = free_between(line.arc, other.arc);
  const Arc before = free_between(other.arc, line.arc);
  const Arc between = after.num <= before.num ? after : before;
  if (between.num > num_columns / 4) return false;
  const Eigen::Vector2d normal(-line.direction.y(), line.direction.x());
  const double line_m = line.mean_m.dot(normal);
  int num_open = 0;
  for (int i = 0; i < between.num; ++i) {
    bool is_hidden = false;
    for (const OutlineEntry& entry : pieces.InColumn(grid.Wrap(between.first + i))) {
      const LevelPoint& point = entry.near_point;
      // The beam from the lidar through this return meets the line at t times its distance.
      const double t = line_m / (normal.x() * point.x_m + normal.y() * point.y_m);
      is_hidden = is_hidden || (t > 0.0 && point.range_m <= t * point.range_m - kHiddenM);
    }
    num_open += is_hidden ? 0 : 1;
  }
  return num_open <= kFreeColumns + between.num / kFreeShare;
}

void LandFinder::FindShores(const ScanGrid& grid, const RunTable& runs, PieceTable& pieces) {
  chains_.Reset(static_cast<std::size_t>(runs.size()));
  for (int line = 0; line < grid.num_lines(); ++line) {
    // A drop with nothing near it is no shore.
    const std::int32_t first_run = runs.FirstOfLine(line);
    const std::int32_t end_run = runs.FirstOfLine(line + 1);
    order_.clear();
    for (std::int32_t run = first_run; run < end_run; ++run) {
      if (runs[run].is_jetty) continue;
      const float range_m = grid.RangeAt(line, runs[run].first);
      const float reach_m = WidestRange(params_.shore_gap.At(range_m), range_m);
      if (runs[run].length > 1 || grid.NumNear<kLinkColumns>(line, runs[run].first, range_m, reach_m) > 1) order_.push_back(run);
    }
    ForEachFollowing(grid, runs, order_, [&](std::int32_t one, std::int32_t other) {
      const LevelPoint& from = grid.PointOf(LastReturn(grid, runs[one]));
      const LevelPoint& to = grid.PointOf(FirstReturn(grid, runs[other]));
      if (Distance3d(from, to) <= params_.shore_gap.At(std::min(from.range_m, to.range_m))) chains_.Join(one, other);
    });
    // Runs by chain; within one they stay in order. A chain is named by its first run.
    num_of_chain_.assign(static_cast<std::size_t>(end_run - first_run), 0);
    next_of_chain_.resize(num_of_chain_.size());
    last_of_chain_.resize(num_of_chain_.size());
    for (const std::int32_t run : order_) {
      const auto chain = static_cast<std::size_t>(chains_.Find(run) - first_run);
      if (num_of_chain_[chain] > 0) next_of_chain_[static_cast<std::size_t>(last_of_chain_[chain] - first_run)] = run;
      num_of_chain_[chain] += runs[run].length;
      last_of_chain_[chain] = run;
    }
    for (const std::int32_t first : order_) {
      const auto chain = static_cast<std::size_t>(first - first_run);
      if (num_of_chain_[chain] < kLeastShoreReturns) continue;
      chain_.assign(1, first);
      for (std::int32_t run = first; run != last_of_chain_[chain];) {
        run = next_of_chain_[static_cast<std::size_t>(run - first_run)];
        chain_.push_back(run);
      }
      TakeChain(grid, runs, pieces);
    }
  }
}

void LandFinder::TakeChain(const ScanGrid& grid, const RunTable& runs, PieceTable& pieces) {
  // From the widest gap on.
  const auto gap_before = [&](std::size_t i) {
    const Run& before = runs[chain_[i > 0 ? i - 1 : chain_.size() - 1]];
    const int gap = runs[chain_[i]].first - (before.first + before.length);
    return gap < 0 ? gap + grid.num_columns() : gap;
  };
  std::size_t start = 0;
  for (std::size_t i = 1; i < chain_.size(); ++i) {
    if (gap_before(i) > gap_before(start)) start = i;
  }
  std::rotate(chain_.begin(), chain_.begin() + static_cast<std::ptrdiff_t>(start), chain_.end());

  fragments_.clear();
  for (const std::int32_t run : chain_) {
    const std::int32_t piece = pieces.RootOf(pieces.OfRun(run));
    if (fragments_.empty() || fragments_.back().piece != piece) fragments_.push_back({piece, run, run, false});
    fragments_.back().last_run = run;
  }
  const auto first_of = [&](const Fragment& fragment) -> const LevelPoint& { return grid.PointOf(FirstReturn(grid, runs[fragment.first_run])); };
  const auto last_of = [&](const Fragment& fragment) -> const LevelPoint& { return grid.PointOf(LastReturn(grid, runs[fragment.last_run])); };
  double filled_m = 0.0;
  double sum_x_m = 0.0;
  double sum_y_m = 0.0;
  int num_ends = 0;
  for (std::size_t i = 0; i < fragments_.size(); ++i) {
    Fragment& fragment = fragments_[i];
    if (pieces.FactsOf(fragment.piece).length_m <= kGreatestBeforeShare * params_.land_length_m) {
      const bool is_before_last = i == 0 || first_of(fragment).range_m < last_of(fragments_[i - 1]).range_m - kBeforeM;
      const bool is_before_next = i + 1 == fragments_.size() || last_of(fragment).range_m < first_of(fragments_[i + 1]).range_m - kBeforeM;
      fragment.is_before = is_before_last && is_before_next;
    }
    if (fragment.is_before) continue;
    filled_m += Distance(first_of(fragment), last_of(fragment));
    for (const LevelPoint* end : {&first_of(fragment), &last_of(fragment)}) {
      sum_x_m += end->x_m;
      sum_y_m += end->y_m;
      ++num_ends;
    }
  }
  if (filled_m < kLeastShoreShare * params_.land_length_m) return;
  double reach_m = 0.0;
  for (const Fragment& fragment : fragments_) {
    if (fragment.is_before) continue;
    for (const LevelPoint* end : {&first_of(fragment), &last_of(fragment)}) {
      reach_m = std::max(reach_m, Hypot(end->x_m - sum_x_m / num_ends, end->y_m - sum_y_m / num_ends));
    }
  }
  if (2.0 * reach_m < params_.land_length_m) return;
  std::int32_t last = kNoLand;
  for (const Fragment& fragment : fragments_) {
    if (fragment.is_before) continue;
    pieces.MarkLand(fragment.piece);
    if (last != kNoLand) pieces.Join(last, fragment.piece);
    last = fragment.piece;
  }
}

void LandFinder::ListLand(const ScanGrid& grid, const PieceTable& pieces) {
  is_land_.assign(static_cast<std::size_t>(pieces.size()), 0);
  for (const std::int32_t root : pieces.roots()) is_land_[static_cast<std::size_t>(root)] = pieces.FactsOf(root).is_land ? 1 : 0;
  land_entries_.clear();
  begin_of_land_.clear();
  for (int column = 0; column < grid.num_columns(); ++column) {
    begin_of_land_.push_back(land_entries_.size());
    for (const OutlineEntry& entry : pieces.InColumn(column)) {
      const std::int32_t root = pieces.RootOf(entry.piece);
      if (is_land_[static_cast<std::size_t>(root)] != 0) land_entries_.push_back({root, entry.near_point, entry.far_point});
    }
  }
  begin_of_land_.push_back(land_entries_.size());
}

bool LandFinder::FindWhatTakesIn(const ScanGrid& grid, const PieceTable& pieces) {
  ListLand(grid, pieces);
  const auto num_pieces = static_cast<std::size_t>(pieces.size());
  takes_in_.assign(num_pieces, kTakesNothing);
  if (land_entries_.empty()) return false;
  depth_of_.assign(num_pieces, {});
  const auto end_column = [](LandDepth& depth) {
    if (depth.farthest_m - depth.nearest_m > kDeepM) ++depth.num_deep;
  };
  for (int column = 0; column < grid.num_columns(); ++column) {
    for (const LandEntry& entry : LandInColumn(column)) {
      LandDepth& depth = depth_of_[static_cast<std::size_t>(entry.root)];
      if (depth.column != column) {
        end_column(depth);
        depth.column = column;
        ++depth.num_columns;
        depth.nearest_m = std::numeric_limits<float>::infinity();
        depth.farthest_m = 0.0F;
      }
      depth.nearest_m = std::min(depth.nearest_m, entry.near_point.range_m);
      depth.farthest_m = std::max(depth.farthest_m, entry.far_point.range_m);
    }
  }
  bool is_any_land = false;
  for (const std::int32_t root : pieces.roots()) {
    const auto at = static_cast<std::size_t>(root);
    if (is_land_[at] == 0) continue;
    end_column(depth_of_[at]);
    const bool is_deep = 100 * depth_of_[at].num_deep >= kDeepPercent * depth_of_[at].num_columns;
    takes_in_[at] = is_deep ? kTakesAll : pieces.FactsOf(root).off_m >= kWallOffM ? kTakesTall : kTakesNothing;
    is_any_land = is_any_land || takes_in_[at] != kTakesNothing;
  }
  if (!is_any_land) return false;
  land_m_.assign(static_cast<std::size_t>(grid.num_columns()), std::numeric_limits<float>::infinity());
  for (int column = 0; column < grid.num_columns(); ++column) {
    float nearest_m = std::numeric_limits<float>::infinity();
    for (const LandEntry& entry : LandInColumn(column)) {
      if (TakesIn(entry.root, kTakesTall)) nearest_m = std::min(nearest_m, entry.near_point.range_m);
    }
    if (!std::isfinite(nearest_m)) continue;
    for (int step = -kNearColumns; step <= kNearColumns; ++step) {
      float& land_m = land_m_[static_cast<std::size_t>(grid.Wrap(column + step))];
      land_m = std::min(land_m, nearest_m);
    }
  }
  return true;
}

bool LandFinder::TakeIn(const ScanGrid& grid, PieceTable& pieces) {
  if (!FindWhatTakesIn(grid, pieces)) return false;
  bool is_taken = false;
  for (const std::int32_t root : pieces.roots()) {
    const PieceFacts& facts = pieces.FactsOf(root);
    if (facts.is_land) continue;
    // A drop before all land, in most cases.
    if (facts.num_returns == 1 && facts.min_range_m <= land_m_[static_cast<std::size_t>(facts.arc.first)]) continue;
    std::int32_t land = LandBefore(grid, pieces, root);
    if (land == kNoLand) land = LandBeside(grid, pieces, root);
    if (land == kNoLand) continue;
    pieces.Join(land, root);
    is_taken = true;
  }
  return is_taken;
}

void LandFinder::MeasureTall(const ScanGrid& grid, const PieceTable& pieces) {
  tall_.assign(static_cast<std::size_t>(pieces.size()), {});
  const auto tall_m = static_cast<float>(params_.tall_m - params_.lidar_above_water_m);
  const auto points = grid.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LevelPoint& point = points[i];
    if (point.height_m <= tall_m) continue;
    Tall& tall = tall_[static_cast<std::size_t>(pieces.of_returns()[i])];
    ++tall.num_returns;
    tall.x_m += point.x_m;
    tall.y_m += point.y_m;
    tall.squared_m2 += double{point.x_m} * point.x_m + double{point.y_m} * point.y_m;
  }
}

// And wide up there: no mast.
bool LandFinder::IsTall(const PieceTable& pieces, std::int32_t root) const {
  if (pieces.FactsOf(root).max_height_m + params_.lidar_above_water_m <= params_.tall_m) return false;
  Tall tall;
  for (std::int32_t piece = root; piece != PieceTable::kNone; piece = pieces.NextMember(piece)) {
    const Tall& part = tall_[static_cast<std::size_t>(piece)];
    tall.num_returns += part.num_returns;
    tall.x_m += part.x_m;
    tall.y_m += part.y_m;
    tall.squared_m2 += part.squared_m2;
  }
  if (tall.num_returns < kLeastTallReturns) return false;
  const double x_m = tall.x_m / tall.num_returns;
  const double y_m = tall.y_m / tall.num_returns;
  return tall.squared_m2 / tall.num_returns - x_m * x_m - y_m * y_m > kLeastTreeM * kLeastTreeM;
}

// Trees of one grove are marked and joined.
void LandFinder::JoinTrees(const ScanGrid& grid, PieceTable& pieces) {
  const auto num_pieces = static_cast<std::size_t>(pieces.size());
  near_sets_.Reset(num_pieces);
  candidates_.clear();
  for (const std::int32_t root : pieces.roots()) {
    if (pieces.FactsOf(root).is_land || !IsTall(pieces, root)) continue;
    near_sets_.Add(root);
    candidates_.push_back(root);
  }
  if (std::ssize(candidates_) < kLeastTrees) return;
  near_sets_.Group(grid, pieces, params_.beside_land);
  groves_.assign(num_pieces, {});
  const auto grove_of = [this](std::int32_t root) -> Grove& { return groves_[static_cast<std::size_t>(near_sets_.GroupOf(root))]; };
  for (const std::int32_t root : candidates_) {
    const PieceFacts& facts = pieces.FactsOf(root);
    Grove& grove = grove_of(root);
    ++grove.num_trees;
    grove.length_m += facts.length_m;
    grove.sum_m += facts.mean_m;
  }
  for (const std::int32_t root : candidates_) {
    const PieceFacts& facts = pieces.FactsOf(root);
    Grove& grove = grove_of(root);
    grove.radius_m = std::max(grove.radius_m, (facts.mean_m - grove.sum_m / grove.num_trees).norm() + facts.radius_m);
  }
  for (const std::int32_t root : candidates_) {
    const Grove& grove = grove_of(root);
    if (grove.num_trees < kLeastTrees || grove.length_m < kLeastGroveShare * params_.land_length_m) continue;
    if (2.0 * grove.radius_m < params_.land_length_m) continue;
    pieces.MarkLand(root);
    pieces.Join(near_sets_.GroupOf(root), root);
  }
}

std::int32_t LandFinder::LandBefore(const ScanGrid& grid, const PieceTable& pieces, std::int32_t root) const {
  int num_seen = 0;
  int num_behind = 0;
  for (std::int32_t piece = root; piece != PieceTable::kNone; piece = pieces.NextMember(piece)) {
    for (const std::int32_t index : pieces.OutlineOf(piece)) {
      const OutlineEntry& entry = pieces.Entry(index);
      ++num_seen;
      num_behind += entry.near_point.range_m > land_m_[static_cast<std::size_t>(entry.column)] ? 1 : 0;
    }
  }
  if (100 * num_behind < kBehindPercent * num_seen) return kNoLand;
  const std::uint8_t least_taking = IsTall(pieces, root) ? kTakesTall : kTakesAll;
  double least_m = params_.behind_land.At(pieces.FactsOf(root).min_range_m);
  std::int32_t land = kNoLand;
  for (std::int32_t piece = root; piece != PieceTable::kNone; piece = pieces.NextMember(piece)) {
    for (const std::int32_t index : pieces.OutlineOf(piece)) {
      const OutlineEntry& entry = pieces.Entry(index);
      const float range_m = entry.near_point.range_m;
      for (int step = -kNearColumns; step <= kNearColumns; ++step) {
        for (const LandEntry& other : LandInColumn(grid.Wrap(entry.column + step))) {
          if (!TakesIn(other.root, least_taking) || other.near_point.range_m >= range_m) continue;
          const double gap_m = std::max(0.0, double{range_m} - other.far_point.range_m);
          if (gap_m > least_m || (gap_m == least_m && land != kNoLand && other.root >= land)) continue;
          least_m = gap_m;
          land = other.root;
        }
      }
    }
  }
  return land;
}

std::int32_t LandFinder::LandBeside(const ScanGrid& grid, const PieceTable& pieces, std::int32_t root) const {
  const PieceFacts& facts = pieces.FactsOf(root);
  if (!IsTall(pieces, root)) return kNoLand;
  double least_m = params_.beside_land.At(facts.min_range_m);
  std::int32_t land = kNoLand;
  const auto look_at = [&](const OutlineEntry& mine, int column) {
    for (const LandEntry& other : LandInColumn(column)) {
      if (!TakesIn(other.root, kTakesTall)) continue;
      // What is farther apart in range is farther apart.
      const double apart_m =
          std::max(double{other.near_point.range_m} - mine.far_point.range_m, double{mine.near_point.range_m} - other.far_point.range_m);
      if (apart_m > WidestRange(least_m, mine.far_point.range_m)) continue;
      for (const LevelPoint* my_end : {&mine.near_point, &mine.far_point}) {
        for (const LevelPoint* other_end : {&other.near_point, &other.far_point}) {
          const double distance_m = Distance(*my_end, *other_end);
          if (distance_m > least_m || (distance_m == least_m && land != kNoLand && other.root >= land)) continue;
          least_m = distance_m;
          land = other.root;
        }
      }
    }
  };
  const int window = grid.ColumnsOf(least_m, facts.min_range_m);
  const int last_column = grid.Wrap(facts.arc.first + facts.arc.num - 1);
  for (std::int32_t piece = root; piece != PieceTable::kNone; piece = pieces.NextMember(piece)) {
    for (const std::int32_t index : pieces.OutlineOf(piece)) {
      const OutlineEntry& mine = pieces.Entry(index);
      look_at(mine, mine.column);
      // From its ends to both sides.
      if (mine.column != facts.arc.first && mine.column != last_column) continue;
      for (int step = 1; step <= window; ++step) {
        look_at(mine, grid.Wrap(mine.column - step));
        look_at(mine, grid.Wrap(mine.column + step));
      }
    }
  }
  return land;
}

void LandFinder::JoinLand(const ScanGrid& grid, PieceTable& pieces) {
  near_sets_.Reset(static_cast<std::size_t>(pieces.size()));
  candidates_.clear();
  for (const std::int32_t root : pieces.roots()) {
    if (!pieces.FactsOf(root).is_land) continue;
    near_sets_.Add(root);
    candidates_.push_back(root);
  }
  if (candidates_.size() < 2) return;
  near_sets_.Group(grid, pieces, {params_.beside_land.at_lidar_m / 2.0, params_.beside_land.per_range});
  for (const std::int32_t root : candidates_) pieces.Join(near_sets_.GroupOf(root), root);
}

}  // namespace lookout::segmenter
