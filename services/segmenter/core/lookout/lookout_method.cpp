#include "services/segmenter/core/lookout/lookout_method.hpp"

#include <algorithm>

namespace lookout::segmenter {

namespace {

constexpr double kLinkedColumns = 2.8;  // LookoutParams::link grows by as many columns of 0.2 degrees

// Hands on all, in order and in blocks; the last block is filled up with the first of its own.
template <typename One, typename FeaturesOf, typename Take>
void ForBlocks(std::span<const One> all, FeaturesOf features_of, Take take) {
  for (std::size_t first = 0; first < all.size(); first += Evidence::kBlock) {
    const auto some = all.subspan(first, std::min(Evidence::kBlock, all.size() - first));
    Evidence::Block block;
    block.fill(features_of(some.front()));
    std::ranges::transform(some, block.begin(), features_of);
    take(some, block);
  }
}

}  // namespace

std::array<Evidence, kNumSums> DefaultEvidences() {
  std::array<Evidence, kNumSums> evidence;
  std::ranges::transform(kEvidenceLayouts, evidence.begin(), DefaultEvidence);
  return evidence;
}

Reach LinkFor(Reach link, double column_step_rad) {
  link.per_range = std::max(link.per_range, kLinkedColumns * column_step_rad);
  return link;
}

void LookoutMethod::Group(const Scan& scan, std::span<const Return> returns) {
  FindPieces(scan, returns);
  for (std::size_t merge = 0; merge < kNumMerges; ++merge) Merge(merge, FindPairs(merge));
  Judge(MeasureGroups());
}

void LookoutMethod::FindPieces(const Scan& scan, std::span<const Return> returns) {
  grid_.Fill(scan, returns, R_vessel_lidar_);
  tight_.Find(grid_, LinkFor(params_.link, grid_.column_step_rad()));
  pieces_.Build(grid_, tight_.of_return(), tight_.count());
  pair_finder_.BeginScan();
}

std::span<const PiecePair> LookoutMethod::FindPairs(std::size_t merge) {
  return pair_finder_.Find(grid_, pieces_, params_.merges[merge].reach, params_.merges[merge].reaches_behind);
}

void LookoutMethod::Merge(std::size_t merge, std::span<const PiecePair> pairs) {
  const Evidence& evidence = params_.evidence[merge];
  evidence_.clear();
  ForBlocks(
      pairs, [](const PiecePair& pair) { return pair.features.data(); },
      [&](std::span<const PiecePair> some, const Evidence::Block& block) {
        const auto log_odds = evidence.Of(block);
        for (std::size_t i = 0; i < some.size(); ++i) evidence_.push_back({some[i].one, some[i].other, log_odds[i], some[i].gap_m});
      });
  partition_.Find(pieces_.size(), evidence_, static_cast<float>(params_.merges[merge].log_odds));
  pieces_.Merge(grid_, partition_.group_of_piece(), partition_.count());
}

std::span<const PieceFeatures> LookoutMethod::MeasureGroups() {
  features_ = piece_measurer_.Measure(grid_, pieces_, params_.lidar_above_water_m);
  return features_;
}

void LookoutMethod::Judge(std::span<const PieceFeatures> features) {
  groups_.count = pieces_.size();
  groups_.of_return.assign(pieces_.of_returns().begin(), pieces_.of_returns().end());
  facts_.clear();
  judged_.clear();
  for (std::int32_t group = 0; group < pieces_.size(); ++group) {
    const PieceFacts& piece = pieces_[group];
    facts_.push_back({.seen_share = static_cast<float>(piece.num_columns) / static_cast<float>(piece.arc.num)});
    if (IsJudged(pieces_, group)) judged_.push_back(group);
  }
  ForBlocks(
      std::span<const std::int32_t>(judged_), [features](std::int32_t group) { return features[static_cast<std::size_t>(group)].data(); },
      [&](std::span<const std::int32_t> some, const Evidence::Block& block) {
        const auto land_log_odds = params_.evidence[kLandSum].Of(block);
        const auto thing_log_odds = params_.evidence[kThingSum].Of(block);
        for (std::size_t i = 0; i < some.size(); ++i) {
          GroupFacts& facts = facts_[static_cast<std::size_t>(some[i])];
          facts.land_probability = ProbabilityOf(land_log_odds[i]);
          facts.thing_probability = ProbabilityOf(thing_log_odds[i]);
        }
      });
}

std::span<const std::int32_t> LookoutMethod::NearestOf(std::int32_t group) {
  nearest_.clear();
  const Arc arc = pieces_[group].arc;
  for (int step = 0; step < arc.num; ++step) {
    const auto seen = pieces_.InColumn(grid_.Wrap(arc.first + step));
    const auto entry = std::ranges::find(seen, group, &OutlineEntry::piece);  // there is one at most
    if (entry != seen.end()) nearest_.push_back(entry->nearest);
  }
  return nearest_;
}

}  // namespace lookout::segmenter
