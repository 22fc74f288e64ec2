#include "services/segmenter/core/lookout/pairs.hpp"

#include <algorithm>
#include <cmath>

namespace lookout::segmenter {

namespace {

constexpr std::int32_t kFree = -1;
constexpr int kMostColumnsBeside = 160;
constexpr float kFacedM = 1.0F;
constexpr float kNearerM = 0.5F;
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
// The same of what stands behind in one column.
constexpr int kMostBehind = 32;
// Columns at each end of a gap in which its beams are looked at.
constexpr int kBeamColumns = 16;
constexpr std::size_t kLeastSlots = 1024;

// Least distance between what two pieces show in two columns, seen from above, and the returns that it is between.
struct Closest {
  float squared_m2;
  const LevelPoint* one;
  const LevelPoint* other;
};

Closest ClosestOf(const OutlineEntry& one, const OutlineEntry& other) {
  Closest closest{SquaredPlanDistance(one.near_point, other.near_point), &one.near_point, &other.near_point};
  const auto look_at = [&closest](const LevelPoint& a, const LevelPoint& b) {
    const float squared_m2 = SquaredPlanDistance(a, b);
    if (squared_m2 < closest.squared_m2) closest = {squared_m2, &a, &b};
  };
  look_at(one.near_point, other.far_point);
  look_at(one.far_point, other.near_point);
  look_at(one.far_point, other.far_point);
  return closest;
}

// Whether something nearer hides half or more of the beams that would meet a piece here, were it as it is in the column of this entry.
bool IsHidden(const ScanGrid& grid, const OutlineEntry& entry, int column) {
  int num_hidden = 0;
  for (int ring = entry.min_ring; ring <= entry.max_ring; ++ring) {
    num_hidden += grid.FarthestOfShot(ring, column) < entry.near_point.range_m - kNearerM ? 1 : 0;
  }
  return 2 * num_hidden > entry.max_ring - entry.min_ring;
}

bool IsFew(const PieceFacts& piece) { return piece.num_returns <= kFewReturns; }

float Over(double value, double by) { return static_cast<float>(by > 0.0 ? value / by : 0.0); }

}  // namespace

std::span<const PiecePair> PairFinder::Find(const ScanGrid& grid, const PieceTable& pieces, const Reach& reach, bool reaches_behind) {
  reaches_behind_ = reaches_behind;
  FindContacts(grid, pieces, reach);
  pairs_.resize(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) Measure(grid, pieces, contacts_[i], pairs_[i]);
  return pairs_;
}

void PairFinder::SortByKind(const PieceTable& pieces, int num_columns) {
  few_.Clear();
  larger_.Clear();
  for (int column = 0; column < num_columns; ++column) {
    for (const OutlineEntry& entry : pieces.InColumn(column)) (IsFew(pieces[entry.piece]) ? few_ : larger_).entries.push_back(&entry);
    few_.begin_of_column.push_back(few_.entries.size());
    larger_.begin_of_column.push_back(larger_.entries.size());
  }
}

void PairFinder::FindContacts(const ScanGrid& grid, const PieceTable& pieces, const Reach& reach) {
  contacts_.clear();
  slots_.assign(std::max(kLeastSlots, slots_.size()), kFree);
  SortByKind(pieces, grid.num_columns());
  for (int column = 0; column < grid.num_columns(); ++column) {
    const auto seen = pieces.InColumn(column);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const OutlineEntry& front = seen[i];
      const auto reach_m = static_cast<float>(reach.At(front.far_point.range_m));
      const auto reach_of_few_m = static_cast<float>(kReachOfFew.At(front.far_point.range_m));
      const auto reach_to_few_m = static_cast<float>(kReachToFew.At(front.far_point.range_m));
      const bool is_few = IsFew(pieces[front.piece]);
      int num_behind = 0;
      for (std::size_t j = i + 1; j < seen.size() && num_behind < kMostBehind; ++j) {
        const OutlineEntry& back = seen[j];
        const float gap_m = std::max(0.0F, back.near_point.range_m - front.far_point.range_m);
        if (gap_m > reach_m) break;
        const bool is_back_few = IsFew(pieces[back.piece]);
        if (is_few && is_back_few && gap_m >= reach_of_few_m) continue;
        if ((is_few || is_back_few) && gap_m > reach_to_few_m) continue;
        Contact& contact = Meet(front, front.far_point, back, back.near_point, gap_m * gap_m);
        if (gap_m <= kFacedM) ++contact.num_faced;
        ++num_behind;
      }
      LookBeside(grid, reach, front, is_few, 1);
      LookBeside(grid, reach, front, is_few, -1);
    }
  }
}

