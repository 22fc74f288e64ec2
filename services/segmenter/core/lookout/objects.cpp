#include "services/segmenter/core/lookout/objects.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace lookout::segmenter {

namespace {

constexpr std::int32_t kSolidReturns = ThinPieces::kSolidReturns;

// One over the other.
constexpr double kOverShare = 0.7;  // of the columns of the farther one
constexpr double kWiderM = 2.0;     // by which the farther one may be longer

// Solid things within so many metres of each other that none of them is joined.
constexpr double kDenseM = 2.0;
constexpr int kMostInDense = 24;
constexpr std::size_t kMostDrops = 64;  // tiny ones within reach of one thing
constexpr double kLargeM = 4.0;
// Longer than any length is rounded.
constexpr double kRoundedUp = 1.000001;
constexpr double kRoundedUpM = 1e-3;

constexpr double kEquallyNearM = 0.001;
constexpr int kRounds = 2;

}  // namespace

void ObjectJoiner::Join(const ScanGrid& grid, const ThinPieces& thin, const Reach& link, PieceTable& pieces) {
  link_ = link;
  FindLinks(grid, thin, pieces);
  for (int round = 0; round < kRounds; ++round) {
    JoinSideBySide(pieces);
    Attach(pieces, [this](const PieceFacts& part, std::int32_t, const PieceFacts& whole, double gap_m) { return Touches(part, whole, gap_m); });
    const bool is_any_joined = pieces.Settle(grid);
    Attach(pieces, [&](const PieceFacts& part, std::int32_t piece, const PieceFacts& whole, double gap_m) {
      return IsPart(grid, part, thin.IsClear(piece), whole, gap_m);
    });
    if (!pieces.Settle(grid) && !is_any_joined) break;
  }
}

void ObjectJoiner::JoinSideBySide(PieceTable& pieces) const {
  for (const Link& link : links_) {
    const std::int32_t one = pieces.RootOf(link.one);
    const std::int32_t other = pieces.RootOf(link.other);
    if (one == other || link.has_tiny) continue;
    const PieceFacts& one_facts = pieces.FactsOf(one);
    const PieceFacts& other_facts = pieces.FactsOf(other);
    if (std::min(one_facts.num_returns, other_facts.num_returns) < kSolidReturns) continue;
    if (link.gap_m <= params_.join.At(std::min(one_facts.min_range_m, other_facts.min_range_m))) pieces.Join(one, other);
  }
}

// Each to the nearest that it may be attached to, so that nothing becomes a bridge between two boats. What has two that are equally near, to a
// millimetre, is attached to neither: chance would decide, and otherwise in a mirror.
template <typename IsAttached>
void ObjectJoiner::Attach(PieceTable& pieces, IsAttached is_attached) {
  nearest_.assign(static_cast<std::size_t>(pieces.size()), {});
  const auto for_each_way = [&](auto handle) {
    for (const Link& link : links_) {
      const std::int32_t one = pieces.RootOf(link.one);
      const std::int32_t other = pieces.RootOf(link.other);
      if (one == other) continue;
      if (link.has_tiny && std::min(pieces.FactsOf(one).num_returns, pieces.FactsOf(other).num_returns) >= kSolidReturns) continue;
      if (is_attached(pieces.FactsOf(one), link.one, pieces.FactsOf(other), link.gap_m)) handle(one, other, link.gap_m);
      if (is_attached(pieces.FactsOf(other), link.other, pieces.FactsOf(one), link.gap_m)) handle(other, one, link.gap_m);
    }
  };
  for_each_way([this](std::int32_t part, std::int32_t whole, double gap_m) {
    Nearest& nearest = nearest_[static_cast<std::size_t>(part)];
    if (gap_m < nearest.gap_m) nearest = {gap_m, whole, false};
  });
  for_each_way([this](std::int32_t part, std::int32_t whole, double gap_m) {
    Nearest& nearest = nearest_[static_cast<std::size_t>(part)];
    if (whole != nearest.whole && gap_m <= nearest.gap_m + kEquallyNearM) nearest.is_tied = true;
  });
  for (const std::int32_t root : pieces.roots()) {
    const Nearest& nearest = nearest_[static_cast<std::size_t>(root)];
    if (nearest.whole != PieceTable::kNone && !nearest.is_tied) pieces.Join(root, nearest.whole);
  }
}

