#include "services/segmenter/core/lookout/objects.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lookout::segmenter {

namespace {

// Docks, in metres. Widths: a walkway of 1.2 m to a ferry landing.
constexpr double kThickestPostM = 0.7;
constexpr float kLeastPostRangeM = 4.0F;
constexpr double kNarrowestDockM = 1.0;
constexpr double kWidestDockM = 3.5;
constexpr double kLeastSpacingM = 1.2;
constexpr double kSquareCosine = 0.12;  // 7 degrees off a right angle
constexpr Reach kCornerOff{0.2, 0.005};
constexpr double kSideOffM = 0.35;
constexpr double kPastCornerM = 0.3;
constexpr double kCrowdM = 8.0;  // within which more than kMostInCrowd thin things are no posts
constexpr std::size_t kMostInCrowd = 8;
constexpr std::size_t kCells = 64;  // across the grid of posts
constexpr double kMiddleCell = 32.0;

// One over the other.
constexpr double kOverLength = 0.6;  // lengths of the nearer one: a cabin stands on its hull
constexpr double kOverShare = 0.7;   // of the columns of the farther one
constexpr double kWiderM = 2.0;      // by which the farther one may be longer
constexpr double kFarthestOverM = 10.0;

// Small solid things within so many metres of each other that none of them is joined.
constexpr double kThrongM = 2.0;
constexpr int kMostInThrong = 24;
constexpr std::size_t kMostDrops = 64;  // tiny ones within reach of one thing
constexpr double kLargeM = 4.0;
// Longer than any length is rounded.
constexpr double kRoundedUp = 1.000001;
constexpr double kRoundedUpM = 1e-3;

constexpr int kRounds = 2;

}  // namespace

void ObjectJoiner::JoinDocks(PieceTable& pieces) {
  posts_.clear();
  if (params_.post_spacing_m <= 0.0) return;
  for (const std::int32_t root : pieces.roots()) {
    const PieceFacts& facts = pieces.FactsOf(root);
    if (facts.is_land || facts.length_m >= kThickestPostM || facts.min_range_m <= kLeastPostRangeM) continue;
    if (facts.max_height_m + params_.lidar_above_water_m > params_.tall_m) continue;  // a mast
    posts_.push_back({root, facts.mean_m.x(), facts.mean_m.y(), facts.min_range_m, CellOf(facts.mean_m.x(), facts.mean_m.y())});
  }
  SortPosts();
  for (const Post& post : posts_) {
    FindNeighbours(post);
    JoinRectangles(post, pieces);
  }
}

// Square cells half as wide as a dock's longest diagonal, so that neighbours are at most two cells away. What is farther off than the grid is in its
// rim.
std::size_t ObjectJoiner::CellOf(double x_m, double y_m) const {
  const double cell_m = ReachM() / 2.0;
  const auto index = [cell_m](double place_m) {
    return static_cast<std::size_t>(std::clamp(std::floor(place_m / cell_m) + kMiddleCell, 0.0, static_cast<double>(kCells - 1)));
  };
  return index(y_m) * kCells + index(x_m);
}

double ObjectJoiner::ReachM() const { return std::sqrt(params_.post_spacing_m * params_.post_spacing_m + kWidestDockM * kWidestDockM); }

void ObjectJoiner::SortPosts() {
  begin_of_cell_.assign(kCells * kCells + 1, 0);
  for (const Post& post : posts_) ++begin_of_cell_[post.cell + 1];
  for (std::size_t cell = 1; cell < begin_of_cell_.size(); ++cell) begin_of_cell_[cell] += begin_of_cell_[cell - 1];
  sorted_.resize(posts_.size());
  for (const Post& post : posts_) sorted_[begin_of_cell_[post.cell]++] = post;
  for (std::size_t cell = begin_of_cell_.size() - 1; cell > 0; --cell) begin_of_cell_[cell] = begin_of_cell_[cell - 1];
  begin_of_cell_[0] = 0;
  std::ranges::copy(sorted_, posts_.begin());
}

