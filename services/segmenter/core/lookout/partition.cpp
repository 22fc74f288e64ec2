#include "services/segmenter/core/lookout/partition.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace lookout::segmenter {

namespace {

constexpr std::int32_t kNone = -1;

std::size_t At(std::int32_t index) { return static_cast<std::size_t>(index); }

}  // namespace

// Of equal means and gaps the edge that was given first: only then do numbers decide.
bool Partition::IsWorse(const Best& a, const Best& b) {
  if (a.mean != b.mean) return a.mean < b.mean;
  if (a.gap_m != b.gap_m) return a.gap_m > b.gap_m;
  return a.edge > b.edge;
}

void Partition::Push(std::int32_t index, float threshold) {
  const Edge& edge = edges_[At(index)];
  if (edge.mean() <= threshold) return;
  heap_.push_back({edge.mean(), edge.gap_m, index, edge.version});
  std::ranges::push_heap(heap_, IsWorse);
}

void Partition::Find(std::int32_t num_pieces, std::span<const EvidencePair> pairs, float threshold) {
  edges_.clear();
  heap_.clear();
  if (edges_of_.size() < At(num_pieces)) edges_of_.resize(At(num_pieces));
  for (auto& edges : edges_of_) edges.clear();
  edge_to_.assign(At(num_pieces), kNone);
  parent_.resize(At(num_pieces));
  std::iota(parent_.begin(), parent_.end(), 0);
  for (const EvidencePair& pair : pairs) {
    const auto index = static_cast<std::int32_t>(edges_.size());
    edges_.push_back({.one = pair.one, .other = pair.other, .sum = pair.log_odds, .count = 1, .gap_m = pair.gap_m});
    edges_of_[At(pair.one)].push_back(index);
    edges_of_[At(pair.other)].push_back(index);
    Push(index, threshold);
  }
  while (!heap_.empty()) {
    const Best best = heap_.front();
    std::ranges::pop_heap(heap_, IsWorse);
    heap_.pop_back();
    const Edge& edge = edges_[At(best.edge)];
    if (edge.is_gone || edge.version != best.version) continue;
    const bool is_one_larger = edges_of_[At(edge.one)].size() >= edges_of_[At(edge.other)].size();
    Merge(is_one_larger ? edge.one : edge.other, is_one_larger ? edge.other : edge.one, threshold);
  }
  group_of_piece_.assign(At(num_pieces), kNone);
  count_ = 0;
  const auto root_of = [this](std::int32_t piece) {
    while (parent_[At(piece)] != piece) piece = parent_[At(piece)] = parent_[At(parent_[At(piece)])];
    return piece;
  };
  for (std::int32_t piece = 0; piece < num_pieces; ++piece) edge_to_[At(piece)] = kNone;  // here: number of the root's group
  for (std::int32_t piece = 0; piece < num_pieces; ++piece) {
    std::int32_t& number = edge_to_[At(root_of(piece))];
    if (number == kNone) number = count_++;
    group_of_piece_[At(piece)] = number;
  }
}

void Partition::Merge(std::int32_t kept, std::int32_t gone, float threshold) {
  parent_[At(gone)] = kept;
  auto& edges_of_kept = edges_of_[At(kept)];
  for (const std::int32_t index : edges_of_kept) {
    Edge& edge = edges_[At(index)];
    const std::int32_t neighbour = edge.one == kept ? edge.other : edge.one;
    if (neighbour == gone) {
      edge.is_gone = true;
    } else {
      edge_to_[At(neighbour)] = index;
    }
  }
  std::erase_if(edges_of_kept, [this](std::int32_t index) { return edges_[At(index)].is_gone; });
  for (const std::int32_t index : edges_of_[At(gone)]) {
    Edge& edge = edges_[At(index)];
    if (edge.is_gone) continue;
    std::int32_t& end = edge.one == gone ? edge.one : edge.other;
    const std::int32_t neighbour = edge.one == gone ? edge.other : edge.one;
    const std::int32_t same = edge_to_[At(neighbour)];
    if (same == kNone) {
      end = kept;
      edges_of_kept.push_back(index);
      continue;  // its mean is as it was
    }
    Edge& into = edges_[At(same)];
    into.sum += edge.sum;
    into.count += edge.count;
    into.gap_m = std::min(into.gap_m, edge.gap_m);
    ++into.version;
    edge.is_gone = true;
    std::erase(edges_of_[At(neighbour)], index);
    Push(same, threshold);
  }
  edges_of_[At(gone)].clear();
  for (const std::int32_t index : edges_of_kept) {
    const Edge& edge = edges_[At(index)];
    edge_to_[At(edge.one == kept ? edge.other : edge.one)] = kNone;
  }
}

}  // namespace lookout::segmenter
