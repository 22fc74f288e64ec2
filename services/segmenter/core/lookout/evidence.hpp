// Log odds that something is so, as a fitted sum of small trees over named features.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/elementary.hpp"

namespace lookout::segmenter {

inline constexpr std::size_t kTreeDepth = 3;
inline constexpr std::size_t kMostFeatures = 64;
inline constexpr std::size_t kTreeLeaves = std::size_t{1} << kTreeDepth;

/// A question: is the feature above this value? An empty name: no question.
struct NamedSplit {
  std::string_view feature;
  float above = 0.0F;
};

/// An oblivious tree: all of its splits are asked, and the answers number the leaf. Bit i of the number is set where the answer to split i is yes.
struct NamedTree {
  std::array<NamedSplit, kTreeDepth> splits{};  // the first ones are used
  std::array<float, kTreeLeaves> log_odds{};    // the first 2^(number of splits) are used
};

/// A fitted sum as its text has it (config/schema/evidence.proto).
struct NamedSum {
  std::string_view name;
  std::span<const std::string_view> features;
  float bias = 0.0F;
  std::span<const NamedTree> trees;
};

/// The features of a sum: its name and the names of its features in the order of their values.
struct EvidenceLayout {
  std::string_view name;
  std::span<const std::string_view> features;
};

/// Log odds = bias + a leaf of each tree, added in their order in single precision: the same bits on every processor.
class Evidence {
 public:
  /// Knows nothing: 0 whatever the features.
  Evidence() = default;

  /// @throws std::invalid_argument "tree 3: ..." for a feature that the layout does not have; a layout of more than kMostFeatures
  Evidence(const NamedSum& sum, const EvidenceLayout& layout);

  /// @param features  [features of the layout]. Cost: about 1.5 ns a tree
  float Of(std::span<const float> features) const;

  /// The sums of a block of rows at once, equal to the bit. Their answers are vectors, and their sums do not wait for each other: a fraction of the
  /// time.
  static constexpr std::size_t kBlock = 16;
  using Block = std::array<const float*, kBlock>;  // each [features of the layout]
  std::array<float, kBlock> Of(const Block& features) const;

  /// The part that each feature adds to Base(), to answer "why?". The splits of a tree are asked one after the other; the change of the mean of the
  /// leaves that are still possible is the feature's.
  ///
  /// @param terms  [features of the layout] Base() and their sum are Of(features), but for rounding
  void Terms(std::span<const float> features, std::span<float> terms) const;

  /// The bias and the mean of the leaves of each tree.
  float Base() const;

  std::size_t num_trees() const { return trees_.size(); }
  bool operator==(const Evidence&) const = default;

 private:
  // Filled up to kTreeDepth splits with splits that nothing is above.
  struct Tree {
    std::array<float, kTreeLeaves> log_odds{};
    std::array<float, kTreeDepth> above{};
    std::array<std::uint16_t, kTreeDepth> feature{};
    std::uint16_t num_splits = 0;

    bool operator==(const Tree&) const = default;
  };

  float bias_ = 0.0F;
  std::size_t num_features_ = 0;
  std::vector<Tree> trees_;
};

/// A probability, 0 to 1, from its log odds, as it is published. The same bits on every processor: Exp is our own, and IEEE 754 rounds the rest.
inline float ProbabilityOf(float log_odds) { return static_cast<float>(1.0 / (1.0 + Exp(-double{log_odds}))); }

/// The sums that are compiled in, config/evidence/lookout.txtpb.
std::span<const NamedSum> DefaultSums();

/// One of them. @throws std::invalid_argument where there is none of that name, or its features are not those of the layout
Evidence DefaultEvidence(const EvidenceLayout& layout);

/// Why the features of a text are not those of a layout; empty = they are.
std::string FeatureFault(std::span<const std::string_view> features, const EvidenceLayout& layout);

}  // namespace lookout::segmenter
