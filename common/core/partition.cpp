#include "common/core/partition.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

namespace lookout {

namespace {

constexpr std::int32_t kNoEnd = -1;

std::size_t At(std::int32_t index) { return static_cast<std::size_t>(index); }

}  // namespace

// Of equal evidence and gaps the edge that was given first: only then do numbers decide.
bool Partition::IsWorse(const Best& a, const Best& b) {
  if (a.evidence != b.evidence) return a.evidence < b.evidence;
  if (a.gap_m != b.gap_m) return a.gap_m > b.gap_m;
  return a.edge > b.edge;
}

void Partition::Push(std::int32_t index, float threshold) {
  const Edge& edge = edges_[At(index)];
  const double evidence = EvidenceOf(edge);
  if (evidence <= threshold) return;
  heap_.push_back({evidence, edge.gap_m, index, edge.version});
  std::ranges::push_heap(heap_, IsWorse);
}

void Partition::Find(std::int32_t num_pieces, std::span<const EvidencePair> pairs, float threshold) {
  constexpr std::size_t kLeastSlots = 64;
  edges_.clear();
  ends_.resize(2 * pairs.size());
  any_end_.assign(At(num_pieces), kNoEnd);
  num_ends_.assign(At(num_pieces), 0);
  edge_slot_.assign(std::max(kLeastSlots, std::bit_ceil(2 * pairs.size())), kNoEnd);
  heap_.clear();
  heap_.reserve(2 * pairs.size());  // each once, and once more for each that becomes a part of it
  parent_.resize(At(num_pieces));
  std::iota(parent_.begin(), parent_.end(), 0);
  for (const EvidencePair& pair : pairs) {
    const auto index = static_cast<std::int32_t>(edges_.size());
    edges_.push_back({.group = {pair.one, pair.other}, .sum = pair.log_odds, .count = 1, .gap_m = pair.gap_m});
    Attach(2 * index, pair.one);
    Attach(2 * index + 1, pair.other);
    InsertEdge(index);
    Push(index, threshold);
  }
  while (!heap_.empty()) {
    const Best best = heap_.front();
    std::ranges::pop_heap(heap_, IsWorse);
    heap_.pop_back();
    const Edge& edge = edges_[At(best.edge)];
    if (edge.is_gone || edge.version != best.version) continue;
    const auto [one, other] = edge.group;
    const bool is_one_larger = num_ends_[At(one)] >= num_ends_[At(other)];
    Merge(is_one_larger ? one : other, is_one_larger ? other : one, threshold);
  }
  group_of_piece_.clear();
  number_of_root_.assign(At(num_pieces), kNoEnd);
  count_ = 0;
  for (std::int32_t piece = 0; piece < num_pieces; ++piece) {
    std::int32_t root = piece;
    while (parent_[At(root)] != root) root = parent_[At(root)] = parent_[At(parent_[At(root)])];
    std::int32_t& number = number_of_root_[At(root)];
    if (number == kNoEnd) number = count_++;
    group_of_piece_.push_back(number);
  }
}

void Partition::Merge(std::int32_t kept, std::int32_t gone, float threshold) {
  parent_[At(gone)] = kept;
  while (any_end_[At(gone)] != kNoEnd) {
    const std::int32_t end = any_end_[At(gone)];
    const std::int32_t index = end / 2;
    Edge& edge = edges_[At(index)];
    const std::int32_t neighbour = edge.group[At(1 - end % 2)];
    EraseEdge(index);
    Detach(end);
    const std::int32_t same = neighbour == kept ? kNoEnd : edge_slot_[SlotOf(kept, neighbour)];
    if (neighbour != kept && same == kNoEnd) {
      Attach(end, kept);
      InsertEdge(index);
      continue;  // its evidence is as it was
    }
    Detach(end ^ 1);
    edge.is_gone = true;
    if (same == kNoEnd) continue;
    Edge& into = edges_[At(same)];
    into.sum += edge.sum;
    into.count += edge.count;
    into.gap_m = std::min(into.gap_m, edge.gap_m);
    ++into.version;
    Push(same, threshold);
  }
}

void Partition::Attach(std::int32_t end, std::int32_t group) {
  edges_[At(end / 2)].group[At(end % 2)] = group;
  ++num_ends_[At(group)];
  std::int32_t& any = any_end_[At(group)];
  if (any == kNoEnd) {
    any = end;
    ends_[At(end)] = {end, end};
    return;
  }
  const std::int32_t last = ends_[At(any)].last;
  ends_[At(end)] = {last, any};
  ends_[At(last)].next = end;
  ends_[At(any)].last = end;
}

void Partition::Detach(std::int32_t end) {
  const std::int32_t group = edges_[At(end / 2)].group[At(end % 2)];
  --num_ends_[At(group)];
  const auto [last, next] = ends_[At(end)];
  ends_[At(last)].next = next;
  ends_[At(next)].last = last;
  if (any_end_[At(group)] == end) any_end_[At(group)] = next == end ? kNoEnd : next;
}

std::size_t Partition::FirstSlotOf(std::int32_t one, std::int32_t other) const {
  // Fibonacci hashing, as neighbours have numbers that follow each other.
  constexpr std::uint64_t kGolden = 0x9E37'79B9'7F4A'7C15U;
  const std::uint64_t key = static_cast<std::uint64_t>(std::min(one, other)) << 32U | static_cast<std::uint64_t>(std::max(one, other));
  return static_cast<std::size_t>((key * kGolden) >> 32U) & (edge_slot_.size() - 1);
}

// Where the edge between two groups is, or a free slot.
std::size_t Partition::SlotOf(std::int32_t one, std::int32_t other) const {
  std::size_t slot = FirstSlotOf(one, other);
  for (; edge_slot_[slot] != kNoEnd; slot = (slot + 1) & (edge_slot_.size() - 1)) {
    const auto& group = edges_[At(edge_slot_[slot])].group;
    if ((group[0] == one && group[1] == other) || (group[0] == other && group[1] == one)) break;
  }
  return slot;
}

void Partition::InsertEdge(std::int32_t edge) {
  const auto [one, other] = edges_[At(edge)].group;
  edge_slot_[SlotOf(one, other)] = edge;
}

// An edge behind it that could stand nearer to its first slot moves up, so that no look-up ends too soon.
void Partition::EraseEdge(std::int32_t edge) {
  const std::size_t mask = edge_slot_.size() - 1;
  const auto [one, other] = edges_[At(edge)].group;
  std::size_t hole = SlotOf(one, other);
  for (std::size_t slot = (hole + 1) & mask; edge_slot_[slot] != kNoEnd; slot = (slot + 1) & mask) {
    const auto [a, b] = edges_[At(edge_slot_[slot])].group;
    const std::size_t first = FirstSlotOf(a, b);
    if (((slot - first) & mask) < ((slot - hole) & mask)) continue;
    edge_slot_[hole] = edge_slot_[slot];
    hole = slot;
  }
  edge_slot_[hole] = kNoEnd;
}

}  // namespace lookout
