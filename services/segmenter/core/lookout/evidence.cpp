#include "services/segmenter/core/lookout/evidence.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace lookout::segmenter {

namespace {

// Feature by feature.
using BlockValues = std::array<std::array<float, Evidence::kBlock>, kMostFeatures>;

#ifdef __x86_64__
// The leaves of a tree fill a register, from which each of half a block takes its own: comparisons, a look-up and a sum in the same order, so the
// same bits. The sums of the two halves do not wait for each other.
template <typename Tree>
__attribute__((target("avx2"))) void AddLeavesWithAvx2(std::span<const Tree> trees, const BlockValues& values,
                                                       std::array<float, Evidence::kBlock>& sums) {
  constexpr std::size_t kHalf = 8;
  static_assert(Evidence::kBlock == 2 * kHalf && kTreeLeaves == 8 && kTreeDepth == 3);
  __m256 sum[2] = {_mm256_loadu_ps(sums.data()), _mm256_loadu_ps(sums.data() + kHalf)};
  for (const Tree& tree : trees) {
    const float* const value[kTreeDepth] = {values[tree.feature[0]].data(), values[tree.feature[1]].data(), values[tree.feature[2]].data()};
    const __m256 above[kTreeDepth] = {_mm256_set1_ps(tree.above[0]), _mm256_set1_ps(tree.above[1]), _mm256_set1_ps(tree.above[2])};
    const __m256 leaves = _mm256_loadu_ps(tree.log_odds.data());
#pragma GCC unroll 2
    for (std::size_t half = 0; half < 2; ++half) {
      const __m256 first = _mm256_cmp_ps(_mm256_loadu_ps(value[0] + half * kHalf), above[0], _CMP_GT_OQ);
      const __m256 second = _mm256_cmp_ps(_mm256_loadu_ps(value[1] + half * kHalf), above[1], _CMP_GT_OQ);
      const __m256 third = _mm256_cmp_ps(_mm256_loadu_ps(value[2] + half * kHalf), above[2], _CMP_GT_OQ);
      const __m256i leaf = _mm256_or_si256(_mm256_and_si256(_mm256_castps_si256(first), _mm256_set1_epi32(1)),
                                           _mm256_or_si256(_mm256_and_si256(_mm256_castps_si256(second), _mm256_set1_epi32(2)),
                                                           _mm256_and_si256(_mm256_castps_si256(third), _mm256_set1_epi32(4))));
      sum[half] = _mm256_add_ps(sum[half], _mm256_permutevar8x32_ps(leaves, leaf));
    }
  }
  _mm256_storeu_ps(sums.data(), sum[0]);
  _mm256_storeu_ps(sums.data() + kHalf, sum[1]);
}
#endif

}  // namespace

Evidence::Evidence(const NamedSum& sum, const EvidenceLayout& layout) : bias_(sum.bias), num_features_(layout.features.size()) {
  if (num_features_ > kMostFeatures) throw std::invalid_argument("a layout of too many features");
  trees_.reserve(sum.trees.size());
  for (const auto& named : sum.trees) {
    Tree tree;
    tree.above.fill(std::numeric_limits<float>::infinity());
    for (const auto& split : named.splits) {
      if (split.feature.empty()) break;
      const auto feature = std::ranges::find(layout.features, split.feature);
      if (feature == layout.features.end()) {
        throw std::invalid_argument("tree " + std::to_string(trees_.size() + 1) + ": there is no feature " + std::string(split.feature));
      }
      tree.feature[tree.num_splits] = static_cast<std::uint16_t>(feature - layout.features.begin());
      tree.above[tree.num_splits] = split.above;
      ++tree.num_splits;
    }
    std::copy_n(named.log_odds.begin(), std::size_t{1} << tree.num_splits, tree.log_odds.begin());
    trees_.push_back(tree);
  }
}

float Evidence::Of(std::span<const float> features) const {
  float sum = bias_;
  for (const auto& tree : trees_) {
    unsigned leaf = 0;
    for (std::size_t i = 0; i < kTreeDepth; ++i) leaf |= static_cast<unsigned>(features[tree.feature[i]] > tree.above[i]) << i;
    sum += tree.log_odds[leaf];
  }
  return sum;
}

std::array<float, Evidence::kBlock> Evidence::Of(const Block& features) const {
  BlockValues values;
  for (std::size_t f = 0; f < num_features_; ++f) {
    for (std::size_t one = 0; one < kBlock; ++one) values[f][one] = features[one][f];
  }
  std::array<float, kBlock> sums{};
  sums.fill(bias_);
#ifdef __x86_64__
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (has_avx2) {
    AddLeavesWithAvx2(std::span(trees_), values, sums);
    return sums;
  }
#endif
  for (const auto& tree : trees_) {
    static_assert(kTreeDepth == 3);
    const float* const first = values[tree.feature[0]].data();
    const float* const second = values[tree.feature[1]].data();
    const float* const third = values[tree.feature[2]].data();
    std::array<std::int32_t, kBlock> leaf{};
    for (std::size_t one = 0; one < kBlock; ++one) {
      leaf[one] = (first[one] > tree.above[0] ? 1 : 0) | (second[one] > tree.above[1] ? 2 : 0) | (third[one] > tree.above[2] ? 4 : 0);
    }
    for (std::size_t one = 0; one < kBlock; ++one) sums[one] += tree.log_odds[static_cast<std::size_t>(leaf[one])];
  }
  return sums;
}

void Evidence::Terms(std::span<const float> features, std::span<float> terms) const {
  std::ranges::fill(terms, 0.0F);
  for (const auto& tree : trees_) {
    // Each answer halves the leaves, the last split's first, so that the remaining leaves stand together.
    std::size_t first = 0;
    std::size_t count = std::size_t{1} << tree.num_splits;
    const auto mean = [&] {
      float sum = 0.0F;
      for (std::size_t i = first; i < first + count; ++i) sum += tree.log_odds[i];
      return sum / static_cast<float>(count);
    };
    float before = mean();
    for (std::size_t i = tree.num_splits; i-- > 0;) {
      count /= 2;
      if (features[tree.feature[i]] > tree.above[i]) first += count;
      const float after = mean();
      terms[tree.feature[i]] += after - before;
      before = after;
    }
  }
}

float Evidence::Base() const {
  float base = bias_;
  for (const auto& tree : trees_) {
    const std::size_t count = std::size_t{1} << tree.num_splits;
    float sum = 0.0F;
    for (std::size_t i = 0; i < count; ++i) sum += tree.log_odds[i];
    base += sum / static_cast<float>(count);
  }
  return base;
}

std::string FeatureFault(std::span<const std::string_view> features, const EvidenceLayout& layout) {
  for (const auto& feature : features) {
    if (std::ranges::count(features, feature) > 1) return "has " + std::string(feature) + " twice";
    if (std::ranges::find(layout.features, feature) == layout.features.end()) return "there is no feature " + std::string(feature);
  }
  for (const auto& feature : layout.features) {
    if (std::ranges::find(features, feature) == features.end()) return "lacks " + std::string(feature);
  }
  return {};
}

Evidence DefaultEvidence(const EvidenceLayout& layout) {
  const auto sums = DefaultSums();
  const auto sum = std::ranges::find(sums, layout.name, &NamedSum::name);
  const std::string name(layout.name);
  if (sum == sums.end()) throw std::invalid_argument("no evidence is compiled in for " + name);
  if (const auto fault = FeatureFault(sum->features, layout); !fault.empty()) {
    throw std::invalid_argument("the evidence that is compiled in for " + name + " is of other features: " + fault);
  }
  return {*sum, layout};
}

}  // namespace lookout::segmenter