bool ObjectJoiner::Touches(const PieceFacts& part, const PieceFacts& whole, double gap_m) const {
  if (part.num_returns >= kSolidReturns || whole.num_returns < kSolidReturns) return false;
  return gap_m <= link_.At(std::min(part.min_range_m, whole.min_range_m));
}

bool ObjectJoiner::IsPart(const ScanGrid& grid, const PieceFacts& part, bool is_part_clear, const PieceFacts& whole, double gap_m) const {
  if (whole.num_returns < kSolidReturns) return false;
  const double range_m = std::min(part.min_range_m, whole.min_range_m);
  const bool is_part_solid = part.num_returns >= kSolidReturns;
  if (is_part_solid && part.length_m <= params_.attach_length_m && gap_m <= params_.attach.At(range_m)) return true;
  if (!is_part_solid && is_part_clear && gap_m <= FarReachM(range_m)) return true;
  // Seen over it.
  if (part.min_range_m < whole.min_range_m || gap_m > params_.over_m) return false;
  if (part.max_ring <= whole.min_ring || part.max_ring < whole.max_ring || part.length_m > whole.length_m + kWiderM) return false;
  return SharedColumns(whole.arc, part.arc, grid.num_columns()) >= kOverShare * part.arc.num;
}

// Gaps of single pieces: between solid things, and from them to tiny ones in their columns.
void ObjectJoiner::FindLinks(const ScanGrid& grid, const ThinPieces& thin, const PieceTable& pieces) {
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
    const double reach_m = ReachM(facts);
    solid_.push_back({facts.mean_m.x(), facts.mean_m.y(), facts.radius_m, reach_m, piece, pieces.RootOf(piece), false});
  }
  std::ranges::sort(solid_, {}, [](const Solid& solid) { return std::pair(solid.x_m, solid.piece); });
  FindCrowds();
  LinkPairs(grid, pieces);
  if (solid_.empty()) return;
  ListTiny(grid, pieces);
  if (tiny_.empty()) return;
  seen_by_.assign(static_cast<std::size_t>(pieces.size()), PieceTable::kNone);
  for (const Solid& solid : solid_) {
    if (!solid.is_crowded) LinkTiny(grid, thin, pieces, solid.piece);
  }
}

void ObjectJoiner::ListTiny(const ScanGrid& grid, const PieceTable& pieces) {
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
      if (std::abs(x_m) > kDenseM) return false;
      num_near += other.root != solid.root && x_m * x_m + y_m * y_m <= kDenseM * kDenseM ? 1 : 0;
      return num_near <= kMostInDense;
    };
    for (std::size_t j = i; j > 0 && look_at(solid_[j - 1]);) --j;
    for (std::size_t j = i + 1; j < solid_.size() && look_at(solid_[j]);) ++j;
    solid.is_crowded = num_near > kMostInDense;
  }
}

void ObjectJoiner::LinkPairs(const ScanGrid& grid, const PieceTable& pieces) {
  large_.clear();
  for (std::size_t i = 0; i < solid_.size(); ++i) {
    if (solid_[i].radius_m > kLargeM && !solid_[i].is_crowded) large_.push_back(i);
  }
  double widest_m = 0.0;
  for (const Solid& solid : solid_) widest_m = std::max(widest_m, solid.reach_m);
  const double band_m = 2.0 * kLargeM + widest_m;
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
    for (; j < solid_.size() && (one.radius_m > kLargeM || solid_[j].x_m - one.x_m <= band_m); ++j) look_at(solid_[j]);
    for (auto large = std::ranges::lower_bound(large_, j); large != large_.end(); ++large) look_at(solid_[*large]);
  }
}

// The farthest that a solid piece may be joined over.
double ObjectJoiner::ReachM(const PieceFacts& facts) const {
  return std::max({params_.over_m, params_.attach.At(facts.min_range_m), params_.join.At(facts.min_range_m)});
}