// Within the longest diagonal; none where it stands in a crowd.
void ObjectJoiner::FindNeighbours(const Post& post) {
  neighbours_.clear();
  const double reach_m2 = ReachM() * ReachM();
  const std::size_t cell = post.cell;
  const auto near = [](std::size_t index) { return std::pair(index > 1 ? index - 2 : 0, std::min(index + 2, kCells - 1)); };
  const auto [first_row, last_row] = near(cell / kCells);
  const auto [first, last] = near(cell % kCells);
  std::size_t num_in_crowd = 0;
  // Its own cell first: what is crowded there is crowded.
  for (std::size_t i = begin_of_cell_[cell]; i < begin_of_cell_[cell + 1]; ++i) {
    const double x_m = posts_[i].x_m - post.x_m;
    const double y_m = posts_[i].y_m - post.y_m;
    if (x_m * x_m + y_m * y_m <= kCrowdM * kCrowdM && ++num_in_crowd > kMostInCrowd + 1) return;  // itself is one of them
  }
  num_in_crowd = 0;
  for (std::size_t row = first_row; row <= last_row; ++row) {
    for (std::size_t i = begin_of_cell_[row * kCells + first]; i < begin_of_cell_[row * kCells + last + 1]; ++i) {
      const Post& other = posts_[i];
      if (other.root == post.root) continue;
      const double x_m = other.x_m - post.x_m;
      const double y_m = other.y_m - post.y_m;
      const double distance_m2 = x_m * x_m + y_m * y_m;
      if (distance_m2 <= kCrowdM * kCrowdM && ++num_in_crowd > kMostInCrowd) {
        neighbours_.clear();
        return;
      }
      if (distance_m2 <= reach_m2) neighbours_.push_back(other);
    }
  }
}

// With `post` at one corner: u along the width, v along the length.
void ObjectJoiner::JoinRectangles(const Post& post, PieceTable& pieces) const {
  const double off_m = kCornerOff.At(post.range_m);
  for (const Post& across : neighbours_) {
    const double u_x_m = across.x_m - post.x_m;
    const double u_y_m = across.y_m - post.y_m;
    const double u_m = std::hypot(u_x_m, u_y_m);
    if (u_m < kNarrowestDockM || u_m > kWidestDockM) continue;
    for (const Post& along : neighbours_) {
      const double v_x_m = along.x_m - post.x_m;
      const double v_y_m = along.y_m - post.y_m;
      const double v_m = std::hypot(v_x_m, v_y_m);
      if (v_m < kLeastSpacingM || v_m < u_m || v_m > params_.post_spacing_m) continue;
      if (std::abs(u_x_m * v_x_m + u_y_m * v_y_m) > kSquareCosine * u_m * v_m) continue;
      const bool has_fourth = std::ranges::any_of(neighbours_, [&](const Post& fourth) {
        return std::hypot(fourth.x_m - post.x_m - u_x_m - v_x_m, fourth.y_m - post.y_m - u_y_m - v_y_m) <= off_m;
      });
      if (!has_fourth) continue;
      pieces.MarkDock(post.root);
      const double width_m = (u_x_m * v_y_m - u_y_m * v_x_m) / v_m;  // with its sign
      for (const Post& other : neighbours_) {
        const double x_m = other.x_m - post.x_m;
        const double y_m = other.y_m - post.y_m;
        const double along_m = (x_m * v_x_m + y_m * v_y_m) / v_m;
        const double across_m = (x_m * v_y_m - y_m * v_x_m) / v_m;
        const bool is_at_side = std::abs(across_m) < kSideOffM || std::abs(across_m - width_m) < kSideOffM;
        if (is_at_side && along_m > -kPastCornerM && along_m < v_m + kPastCornerM) pieces.Join(post.root, other.root);
      }
    }
  }
}

void ObjectJoiner::JoinObjects(const TurnGrid& grid, PieceTable& pieces, const Reach& link) {
  link_ = link;
  FindLinks(grid, pieces);
  for (int round = 0; round < kRounds; ++round) {
    for (const Link& one_link : links_) {
      const std::int32_t one = pieces.RootOf(one_link.one);
      const std::int32_t other = pieces.RootOf(one_link.other);
      if (one != other && AreOfOneObject(grid, pieces.FactsOf(one), pieces.FactsOf(other), one_link.gap_m)) pieces.Join(one, other);
    }
    if (!pieces.Settle(grid)) break;
  }
}

// Gaps of single pieces: between solid things, and from them to tiny ones in their columns.
void ObjectJoiner::FindLinks(const TurnGrid& grid, const PieceTable& pieces) {
  links_.clear();
  solid_.clear();
  is_tiny_.assign(static_cast<std::size_t>(pieces.size()), 0);
  for (std::int32_t piece = 0; piece < pieces.size(); ++piece) {
    const PieceFacts& facts = pieces.FactsOf(pieces.RootOf(piece));
    if (facts.is_land) continue;
    if (facts.num_returns < kSolidReturns) {
      is_tiny_[static_cast<std::size_t>(piece)] = 1;
      continue;
    }
    const double reach_m = std::max(OverReachM(facts), params_.join.At(facts.min_range_m));
    solid_.push_back({facts.mean_m.x(), facts.mean_m.y(), facts.radius_m, reach_m, piece, false});
  }
  std::ranges::sort(solid_, {}, [](const Solid& solid) { return std::pair(solid.x_m, solid.piece); });
  FindCrowds();
  LinkPairs(grid, pieces);
  if (solid_.empty()) return;
  ListTiny(grid, pieces);
  if (tiny_.empty()) return;
  seen_by_.assign(static_cast<std::size_t>(pieces.size()), PieceTable::kNone);
  for (const Solid& solid : solid_) {
    if (!solid.is_crowded) LinkTiny(grid, pieces, solid.piece);
  }
}