// From where a piece ends in a column, on to what stands beside it.
void PairFinder::LookBeside(const ScanGrid& grid, const Reach& reach, const OutlineEntry& entry, bool is_few, int direction) {
  const double near_m = entry.near_point.range_m;
  const auto reach_m = static_cast<float>(is_few ? std::min(reach.At(near_m), kReachOfFew.At(near_m)) : reach.At(near_m));
  if (reach_m <= 0.0F) return;
  const double across_m = std::max(1e-3, grid.column_step_rad() * near_m);
  const auto columns_of = [across_m](double length_m) {
    return static_cast<int>(std::min(double{kMostColumnsBeside}, std::ceil(length_m / across_m)));
  };
  const int num_steps = columns_of(reach_m);
  const int num_steps_to_few = is_few ? num_steps : columns_of(kReachToFew.At(entry.far_point.range_m));
  int num_hidden = 0;
  int num_few = 0;
  int num_larger = 0;
  for (int step = 1; step <= num_steps + num_hidden && step <= kMostColumnsBeside; ++step) {
    const int column = grid.Wrap(entry.column + direction * step);
    if (reaches_behind_ && !is_few && IsHidden(grid, entry, column)) ++num_hidden;
    const auto of_its_kind = (is_few ? few_ : larger_).InColumn(column);
    if (std::ranges::any_of(of_its_kind, [&](const OutlineEntry* beside) { return beside->piece == entry.piece; })) return;
    const auto widest_m = static_cast<float>(reach_m + num_hidden * across_m);
    const auto look_at = [&](std::span<const OutlineEntry* const> seen, const Reach* narrower) {
      int num_met = 0;
      for (const OutlineEntry* beside : seen) {
        if (beside->near_point.range_m > entry.far_point.range_m + widest_m) break;
        if (beside->far_point.range_m < entry.near_point.range_m - widest_m) continue;
        const Closest closest = ClosestOf(entry, *beside);
        const float least_range_m = std::min(closest.one->range_m, closest.other->range_m);
        double limit_m = reach.At(least_range_m) + num_hidden * across_m;
        if (narrower != nullptr) limit_m = std::min(limit_m, narrower->At(least_range_m));
        if (limit_m < 0.0 || closest.squared_m2 > limit_m * limit_m) continue;
        ++num_met;
        if (closest.one->range_m <= closest.other->range_m) {
          Meet(entry, *closest.one, *beside, *closest.other, closest.squared_m2);
        } else {
          Meet(*beside, *closest.other, entry, *closest.one, closest.squared_m2);
        }
      }
      return num_met;
    };
    // What is larger looks for what is of few returns, not the other way round.
    if (num_few < kMostFewBeside && step <= num_steps_to_few) num_few += look_at(few_.InColumn(column), is_few ? &kReachOfFew : &kReachToFew);
    if (!is_few) num_larger += look_at(larger_.InColumn(column), nullptr);
    if (num_larger >= kMostLargerBeside || (is_few && num_few >= kMostFewBeside)) return;
  }
}

std::size_t PairFinder::SlotOf(std::int32_t one, std::int32_t other) const {
  // Fibonacci hashing: pieces that are neighbours have numbers that follow each other, and must not crowd neighbouring slots.
  constexpr std::uint64_t kGolden = 0x9E37'79B9'7F4A'7C15U;
  const std::uint64_t key = static_cast<std::uint64_t>(one) << 32U | static_cast<std::uint64_t>(other);
  return static_cast<std::size_t>((key * kGolden) >> 32U) & (slots_.size() - 1);
}

