#include "services/segmenter/core/lookout/lookout_method.hpp"

#include <algorithm>

namespace lookout::segmenter {

namespace {

constexpr double kLinkedColumns = 2.8;  // LookoutParams::link grows by as many columns of 0.2 degrees

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
}

std::span<const PiecePair> LookoutMethod::FindPairs(std::size_t merge) {
  return pair_finder_.Find(grid_, pieces_, params_.merges[merge].reach, params_.merges[merge].reaches_behind);
}

void LookoutMethod::Merge(std::size_t merge, std::span<const PiecePair> pairs) {
  const Evidence& evidence = params_.evidence[merge];
  evidence_.clear();
  for (const PiecePair& pair : pairs) evidence_.push_back({pair.one, pair.other, evidence.Of(pair.features), pair.gap_m});
  partition_.Find(pieces_.size(), evidence_, static_cast<float>(params_.merges[merge].log_odds));
  const auto group_of_piece = partition_.group_of_piece();
  label_.clear();
  for (const std::int32_t piece : pieces_.of_returns()) label_.push_back(group_of_piece[static_cast<std::size_t>(piece)]);
  pieces_.Build(grid_, label_, partition_.count());
}

std::span<const PieceFeatures> LookoutMethod::MeasureGroups() {
  MeasurePieces(grid_, pieces_, params_.lidar_above_water_m, features_);
  return features_;
}

void LookoutMethod::Judge(std::span<const PieceFeatures> features) {
  groups_.count = pieces_.size();
  groups_.of_return.assign(pieces_.of_returns().begin(), pieces_.of_returns().end());
  facts_.clear();
  for (std::int32_t group = 0; group < pieces_.size(); ++group) {
    const PieceFacts& piece = pieces_[group];
    GroupFacts facts;
    facts.land_log_odds = params_.evidence[kLandSum].Of(features[static_cast<std::size_t>(group)]);
    facts.thing_log_odds = params_.evidence[kThingSum].Of(features[static_cast<std::size_t>(group)]);
    facts.is_land = ProbabilityOf(facts.land_log_odds) > params_.land_probability;
    facts.seen_share = static_cast<float>(piece.num_columns) / static_cast<float>(piece.arc.num);
    facts_.push_back(facts);
  }
}

std::span<const std::int32_t> LookoutMethod::NearestOf(std::int32_t group) {
  nearest_.clear();
  const Arc arc = pieces_[group].arc;
  for (int step = 0; step < arc.num; ++step) {
    for (const OutlineEntry& entry : pieces_.InColumn(grid_.Wrap(arc.first + step))) {
      if (entry.piece == group) nearest_.push_back(entry.nearest);
    }
  }
  return nearest_;
}

}  // namespace lookout::segmenter