void ObjectJoiner::ListTiny(const TurnGrid& grid, const PieceTable& pieces) {
  tiny_.clear();
  begin_of_tiny_.clear();
  for (int column = 0; column < grid.num_columns(); ++column) {
    begin_of_tiny_.push_back(tiny_.size());
    for (const OutlineEntry& entry : pieces.InColumn(column)) {
      if (is_tiny_[static_cast<std::size_t>(entry.piece)] != 0) tiny_.push_back({entry.near_point.range_m, entry.far_point.range_m, entry.piece});
    }
  }
  begin_of_tiny_.push_back(tiny_.size());
}

// In heavy spray near the lidar chance makes thousands of small clusters, each within reach of hundreds: they are not joined.
void ObjectJoiner::FindCrowds() {
  for (std::size_t i = 0; i < solid_.size(); ++i) {
    Solid& solid = solid_[i];
    int num_near = 0;
    const auto look_at = [&](const Solid& other) {
      const double x_m = other.x_m - solid.x_m;
      const double y_m = other.y_m - solid.y_m;
      if (std::abs(x_m) > kThrongM) return false;
      num_near += x_m * x_m + y_m * y_m <= kThrongM * kThrongM ? 1 : 0;
      return num_near <= kMostInThrong;
    };
    for (std::size_t j = i; j > 0 && look_at(solid_[j - 1]);) --j;
    for (std::size_t j = i + 1; j < solid_.size() && look_at(solid_[j]);) ++j;
    solid.is_crowded = num_near > kMostInThrong;
  }
}

void ObjectJoiner::LinkPairs(const TurnGrid& grid, const PieceTable& pieces) {
  large_.clear();
  for (std::size_t i = 0; i < solid_.size(); ++i) {
    if (solid_[i].radius_m > kLargeM && !solid_[i].is_crowded) large_.push_back(i);
  }
  constexpr double kBandM = 2.0 * kLargeM + kFarthestOverM;
  for (std::size_t i = 0; i < solid_.size(); ++i) {
    const Solid& one = solid_[i];
    if (one.is_crowded) continue;
    const auto look_at = [&](const Solid& other) {
      if (other.is_crowded) return;
      const double x_m = other.x_m - one.x_m;
      const double y_m = other.y_m - one.y_m;
      const double most_m = kRoundedUp * (one.radius_m + other.radius_m + std::max(one.reach_m, other.reach_m));
      if (x_m * x_m + y_m * y_m <= most_m * most_m) LinkSolid(grid, pieces, one.piece, other.piece);
    };
    // Small ones lie within a band of x; the few large ones are held against all.
    std::size_t j = i + 1;
    for (; j < solid_.size() && (one.radius_m > kLargeM || solid_[j].x_m - one.x_m <= kBandM); ++j) look_at(solid_[j]);
    for (auto large = std::ranges::lower_bound(large_, j); large != large_.end(); ++large) look_at(solid_[*large]);
  }
}

double ObjectJoiner::OverReachM(const PieceFacts& facts) const {
  return std::min(kFarthestOverM, std::max(params_.over_m, kOverLength * facts.length_m));
}

void ObjectJoiner::LinkSolid(const TurnGrid& grid, const PieceTable& pieces, std::int32_t one, std::int32_t other) {
  const std::int32_t one_root = pieces.RootOf(one);
  const std::int32_t other_root = pieces.RootOf(other);
  if (one_root == other_root) return;
  const PieceFacts& one_facts = pieces.FactsOf(one_root);
  const PieceFacts& other_facts = pieces.FactsOf(other_root);
  const double between_m = (one_facts.mean_m - other_facts.mean_m).norm() - one_facts.radius_m - other_facts.radius_m;
  double reach_m = params_.join.At(std::min(one_facts.min_range_m, other_facts.min_range_m));
  const double over_m = std::max(OverReachM(one_facts), OverReachM(other_facts));
  if (between_m > std::max(reach_m, over_m)) return;
  if (over_m > reach_m && SharedColumns(one_facts.arc, other_facts.arc, grid.num_columns()) > 0) reach_m = over_m;
  if (between_m > reach_m) return;
  const double gap_m = PlanGap(grid, pieces, one, other, reach_m);
  if (gap_m <= reach_m) links_.push_back({one, other, gap_m});
}