PairFinder::Contact& PairFinder::At(std::int32_t one, std::int32_t other) {
  if (one > other) std::swap(one, other);
  if (2 * contacts_.size() >= slots_.size()) {
    slots_.assign(2 * slots_.size(), kFree);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      std::size_t slot = SlotOf(contacts_[i].one, contacts_[i].other);
      while (slots_[slot] != kFree) slot = (slot + 1) % slots_.size();
      slots_[slot] = static_cast<std::int32_t>(i);
    }
  }
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = SlotOf(one, other);
  for (; slots_[slot] != kFree; slot = (slot + 1) & mask) {
    Contact& contact = contacts_[static_cast<std::size_t>(slots_[slot])];
    if (contact.one == one && contact.other == other) return contact;
  }
  slots_[slot] = static_cast<std::int32_t>(contacts_.size());
  contacts_.push_back({.one = one, .other = other});
  return contacts_.back();
}

PairFinder::Contact& PairFinder::Meet(const OutlineEntry& front, const LevelPoint& front_point, const OutlineEntry& back,
                                      const LevelPoint& back_point, float squared_gap_m2) {
  Contact& contact = At(front.piece, back.piece);
  // Of equal gaps the nearest.
  if (contact.front != nullptr &&
      (squared_gap_m2 > contact.squared_gap_m2 || (squared_gap_m2 == contact.squared_gap_m2 && front_point.range_m >= contact.lesser_range_m))) {
    return contact;
  }
  contact.squared_gap_m2 = squared_gap_m2;
  contact.lesser_range_m = front_point.range_m;
  contact.greater_range_m = back_point.range_m;
  contact.front = &front;
  contact.back = &back;
  return contact;
}

void PairFinder::Measure(const ScanGrid& grid, const PieceTable& pieces, const Contact& contact, PiecePair& pair) const {
  pair.one = contact.one;
  pair.other = contact.other;
  pair.gap_m = std::sqrt(contact.squared_gap_m2);
  const OutlineEntry& front = *contact.front;
  const OutlineEntry& back = *contact.back;
  const auto set = [&pair](PairFeature feature, double value) { pair.features[static_cast<std::size_t>(feature)] = FeatureOf(value); };

  // Where they come closest.
  const double range_m = contact.lesser_range_m;
  const double radial_m = std::max(0.0F, contact.greater_range_m - contact.lesser_range_m);
  int columns = std::abs(front.column - back.column);
  columns = std::min(columns, grid.num_columns() - columns);
  const int ring_gap = std::max({0, front.min_ring - back.max_ring, back.min_ring - front.max_ring});
  set(PairFeature::kRange, range_m);
  set(PairFeature::kGap, pair.gap_m);
  set(PairFeature::kGapColumns, columns);
  set(PairFeature::kRadialGap, radial_m);
  set(PairFeature::kRadialGapRings, radial_m * lidar_above_water_m_ / std::max(1e-6, range_m * range_m * grid.ring_step_rad()));
  set(PairFeature::kRingGap, ring_gap);
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
    const bool is_on = grid.Wrap(front.column + columns) == back.column;
    const int first = is_on ? front.column : back.column;
    const OutlineEntry& lesser = front.max_ring - front.min_ring <= back.max_ring - back.min_ring ? front : back;
    for (int ring = lesser.min_ring; ring <= lesser.max_ring; ++ring) {
      for (int step = 1; step < columns; ++step) {
        if (step == kBeamColumns + 1) step = std::max(step, columns - kBeamColumns);
        const float beam_m = grid.FarthestOfShot(ring, grid.Wrap(first + step));
        ++num_beams;
        if (std::isinf(beam_m)) continue;
        num_through += beam_m > contact.greater_range_m ? 1 : 0;
        num_hidden += beam_m < contact.lesser_range_m ? 1 : 0;
      }
    }
  }
  set(PairFeature::kSeenThrough, Over(num_through, num_beams));
  set(PairFeature::kHidden, Over(num_hidden, num_beams));
  set(PairFeature::kFreeGap, pair.gap_m * (1.0F - Over(num_hidden, num_beams)));

  const bool is_a_small = a.width_m < b.width_m || (a.width_m == b.width_m && a.num_returns < b.num_returns);
  const PieceFacts& small = is_a_small ? a : b;
  const PieceFacts& large = is_a_small ? b : a;
  set(PairFeature::kSmallReturns, small.num_returns);
  set(PairFeature::kLargeReturns, large.num_returns);
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
