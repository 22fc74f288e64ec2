// From evidence for pairs to groups: greedy contraction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lookout {

/// Evidence that two pieces are one.
struct EvidencePair {
  std::int32_t one = 0;
  std::int32_t other = 0;
  float log_odds = 0.0F;
  float gap_m = 0.0F;  // of equal evidence, the least gap comes first
};

/// The evidence that two groups are one: the mean or the sum of the evidence of the pairs between them.
enum class Linkage { kMean, kSum };

/// Merges the two groups with the most evidence between them, again and again, while that is above a threshold. Pairs that are not given are no
/// evidence, neither for nor against.
class Partition {
 public:
  explicit Partition(Linkage linkage = Linkage::kMean) : linkage_(linkage) {}

  /// @param pairs  each pair at most once
  /// Cost: E log E for E pairs: the group with fewer neighbours moves to the other. Allocates nothing once it has seen as many of both.
  void Find(std::int32_t num_pieces, std::span<const EvidencePair> pairs, float threshold);

  /// [pieces] group of each, numbered in the order of their first piece.
  std::span<const std::int32_t> group_of_piece() const { return group_of_piece_; }
  std::int32_t count() const { return count_; }

 private:
  // Between two groups; its two ends are in the lists of these.
  struct Edge {
    std::array<std::int32_t, 2> group{};
    double sum = 0.0;
    std::int32_t count = 0;
    float gap_m = 0.0F;
    std::int32_t version = 0;
    bool is_gone = false;
  };
  // End of edge i / 2 at its group i % 2, in the ring of the ends at that group.
  struct End {
    std::int32_t last = 0;
    std::int32_t next = 0;
  };
  struct Best {
    double evidence;
    float gap_m;
    std::int32_t edge;
    std::int32_t version;
  };

  static bool IsWorse(const Best& a, const Best& b);
  double EvidenceOf(const Edge& edge) const { return linkage_ == Linkage::kMean ? edge.sum / edge.count : edge.sum; }
  void Push(std::int32_t edge, float threshold);
  void Merge(std::int32_t kept, std::int32_t gone, float threshold);
  void Attach(std::int32_t end, std::int32_t group);
  void Detach(std::int32_t end);
  // The edges by their groups.
  std::size_t FirstSlotOf(std::int32_t one, std::int32_t other) const;
  std::size_t SlotOf(std::int32_t one, std::int32_t other) const;
  void InsertEdge(std::int32_t edge);
  void EraseEdge(std::int32_t edge);

  Linkage linkage_;
  std::vector<Edge> edges_;
  std::vector<End> ends_;                // [2 edges]
  std::vector<std::int32_t> any_end_;    // [pieces] an end at the group; -1 = there is none
  std::vector<std::int32_t> num_ends_;   // [pieces]
  std::vector<std::int32_t> edge_slot_;  // an open hash table: index into edges_, or -1
  std::vector<Best> heap_;
  std::vector<std::int32_t> number_of_root_;  // [pieces] scratch
  std::vector<std::int32_t> parent_;          // [pieces]
  std::vector<std::int32_t> group_of_piece_;
  std::int32_t count_ = 0;
};

}  // namespace lookout