void ObjectJoiner::LinkSolid(const ScanGrid& grid, const PieceTable& pieces, std::int32_t one, std::int32_t other) {
  const std::int32_t one_root = pieces.RootOf(one);
  const std::int32_t other_root = pieces.RootOf(other);
  if (one_root == other_root) return;
  const PieceFacts& one_facts = pieces.FactsOf(one_root);
  const PieceFacts& other_facts = pieces.FactsOf(other_root);
  const double between_m = (one_facts.mean_m - other_facts.mean_m).norm() - one_facts.radius_m - other_facts.radius_m;
  const double range_m = std::min(one_facts.min_range_m, other_facts.min_range_m);
  double reach_m = params_.join.At(range_m);
  // As the pieces are now: what is long is no small part of anything.
  if (std::min(one_facts.length_m, other_facts.length_m) <= params_.attach_length_m) reach_m = std::max(reach_m, params_.attach.At(range_m));
  if (between_m > std::max(reach_m, params_.over_m)) return;
  if (params_.over_m > reach_m && SharedColumns(one_facts.arc, other_facts.arc, grid.num_columns()) > 0) reach_m = params_.over_m;
  if (between_m > reach_m) return;
  const double gap_m = PlanGap(grid, pieces, one, other, reach_m);
  if (gap_m <= reach_m) links_.push_back({one, other, gap_m, false});
}

void ObjectJoiner::LinkTiny(const ScanGrid& grid, const ThinPieces& thin, const PieceTable& pieces, std::int32_t piece) {
  const PieceFacts& facts = pieces.FactsOf(pieces.RootOf(piece));
  const auto outline = pieces.OutlineOf(piece);
  const double touch_m = link_.At(facts.max_range_m);
  // In its own columns one may stand over the other; beside them they must touch. What is clear of others may lie farther off.
  const double over_m = std::max(touch_m, params_.over_m);
  const double beside_m = std::max(touch_m, FarReachM(facts.min_range_m));
  const std::size_t num_before = links_.size();
  std::size_t num_drops = 0;
  const auto look_at_columns = [&](int from, int to, bool is_over) {  // from 0 to the last at most
    const double most_m = is_over ? std::max(over_m, beside_m) : beside_m;
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
      auto& seen_by = seen_by_[static_cast<std::size_t>(tiny.piece)];
      if (seen_by == piece) continue;
      seen_by = piece;
      const PieceFacts& other = pieces.FactsOf(pieces.RootOf(tiny.piece));
      // Over it only from behind and above.
      const bool may_be_over = is_over && other.min_range_m >= facts.min_range_m && other.max_ring >= facts.max_ring;
      double reach_m = may_be_over ? over_m : touch_m;
      if (thin.IsClear(tiny.piece)) reach_m = std::max(reach_m, FarReachM(std::min(facts.min_range_m, other.min_range_m)));
      if (other.min_range_m > facts.max_range_m + reach_m || other.max_range_m < facts.min_range_m - reach_m) continue;
      const double gap_m = PlanGap(grid, pieces, piece, tiny.piece, reach_m);
      if (gap_m > reach_m) continue;
      links_.push_back({piece, tiny.piece, gap_m, true});
      ++num_drops;
    }
  };
  const auto look_at = [&](int from, int to, bool is_over) {
    const int num_columns = grid.num_columns();
    if (from < 0) look_at_columns(from + num_columns, std::min(to, -1) + num_columns, is_over);
    if (from < num_columns && to >= 0) look_at_columns(std::max(from, 0), std::min(to, num_columns - 1), is_over);
    if (to >= num_columns) look_at_columns(std::max(from, num_columns) - num_columns, to - num_columns, is_over);
  };
  for (std::size_t i = 0; i < outline.size();) {
    const int from = pieces.Entry(outline[i]).column;
    int to = from;
    for (++i; i < outline.size() && pieces.Entry(outline[i]).column == to + 1; ++i) ++to;
    look_at(from, to, true);
  }
  const int window = grid.ColumnsOf(beside_m, facts.min_range_m);
  int last = PieceTable::kNone;  // column that was looked at
  for (const std::int32_t index : outline) {
    const int column = pieces.Entry(index).column;
    const int from = last == PieceTable::kNone ? column - window : std::max(last + 1, column - window);
    look_at(from, column + window, false);
    last = column + window;
  }
  // So many are spray, whichever of them came first.
  if (num_drops > kMostDrops) links_.resize(num_before);
}

}  // namespace lookout::segmenter
