#include "services/segmenter/core/lookout/piece_features.hpp"

#include <algorithm>
#include <span>

namespace lookout::segmenter {

namespace {

constexpr float kBackdropM = 5.0F;
constexpr float kCrowdM = 3.0F;
constexpr int kCrowdColumns = 8;
constexpr std::int32_t kCrowdReturns = 2;
constexpr double kLeastDepthM = 0.1;

// A column has entries of a few pieces; where it has very many, as in spray before the lens, the nearest of these say enough.
constexpr std::size_t kMostInColumn = 24;

}  // namespace

void PieceMeasurer::LookAround(const ScanGrid& grid, const PieceTable& pieces) {
  near_m_.clear();
  far_m_.clear();
  piece_.clear();
  begin_of_column_.assign(1, 0);
  for (int column = 0; column < grid.num_columns(); ++column) {
    const auto seen = pieces.InColumn(column).first(std::min(pieces.InColumn(column).size(), kMostInColumn));
    bool is_covered = false;  // a drop covers nothing
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const OutlineEntry& entry = seen[i];
      near_m_.push_back(entry.near_point.range_m);
      far_m_.push_back(entry.far_point.range_m);
      piece_.push_back(entry.piece);
      if (is_covered) ++Of(entry.piece, PieceFeature::kCovered);
      is_covered = is_covered || pieces[entry.piece].num_returns > kCrowdReturns;
      // What stands behind is sorted: the next is the nearest.
      const bool has_backdrop = i + 1 < seen.size() && seen[i + 1].near_point.range_m - entry.far_point.range_m <= kBackdropM;
      if (has_backdrop) ++Of(entry.piece, PieceFeature::kBackdrop);
    }
    begin_of_column_.push_back(piece_.size());
  }
  crowd_.resize(piece_.size());
  for (int column = 0; column < grid.num_columns(); ++column) {
    for (std::size_t at = begin_of_column_[static_cast<std::size_t>(column)]; at < begin_of_column_[static_cast<std::size_t>(column) + 1]; ++at) {
      if (pieces[piece_[at]].num_returns > kCrowdReturns || !IsJudged(pieces, piece_[at])) continue;
      // It is of the crowd about its neighbours: each column of these counts it. Over the seam, too.
      const int first = column - kCrowdColumns;
      const int end = column + kCrowdColumns + 1;
      CountInCrowd(at, std::max(first, 0), std::min(end, grid.num_columns()));
      if (first < 0) CountInCrowd(at, first + grid.num_columns(), grid.num_columns());
      if (end > grid.num_columns()) CountInCrowd(at, 0, end - grid.num_columns());
    }
  }
}

void PieceMeasurer::CountInCrowd(std::size_t entry, int first_column, int end_column) {
  const std::size_t end = begin_of_column_[static_cast<std::size_t>(end_column)];
  // First, without a branch, which are near.
  std::size_t num = 0;
  for (std::size_t at = begin_of_column_[static_cast<std::size_t>(first_column)]; at < end; ++at) {
    crowd_[num] = piece_[at];
    num += (near_m_[at] - kCrowdM <= far_m_[entry] ? 1U : 0U) & (far_m_[at] + kCrowdM >= near_m_[entry] ? 1U : 0U) &
           (piece_[at] != piece_[entry] ? 1U : 0U);
  }
  for (std::size_t i = 0; i < num; ++i) ++Of(crowd_[i], PieceFeature::kCrowd);
}

std::span<const PieceFeatures> PieceMeasurer::Measure(const ScanGrid& grid, const PieceTable& pieces, double lidar_above_water_m) {
  features_.assign(static_cast<std::size_t>(pieces.size()), {});
  LookAround(grid, pieces);
  for (std::int32_t piece = 0; piece < pieces.size(); ++piece) {
    const PieceFacts& facts = pieces[piece];
    const auto set = [&](PieceFeature feature, double value) { Of(piece, feature) = FeatureOf(value); };
    const double depth_m = facts.max_range_m - facts.min_range_m;
    const double height_m = facts.max_height_m - facts.min_height_m;
    const double num_columns = facts.num_columns;
    const int num_rings = facts.max_ring - facts.min_ring + 1;
    set(PieceFeature::kRange, facts.min_range_m);
    set(PieceFeature::kReturns, facts.num_returns);
    set(PieceFeature::kColumns, num_columns);
    set(PieceFeature::kRings, num_rings);
    set(PieceFeature::kWidth, facts.width_m);
    set(PieceFeature::kDepth, depth_m);
    set(PieceFeature::kLength, facts.length_m);
    set(PieceFeature::kOff, facts.off_m);
    set(PieceFeature::kTop, facts.max_height_m + lidar_above_water_m);
    set(PieceFeature::kBottom, facts.min_height_m + lidar_above_water_m);
    set(PieceFeature::kMiddle, facts.mean_height_m + lidar_above_water_m);
    set(PieceFeature::kSlope, height_m / std::max(depth_m, kLeastDepthM));
    set(PieceFeature::kFill, facts.num_returns / static_cast<double>(std::max(1, facts.num_beams)));
    set(PieceFeature::kBoxFill, facts.num_returns / (static_cast<double>(facts.arc.num) * num_rings));
    set(PieceFeature::kGaps, 1.0 - num_columns / facts.arc.num);
    set(PieceFeature::kBackdrop, Of(piece, PieceFeature::kBackdrop) / num_columns);
    set(PieceFeature::kCovered, Of(piece, PieceFeature::kCovered) / num_columns);
    set(PieceFeature::kCrowd, Of(piece, PieceFeature::kCrowd) / num_columns);
  }
  return features_;
}

}  // namespace lookout::segmenter
