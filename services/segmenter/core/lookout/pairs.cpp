#include "services/segmenter/core/lookout/pairs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/core/angles.hpp"

namespace lookout::segmenter {

namespace {

constexpr std::int32_t kFree = -1;
constexpr float kNothingM = std::numeric_limits<float>::infinity();
constexpr int kMostColumnsBeside = 160;
constexpr float kFacedM = 1.0F;
constexpr float kNearerM = 0.5F;
constexpr double kRoundedUp = 1.0 + 1e-5;  // more than single precision rounds
// Pieces of so few returns may be drops of rain or spray, of which there are thousands near the lidar. Two of them are a pair from 10 m on, up to a
// metre for every 10 m beyond; nearer than that a thing is seen by more returns. One of them and something larger are a pair only where they are
// near.
constexpr std::int32_t kFewReturns = 2;
constexpr Reach kReachOfFew{-1.0, 0.1};
constexpr Reach kReachToFew{0.5, 0.08};
// A thing has a few neighbours, a drop in rain or spray has dozens. Where so many have been met in a direction, no further column is looked at: the
// bound goes by whole columns, so no order decides. Fitted: with 48 instead of 160 canals lose pairs that they need.
constexpr int kMostFewBeside = 8;
constexpr int kMostLargerBeside = 160;
// Pieces behind it in one column.
constexpr int kMostBehind = 32;
// Columns at each end of a gap in which its beams are looked at.
constexpr int kBeamColumns = 16;
// Twice the most pairs and more: the pairs of the last look do not fill it.
constexpr std::size_t kSlots = std::bit_ceil(2 * PairFinder::kMostPairs);

// Shares of the reach, tried one after the other until the bounds hold; at last there are no pairs. All of the scan has the same, so that neither
// order nor the cut of the scan decides.
struct Share {
  double of_few;
  double of_any;
};
constexpr std::array<Share, 4> kShares{{{1.0, 1.0}, {0.0, 1.0}, {0.0, 0.3}, {0.0, 0.1}}};
constexpr std::size_t kNoneOfFew = 1;
// Where pieces of few returns cover more columns than kMostShownFew, they are in no pair; where larger pieces cover more than kMostShownLarger, the
// scan has no pairs. Heavy rain of 5000 drops covers 4000, the larger pieces of a canal with trees on both banks 9000.
constexpr std::size_t kMostShownFew = 16'384;
constexpr std::size_t kMostShownLarger = 32'768;
constexpr std::size_t kLeastCounted = 6144;  // more than heavy rain shows

Reach Times(double share, const Reach& reach) { return {share * reach.at_lidar_m, share * reach.per_range}; }

bool IsFew(const PieceFacts& piece) { return piece.num_returns <= kFewReturns; }

float Over(double value, double by) { return static_cast<float>(by > 0.0 ? value / by : 0.0); }

// Where a pair has its slot, or the first that it may have. Fibonacci hashing: pieces that are neighbours have numbers that follow each other, and
// must not crowd neighbouring slots.
std::size_t FirstSlotOf(std::int32_t one, std::int32_t other) {
  constexpr std::uint64_t kGolden = 0x9E37'79B9'7F4A'7C15U;
  const std::uint64_t key = static_cast<std::uint64_t>(one) << 32U | static_cast<std::uint64_t>(other);
  return static_cast<std::size_t>((key * kGolden) >> 32U) & (kSlots - 1);
}

}  // namespace

std::span<const PiecePair> PairFinder::Find(const ScanGrid& grid, const PieceTable& pieces, const Reach& reach, bool reaches_behind) {
  reaches_behind_ = reaches_behind;
  contacts_.clear();
  std::size_t num_few = 0;
  std::size_t num_larger = 0;
  for (std::int32_t piece = 0; piece < pieces.size(); ++piece) {
    (IsFew(pieces[piece]) ? num_few : num_larger) += static_cast<std::size_t>(pieces[piece].num_columns);
  }
  if (num_few > kMostShownFew) share_ = std::max(share_, kNoneOfFew);
  if (num_larger > kMostShownLarger) share_ = kShares.size();
  if (share_ < kShares.size()) SortByKind(pieces, grid.num_columns());
  for (; share_ < kShares.size(); ++share_) {
    const auto [of_few, of_any] = kShares[share_];
    if (FindContacts(grid, pieces, {Times(of_any, reach), Times(of_few, kReachOfFew), Times(of_few, kReachToFew)})) break;
    contacts_.clear();
  }
  pairs_.resize(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) Measure(grid, pieces, contacts_[i], pairs_[i]);
  return pairs_;
}

void PairFinder::SortByKind(const PieceTable& pieces, int num_columns) {
  few_.Clear();
  larger_.Clear();
  shown_.clear();
  nearest_m_.clear();
  for (int column = 0; column < num_columns; ++column) {
    const auto seen = pieces.InColumn(column);
    nearest_m_.push_back(seen.empty() ? kNothingM : seen.front().near_point.range_m);
    for (const auto& entry : seen) {
      const bool is_few = IsFew(pieces[entry.piece]);
      shown_.push_back({entry.near_point, entry.far_point, entry.piece, static_cast<std::int32_t>(shown_.size()), column, is_few,
                        entry.nearest == entry.farthest});
      if (!is_few || share_ < kNoneOfFew) (is_few ? few_ : larger_).Add(shown_.back());
    }
    few_.EndColumn();
    larger_.EndColumn();
  }
  const auto entries = pieces.entries();
  steps_.resize(entries.size());
  first_and_last_.assign(static_cast<std::size_t>(pieces.size()), {-1, -1});
  const auto set = [&](std::size_t before, std::size_t after, int num_steps) { steps_[before].after = steps_[after].before = num_steps; };
  for (std::size_t i = 0; i < entries.size(); ++i) {
    auto& [first, last] = first_and_last_[static_cast<std::size_t>(entries[i].piece)];
    if (first < 0) {
      first = static_cast<std::int32_t>(i);
    } else {
      set(static_cast<std::size_t>(last), i, entries[i].column - entries[static_cast<std::size_t>(last)].column);
    }
    last = static_cast<std::int32_t>(i);
  }
  for (const auto& [first, last] : first_and_last_) {
    const auto begin = static_cast<std::size_t>(first);
    const auto end = static_cast<std::size_t>(last);
    set(end, begin, entries[begin].column + num_columns - entries[end].column);
  }
}

// @return false when there are more looks or pairs than may be: a sum over all of the scan, so that it does not matter where it is noticed. Where
// there is much to look at, looks are counted first, which takes a tenth of the time.
bool PairFinder::FindContacts(const ScanGrid& grid, const PieceTable& pieces, const Reaches& reaches) {
  slots_.assign(kSlots, kFree);
  for (const bool is_counting : {true, false}) {
    if (is_counting && few_.entry.size() + larger_.entry.size() <= kLeastCounted) continue;
    is_counting_ = is_counting;
    num_looks_ = 0;
    std::size_t end = 0;
    for (int column = 0; column < grid.num_columns(); ++column) {
      std::size_t at = end;
      end += pieces.InColumn(column).size();
      for (; at < end; ++at) {
        const Shown& from = shown_[at];
        if (from.is_few && reaches.to_few.per_range <= 0.0) continue;
        LookBehind(reaches, from, std::span<const Shown>(shown_).subspan(at + 1, end - at - 1));
        LookBeside(grid, pieces, reaches, from);
        if (num_looks_ > kMostLooks || contacts_.size() > kMostPairs) return false;
      }
    }
  }
  return true;
}

void PairFinder::LookBehind(const Reaches& reaches, const Shown& front, std::span<const Shown> behind) {
  num_looks_ += static_cast<std::int64_t>(behind.size());
  if (is_counting_ || behind.empty()) return;
  const float front_m = front.far.range_m;
  const auto reach_m = static_cast<float>(reaches.any.At(front_m));
  const auto reach_of_few_m = static_cast<float>(reaches.of_few.At(front_m));
  const auto reach_to_few_m = static_cast<float>(reaches.to_few.At(front_m));
  int num_behind = 0;
  for (const Shown& back : behind) {
    const float gap_m = std::max(0.0F, back.near.range_m - front_m);
    if (gap_m > reach_m || num_behind == kMostBehind) break;
    if (front.is_few && back.is_few && gap_m >= reach_of_few_m) continue;
    if ((front.is_few || back.is_few) && gap_m > reach_to_few_m) continue;
    if (back.is_few && reaches.to_few.per_range <= 0.0) continue;
    Contact& contact = RecordContact(front, front.far, back, back.near, gap_m * gap_m);
    if (gap_m <= kFacedM) ++contact.num_faced;
    ++num_behind;
  }
}

// Whether something nearer hides half or more of the beams that would meet a piece here, were it as it is in the column of this entry.
bool PairFinder::IsHidden(const ScanGrid& grid, const OutlineEntry& entry, int column) const {
  const float nearer_m = entry.near_point.range_m - kNearerM;
  if (nearest_m_[static_cast<std::size_t>(column)] >= nearer_m) return false;
  int num_hidden = 0;
  for (int ring = entry.min_ring; ring <= entry.max_ring; ++ring) num_hidden += grid.FarthestOfShot(ring, column) < nearer_m ? 1 : 0;
  return 2 * num_hidden > entry.max_ring - entry.min_ring;
}

// From where a piece ends in a column, on to the pieces beside it on both sides.
void PairFinder::LookBeside(const ScanGrid& grid, const PieceTable& pieces, const Reaches& reaches, const Shown& from) {
  const Steps& own = steps_[static_cast<std::size_t>(from.entry)];
  ++num_looks_;
  if (own.before == 1 && own.after == 1) return;
  const bool is_few = from.is_few;
  const double near_m = from.near.range_m;
  const double far_m = from.far.range_m;
  const double reach_m = is_few ? std::min(reaches.any.At(near_m), reaches.of_few.At(near_m)) : reaches.any.At(near_m);
  if (reach_m <= 0.0) return;
  const double across_m = std::max(1e-3, grid.column_step_rad() * near_m);
  const auto columns_of = [across_m](double length_m) {
    return static_cast<int>(std::min(double{kMostColumnsBeside}, std::ceil(length_m / across_m)));
  };
  const int num_steps = columns_of(reach_m);
  const auto window_of = [&](double hidden_m) {
    const auto widest_m = static_cast<float>(reach_m + hidden_m);
    // The nearer piece of a pair determines the search radius, so this piece's far edge bounds it.
    const double most_m = (is_few ? std::min(reaches.any.At(far_m), reaches.of_few.At(far_m)) : reaches.any.At(far_m)) + hidden_m;
    return Window{from.near.range_m - widest_m, from.far.range_m + widest_m, static_cast<float>(most_m * most_m * kRoundedUp), hidden_m};
  };
  const Window window = window_of(0.0);
  const OutlineEntry& entry = pieces.entries()[static_cast<std::size_t>(from.entry)];
  const int num_steps_to_few = is_few ? 0 : columns_of(reaches.to_few.At(far_m));
  for (const int direction : {1, -1}) {
    const int most_steps = std::min(kMostColumnsBeside, (direction > 0 ? own.after : own.before) - 1);
    if (is_few) {
      PairBeside(few_, window, from, {1, std::min(num_steps, most_steps), direction}, reaches.any, reaches.of_few, kMostFewBeside);
      continue;
    }
    // A larger piece looks for pieces of few returns, not the other way round.
    const auto is_hidden = [&](int step) { return IsHidden(grid, entry, grid.Wrap(entry.column + direction * step)); };
    const int last_step = std::min(num_steps, most_steps);
    int step = 1;
    if (reaches_behind_ && !is_counting_) {
      while (step <= last_step && !is_hidden(step)) ++step;
    }
    if (!reaches_behind_ || is_counting_ || step > last_step) {
      const Paired larger = PairBeside(larger_, window, from, {1, last_step, direction}, reaches.any, reaches.any, kMostLargerBeside);
      PairBeside(few_, window, from, {1, std::min(num_steps_to_few, larger.last_step), direction}, reaches.any, reaches.to_few, kMostFewBeside);
      continue;
    }
    int num_larger = 0;
    int num_few = 0;
    Window with_hidden = window;
    int num_hidden = 0;
    for (step = 1; step <= std::min(num_steps + num_hidden, most_steps) && num_larger < kMostLargerBeside; ++step) {
      ++num_looks_;
      const int column = grid.Wrap(entry.column + direction * step);
      if (is_hidden(step)) with_hidden = window_of(++num_hidden * across_m);
      if (num_few < kMostFewBeside && step <= num_steps_to_few) {
        num_few += PairInColumn(few_, column, with_hidden, from, reaches.any, reaches.to_few);
      }
      num_larger += PairInColumn(larger_, column, with_hidden, from, reaches.any, reaches.any);
    }
  }
}

// Meets pieces within both reaches, of which the first is longer by the hidden part of the gap, until so many have been met: then no further column
// is looked at.
PairFinder::Paired PairFinder::PairBeside(const Columns& columns, const Window& window, const Shown& from, const Walk& walk, const Reach& reach,
                                          const Reach& narrower, int most) {
  const int num_columns = columns.num_columns();
  Paired met{0, walk.last_step};
  if (walk.first_step > walk.last_step) return met;
  num_looks_ += walk.last_step - walk.first_step + 1;
  // First, without a branch, which are near in range.
  const auto meet = [&](int begin, int end) {
    if (begin >= end) return;
    const std::size_t begin_at = columns.begin_of_column[static_cast<std::size_t>(begin)];
    const std::size_t end_at = columns.begin_of_column[static_cast<std::size_t>(end)];
    num_looks_ += static_cast<std::int64_t>(end_at - begin_at);  // also where enough have been met: as if there were no seam
    if (is_counting_ || met.num >= most) return;
    near_.resize(std::max(near_.size(), end_at - begin_at));
    std::size_t num_near = 0;
    for (std::size_t at = begin_at; at < end_at; ++at) {
      near_[num_near] = columns.entry[at];
      num_near += (columns.near_m[at] <= window.farthest_m ? 1U : 0U) & (columns.far_m[at] >= window.nearest_m ? 1U : 0U);
    }
    std::int32_t column = -1;
    for (std::size_t i = 0; i < num_near; ++i) {
      const Shown& beside = shown_[static_cast<std::size_t>(near_[walk.direction > 0 ? i : num_near - 1 - i])];
      if (met.num >= most && beside.column != column) return;
      column = beside.column;
      if (!PairOne(window, from, beside, reach, narrower) || ++met.num != most) continue;
      const int steps = walk.direction * (column - from.column);
      met.last_step = steps > 0 ? steps : steps + num_columns;
    }
  };
  // Up to the seam of the circle, and beyond.
  if (walk.direction > 0) {
    const int first = from.column + walk.first_step;
    const int last = from.column + walk.last_step;
    meet(first, std::min(last + 1, num_columns));
    meet(std::max(first - num_columns, 0), last + 1 - num_columns);
  } else {
    const int first = from.column - walk.last_step;
    const int last = from.column - walk.first_step;
    meet(std::max(first, 0), last + 1);
    meet(first + num_columns, std::min(last + 1 + num_columns, num_columns));
  }
  return met;
}

// The same for one column, where a branch costs less than two passes through its pieces.
int PairFinder::PairInColumn(const Columns& columns, int column, const Window& window, const Shown& from, const Reach& reach, const Reach& narrower) {
  int num_met = 0;
  const std::size_t end = columns.begin_of_column[static_cast<std::size_t>(column) + 1];
  for (std::size_t at = columns.begin_of_column[static_cast<std::size_t>(column)]; at < end; ++at) {
    ++num_looks_;
    if (columns.near_m[at] > window.farthest_m) break;
    const Shown& beside = shown_[static_cast<std::size_t>(columns.entry[at])];
    if (columns.far_m[at] >= window.nearest_m && PairOne(window, from, beside, reach, narrower)) ++num_met;
  }
  return num_met;
}

bool PairFinder::PairOne(const Window& window, const Shown& from, const Shown& beside, const Reach& reach, const Reach& narrower) {
  // Least distance of the two pieces, seen from above, and between which returns.
  float squared_m2 = SquaredPlanDistance(from.near, beside.near);
  const LevelPoint* one = &from.near;
  const LevelPoint* other = &beside.near;
  const auto compare = [&](const LevelPoint& a, const LevelPoint& b) {
    const float other_m2 = SquaredPlanDistance(a, b);
    if (other_m2 >= squared_m2) return;
    squared_m2 = other_m2;
    one = &a;
    other = &b;
  };
  if (!beside.is_point) compare(from.near, beside.far);
  if (!from.is_point) compare(from.far, beside.near);
  if (!from.is_point && !beside.is_point) compare(from.far, beside.far);
  if (squared_m2 > window.most_m2) return false;
  const float least_range_m = std::min(one->range_m, other->range_m);
  double limit_m = reach.At(least_range_m) + window.hidden_m;
  if (&narrower != &reach) limit_m = std::min(limit_m, narrower.At(least_range_m));
  if (limit_m < 0.0 || squared_m2 > limit_m * limit_m) return false;
  if (one->range_m <= other->range_m) {
    RecordContact(from, *one, beside, *other, squared_m2);
  } else {
    RecordContact(beside, *other, from, *one, squared_m2);
  }
  return true;
}

PairFinder::Contact& PairFinder::At(std::int32_t one, std::int32_t other) {
  if (one > other) std::swap(one, other);
  std::size_t slot = FirstSlotOf(one, other);
  for (; slots_[slot] != kFree; slot = (slot + 1) % kSlots) {
    Contact& contact = contacts_[static_cast<std::size_t>(slots_[slot])];
    if (contact.one == one && contact.other == other) return contact;
  }
  slots_[slot] = static_cast<std::int32_t>(contacts_.size());
  contacts_.push_back({.one = one, .other = other});
  return contacts_.back();
}

PairFinder::Contact& PairFinder::RecordContact(const Shown& front, const LevelPoint& front_point, const Shown& back, const LevelPoint& back_point,
                                               float squared_gap_m2) {
  Contact& contact = At(front.piece, back.piece);
  // Of equal gaps the nearest.
  if (contact.front >= 0 &&
      (squared_gap_m2 > contact.squared_gap_m2 || (squared_gap_m2 == contact.squared_gap_m2 && front_point.range_m >= contact.lesser_range_m))) {
    return contact;
  }
  contact.squared_gap_m2 = squared_gap_m2;
  contact.lesser_range_m = front_point.range_m;
  contact.greater_range_m = back_point.range_m;
  contact.front = front.entry;
  contact.back = back.entry;
  return contact;
}

void PairFinder::Measure(const ScanGrid& grid, const PieceTable& pieces, const Contact& contact, PiecePair& pair) const {
  pair.one = contact.one;
  pair.other = contact.other;
  pair.gap_m = std::sqrt(contact.squared_gap_m2);
  const OutlineEntry& front = pieces.entries()[static_cast<std::size_t>(contact.front)];
  const OutlineEntry& back = pieces.entries()[static_cast<std::size_t>(contact.back)];
  const auto set = [&pair](PairFeature feature, double value) { pair.features[static_cast<std::size_t>(feature)] = FeatureOf(value); };

  // Where they come closest.
  const double range_m = contact.lesser_range_m;
  const double radial_m = std::max(0.0F, contact.greater_range_m - contact.lesser_range_m);
  int columns = std::abs(front.column - back.column);
  columns = std::min(columns, grid.num_columns() - columns);
  const double front_over_back_rad = grid.ElevationOf(front.min_ring) - grid.ElevationOf(back.max_ring);
  const double back_over_front_rad = grid.ElevationOf(back.min_ring) - grid.ElevationOf(front.max_ring);
  const double ring_step_rad = grid.RingStepAt(-lidar_above_water_m_ / std::max(1e-3, range_m));  // where water would be met
  set(PairFeature::kRange, range_m);
  set(PairFeature::kGap, pair.gap_m);
  set(PairFeature::kGapAngle, columns * RadToDeg(grid.column_step_rad()));
  set(PairFeature::kRadialGap, radial_m);
  set(PairFeature::kRadialGapRings, radial_m * lidar_above_water_m_ / std::max(1e-6, range_m * range_m * ring_step_rad));
  set(PairFeature::kRiseGap, RadToDeg(std::max({0.0, front_over_back_rad, back_over_front_rad})));
  set(PairFeature::kStepUp, back.min_height_m - front.max_height_m);

  const PieceFacts& a = pieces[pair.one];
  const PieceFacts& b = pieces[pair.other];
  const int lesser_arc = std::min(a.arc.num, b.arc.num);
  set(PairFeature::kOverlap, static_cast<double>(SharedColumns(a.arc, b.arc, grid.num_columns())) / lesser_arc);
  set(PairFeature::kFaced, static_cast<double>(contact.num_faced) / lesser_arc);

  // Beams between them: in columns between, and in the rings of the one that shows fewer there; of equals of the front.
  int num_beams = 0;
  int num_through = 0;
  int num_hidden = 0;
  if (columns > 1) {
    const int begin = grid.Wrap(front.column + columns) == back.column ? front.column : back.column;
    const OutlineEntry& lesser = front.max_ring - front.min_ring <= back.max_ring - back.min_ring ? front : back;
    const int num_first = std::min(columns - 1, kBeamColumns);
    const int num_last = std::min(columns - 1 - num_first, kBeamColumns);
    for (int ring = lesser.min_ring; ring <= lesser.max_ring; ++ring) {
      for (const auto& [first, num] : {std::pair{begin + 1, num_first}, std::pair{begin + columns - num_last, num_last}}) {
        int column = grid.Wrap(first);
        for (int i = 0; i < num; ++i) {
          const float beam_m = grid.FarthestOfShot(ring, column);
          num_through += (beam_m > contact.greater_range_m ? 1 : 0) & (beam_m < kNothingM ? 1 : 0);
          num_hidden += beam_m < contact.lesser_range_m ? 1 : 0;
          column = grid.Wrap(column + 1);
        }
        num_beams += num;
      }
    }
  }
  set(PairFeature::kSeenThrough, Over(num_through, num_beams));
  set(PairFeature::kHidden, Over(num_hidden, num_beams));
  set(PairFeature::kFreeGap, pair.gap_m * (1.0F - Over(num_hidden, num_beams)));

  const bool is_a_small = a.width_m < b.width_m || (a.width_m == b.width_m && a.num_returns < b.num_returns);
  const PieceFacts& small = is_a_small ? a : b;
  const PieceFacts& large = is_a_small ? b : a;
  set(PairFeature::kSmallAngle, grid.SquareDegreesOf(small.weight));
  set(PairFeature::kLargeAngle, grid.SquareDegreesOf(large.weight));
  set(PairFeature::kSmallWidth, small.width_m);
  set(PairFeature::kLargeWidth, large.width_m);
  set(PairFeature::kSmallDepth, small.max_range_m - small.min_range_m);
  set(PairFeature::kLargeDepth, large.max_range_m - large.min_range_m);
  const Eigen::Vector2d between_m = small.mean_m - large.mean_m;
  set(PairFeature::kUnionLength, std::sqrt(between_m.squaredNorm()) + small.radius_m + large.radius_m);
  set(PairFeature::kSmallTop, small.max_height_m + lidar_above_water_m_);
  set(PairFeature::kLargeTop, large.max_height_m + lidar_above_water_m_);
  set(PairFeature::kSmallBottom, small.min_height_m + lidar_above_water_m_);
  set(PairFeature::kLargeBottom, large.min_height_m + lidar_above_water_m_);
  set(PairFeature::kSmallFill, Over(small.num_returns, small.num_beams));
  set(PairFeature::kLargeFill, Over(large.num_returns, large.num_beams));
  set(PairFeature::kOffLine, std::abs(between_m.x() * large.direction.y() - between_m.y() * large.direction.x()));
  set(PairFeature::kLargeOff, large.off_m);
  set(PairFeature::kLargeLength, large.length_m);
  set(PairFeature::kSmallLength, small.length_m);
  set(PairFeature::kParallel, std::abs(small.direction.dot(large.direction)));
  set(PairFeature::kTopStep, std::abs(small.max_height_m - large.max_height_m));
  set(PairFeature::kBottomStep, std::abs(small.min_height_m - large.min_height_m));
}

}  // namespace lookout::segmenter
