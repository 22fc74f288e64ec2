// From evidence for pairs to groups: greedy contraction with mean linkage.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lookout::segmenter {

/// Evidence that two pieces are one.
struct EvidencePair {
  std::int32_t one = 0;
  std::int32_t other = 0;
  float log_odds = 0.0F;
  float gap_m = 0.0F;  // of equal evidence, the least gap comes first
};

/// Merges the two groups with the greatest mean of the log odds of the pairs between them, again and again, while that is above a threshold. Pairs
/// that are not given are no evidence, neither for nor against.
class Partition {
 public:
  /// @param pairs  each pair at most once
  /// Cost: about proportional to the pairs. Allocates nothing once it has seen as many.
  void Find(std::int32_t num_pieces, std::span<const EvidencePair> pairs, float threshold);

  /// [pieces] group of each, numbered in the order of their first piece.
  std::span<const std::int32_t> group_of_piece() const { return group_of_piece_; }
  std::int32_t count() const { return count_; }

 private:
  struct Edge {
    std::int32_t one = 0;
    std::int32_t other = 0;
    double sum = 0.0;
    std::int32_t count = 0;
    float gap_m = 0.0F;
    std::int32_t version = 0;
    bool is_gone = false;

    double mean() const { return sum / count; }
  };
  struct Best {
    double mean;
    float gap_m;
    std::int32_t edge;
    std::int32_t version;
  };

  static bool IsWorse(const Best& a, const Best& b);
  void Push(std::int32_t edge, float threshold);
  void Merge(std::int32_t kept, std::int32_t gone, float threshold);

  std::vector<Edge> edges_;
  std::vector<std::vector<std::int32_t>> edges_of_;  // [pieces]
  std::vector<Best> heap_;
  std::vector<std::int32_t> edge_to_;  // [pieces] scratch
  std::vector<std::int32_t> parent_;   // [pieces]
  std::vector<std::int32_t> group_of_piece_;
  std::int32_t count_ = 0;
};

}  // namespace lookout::segmenter
