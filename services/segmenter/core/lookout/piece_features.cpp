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

void MeasurePieces(const ScanGrid& grid, const PieceTable& pieces, double lidar_above_water_m, std::vector<PieceFeatures>& features) {
  features.assign(static_cast<std::size_t>(pieces.size()), {});
  const auto of = [&features](std::int32_t piece, PieceFeature feature) -> float& {
    return features[static_cast<std::size_t>(piece)][static_cast<std::size_t>(feature)];
  };
  for (int column = 0; column < grid.num_columns(); ++column) {
    const auto seen = pieces.InColumn(column).first(std::min(pieces.InColumn(column).size(), kMostInColumn));
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const OutlineEntry& entry = seen[i];
      if (i > 0) ++of(entry.piece, PieceFeature::kCovered);
      const bool has_backdrop = i + 1 < seen.size() && seen[i + 1].near_point.range_m - entry.far_point.range_m <= kBackdropM;
      if (has_backdrop) ++of(entry.piece, PieceFeature::kBackdrop);
      if (pieces[entry.piece].num_returns > kCrowdReturns) continue;
      // It is of the crowd about its neighbours: each column of these counts it.
      for (int step = -kCrowdColumns; step <= kCrowdColumns; ++step) {
        const auto beside = pieces.InColumn(grid.Wrap(column + step));
        for (const OutlineEntry& other : beside.first(std::min(beside.size(), kMostInColumn))) {
          if (other.near_point.range_m - kCrowdM > entry.far_point.range_m) break;
          if (other.piece == entry.piece || other.far_point.range_m + kCrowdM < entry.near_point.range_m) continue;
          ++of(other.piece, PieceFeature::kCrowd);
        }
      }
    }
  }
  for (std::int32_t piece = 0; piece < pieces.size(); ++piece) {
    const PieceFacts& facts = pieces[piece];
    const auto set = [&](PieceFeature feature, double value) { of(piece, feature) = FeatureOf(value); };
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
    set(PieceFeature::kBackdrop, of(piece, PieceFeature::kBackdrop) / num_columns);
    set(PieceFeature::kCovered, of(piece, PieceFeature::kCovered) / num_columns);
    set(PieceFeature::kCrowd, of(piece, PieceFeature::kCrowd) / num_columns);
  }
}

}  // namespace lookout::segmenter