void ObjectJoiner::LinkTiny(const TurnGrid& grid, const PieceTable& pieces, std::int32_t piece) {
  const PieceFacts& facts = pieces.FactsOf(pieces.RootOf(piece));
  const auto outline = pieces.OutlineOf(piece);
  const double touch_m = link_.At(facts.max_range_m);
  const std::size_t num_before = links_.size();
  std::size_t num_drops = 0;
  const auto look_at_columns = [&](int from, int to, double most_m) {  // from 0 to the last at most
    const double nearest_m = facts.min_range_m - most_m;
    const double farthest_m = facts.max_range_m + most_m;
    const auto least_m = static_cast<float>(nearest_m / kRoundedUp - kRoundedUpM);
    const auto greatest_m = static_cast<float>(farthest_m * kRoundedUp + kRoundedUpM);
    const std::size_t end = begin_of_tiny_[static_cast<std::size_t>(to) + 1];
    for (std::size_t i = begin_of_tiny_[static_cast<std::size_t>(from)]; i < end; ++i) {
      const Tiny& tiny = tiny_[i];
      if (tiny.nearest_m > greatest_m || tiny.farthest_m < least_m) continue;  // most of them
      if (num_drops > kMostDrops) return;
      if (tiny.nearest_m > farthest_m || tiny.farthest_m < nearest_m) continue;
      double reach_m = most_m;
      auto& seen_by = seen_by_[static_cast<std::size_t>(tiny.piece)];
      if (seen_by == piece) continue;
      seen_by = piece;
      const PieceFacts& other = pieces.FactsOf(pieces.RootOf(tiny.piece));
      // Over it only from behind and above; the rings of a set only grow.
      if (other.min_range_m < facts.min_range_m || other.max_ring < facts.max_ring) {
        reach_m = std::min(reach_m, touch_m);
        if (other.min_range_m > facts.max_range_m + reach_m || other.max_range_m < facts.min_range_m - reach_m) continue;
      }
      const double gap_m = PlanGap(grid, pieces, piece, tiny.piece, reach_m);
      if (gap_m > reach_m) continue;
      links_.push_back({piece, tiny.piece, gap_m});
      ++num_drops;
    }
  };
  // In its own columns one may stand over the other; beside them they must touch.
  const double over_m = std::max(touch_m, OverReachM(facts));
  const auto look_at = [&](int from, int to, double most_m) {
    const int num_columns = grid.num_columns();
    if (from < 0) look_at_columns(from + num_columns, std::min(to, -1) + num_columns, most_m);
    if (from < num_columns && to >= 0) look_at_columns(std::max(from, 0), std::min(to, num_columns - 1), most_m);
    if (to >= num_columns) look_at_columns(std::max(from, num_columns) - num_columns, to - num_columns, most_m);
  };
  for (std::size_t i = 0; i < outline.size();) {
    const int from = pieces.Entry(outline[i]).column;
    int to = from;
    for (++i; i < outline.size() && pieces.Entry(outline[i]).column == to + 1; ++i) ++to;
    look_at(from, to, over_m);
  }
  const int window = grid.ColumnsOf(touch_m, facts.min_range_m);
  int last = PieceTable::kNone;  // column that was looked at
  for (const std::int32_t index : outline) {
    const int column = pieces.Entry(index).column;
    const int from = last == PieceTable::kNone ? column - window : std::max(last + 1, column - window);
    look_at(from, column + window, touch_m);
    last = column + window;
  }
  // So many are spray, whichever of them came first.
  if (num_drops > kMostDrops) links_.resize(num_before);
}

bool ObjectJoiner::AreOfOneObject(const TurnGrid& grid, const PieceFacts& one, const PieceFacts& other, double gap_m) const {
  const bool is_one_solid = one.num_returns >= kSolidReturns;
  const bool is_other_solid = other.num_returns >= kSolidReturns;
  if (!is_one_solid && !is_other_solid) return false;
  const Reach& reach = is_one_solid && is_other_solid ? params_.join : link_;
  if (gap_m <= reach.At(std::min(one.min_range_m, other.min_range_m))) return true;
  const bool is_one_nearer = one.min_range_m <= other.min_range_m;
  const PieceFacts& nearer = is_one_nearer ? one : other;
  const PieceFacts& farther = is_one_nearer ? other : one;
  if (gap_m > std::max(params_.over_m, kOverLength * nearer.length_m)) return false;
  if (farther.max_ring <= nearer.min_ring || farther.max_ring < nearer.max_ring || farther.length_m > nearer.length_m + kWiderM) return false;
  return SharedColumns(nearer.arc, farther.arc, grid.num_columns()) >= kOverShare * farther.arc.num;
}

}  // namespace lookout::segmenter
