#include "services/segmenter/core/lookout/objects.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

// One over the other.
constexpr double kOverLength = 0.6;  // lengths of the nearer one: a cabin stands on its hull
constexpr double kOverShare = 0.7;   // of the columns of the farther one
constexpr double kWiderM = 2.0;      // by which the farther one may be longer
constexpr double kFarthestOverM = 10.0;

constexpr int kRounds = 2;

}  // namespace

void ObjectJoiner::JoinDocks(const TurnGrid&, PieceTable& pieces) {
  posts_.clear();
  for (const std::int32_t root : pieces.roots()) {
    const PieceFacts& facts = pieces.FactsOf(root);
    if (facts.is_land || facts.length_m >= kThickestPostM || facts.min_range_m <= kLeastPostRangeM) continue;
    posts_.push_back({root, facts.mean_m.x(), facts.mean_m.y(), facts.min_range_m});
  }
  std::ranges::sort(posts_, {}, [](const Post& post) { return std::pair(post.x_m, post.root); });
  for (const Post& post : posts_) {
    FindNeighbours(post);
    JoinRectangles(post, pieces);
  }
}

// Within the longest diagonal; none where it stands in a crowd.
void ObjectJoiner::FindNeighbours(const Post& post) {
  neighbours_.clear();
  const double reach_m = std::hypot(params_.post_spacing_m, kWidestDockM);
  std::size_t num_in_crowd = 0;
  const auto look_at = [&](const Post& other) {
    const double distance_m = std::hypot(other.x_m - post.x_m, other.y_m - post.y_m);
    if (distance_m <= kCrowdM && ++num_in_crowd > kMostInCrowd) return false;
    if (distance_m <= reach_m) neighbours_.push_back(other);
    return true;
  };
  const auto here = std::ranges::lower_bound(posts_, std::pair(post.x_m, post.root), {}, [](const Post& other) { return std::pair(other.x_m, other.root); });
  bool is_crowded = false;
  for (auto at = here; at != posts_.begin() && !is_crowded && post.x_m - std::prev(at)->x_m <= reach_m; --at) is_crowded = !look_at(*std::prev(at));
  for (auto at = std::next(here); at != posts_.end() && !is_crowded && at->x_m - post.x_m <= reach_m; ++at) is_crowded = !look_at(*at);
  if (is_crowded) neighbours_.clear();
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

void ObjectJoiner::JoinObjects(const TurnGrid& grid, const RunTable& runs, PieceTable& pieces) {
  FindLinks(grid, pieces);
  for (int round = 0; round < kRounds; ++round) {
    for (const Link& link : links_) {
      const std::int32_t one = pieces.RootOf(link.one);
      const std::int32_t other = pieces.RootOf(link.other);
      if (one != other && AreOfOneObject(grid, pieces.FactsOf(one), pieces.FactsOf(other), link.gap_m)) pieces.Join(one, other);
    }
    if (!pieces.Settle(grid, runs)) break;
  }
}

// Gaps of single pieces, those of solid things to all others.
void ObjectJoiner::FindLinks(const TurnGrid& grid, PieceTable& pieces) {
  links_.clear();
  seen_by_.assign(static_cast<std::size_t>(pieces.size()), PieceTable::kNone);
  for (std::int32_t piece = 0; piece < pieces.size(); ++piece) {
    const std::int32_t root = pieces.RootOf(piece);
    const PieceFacts& facts = pieces.FactsOf(root);
    if (facts.is_land || facts.num_returns < kSolidReturns) continue;
    const double over_m = std::min(kFarthestOverM, std::max(params_.over_m, kOverLength * facts.length_m));
    const double reach_m = std::max(over_m, params_.join.At(facts.max_range_m));
    const auto outline = pieces.OutlineOf(piece);
    const auto look_at = [&](int column) {
      for (const OutlineEntry& entry : pieces.InColumn(column)) {
        auto& seen_by = seen_by_[static_cast<std::size_t>(entry.piece)];
        if (entry.piece == piece || seen_by == piece) continue;
        seen_by = piece;
        const std::int32_t other_root = pieces.RootOf(entry.piece);
        const PieceFacts& other = pieces.FactsOf(other_root);
        if (other_root == root || other.is_land) continue;
        if (other.min_range_m > facts.max_range_m + reach_m || other.max_range_m < facts.min_range_m - reach_m) continue;
        const double gap_m = PlanGap(grid, pieces, piece, entry.piece, reach_m);
        if (gap_m <= reach_m) links_.push_back({piece, entry.piece, gap_m});
      }
    };
    // Its own columns, and those beside it within reach.
    const int window = grid.ColumnsOf(params_.join.At(facts.max_range_m), facts.min_range_m);
    int last = PieceTable::kNone;  // column that was looked at
    for (const std::int32_t index : outline) {
      const int column = pieces.Entry(index).column;
      const int from = last == PieceTable::kNone ? column - window : std::max(last + 1, column - window);
      for (int at = from; at <= column + window; ++at) look_at(grid.Wrap(at));
      last = column + window;
    }
  }
}

bool ObjectJoiner::AreOfOneObject(const TurnGrid& grid, const PieceFacts& one, const PieceFacts& other, double gap_m) const {
  const bool is_one_solid = one.num_returns >= kSolidReturns;
  const bool is_other_solid = other.num_returns >= kSolidReturns;
  if (!is_one_solid && !is_other_solid) return false;
  const Reach& reach = is_one_solid && is_other_solid ? params_.join : params_.link;
  if (gap_m <= reach.At(std::min(one.min_range_m, other.min_range_m))) return true;
  const bool is_one_nearer = one.min_range_m <= other.min_range_m;
  const PieceFacts& nearer = is_one_nearer ? one : other;
  const PieceFacts& farther = is_one_nearer ? other : one;
  if (gap_m > std::max(params_.over_m, kOverLength * nearer.length_m)) return false;
  if (farther.max_ring <= nearer.min_ring || farther.max_ring < nearer.max_ring || farther.length_m > nearer.length_m + kWiderM) return false;
  return SharedColumns(nearer.arc, farther.arc, grid.num_columns()) >= kOverShare * farther.arc.num;
}

}  // namespace lookout::segmenter
