#include "services/segmenter/core/lookout/piece_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "common/core/angles.hpp"

namespace lookout::segmenter {

namespace {

constexpr float kBackdropM = 5.0F;
constexpr float kCrowdM = 3.0F;
constexpr double kCrowdRad = DegToRad(1.6);
constexpr int kMostCrowdColumns = 16;
constexpr double kCrowdBeams = 272.0;  // 17 columns of 16 rings
constexpr std::int32_t kCrowdReturns = 2;
constexpr double kLeastDepthM = 0.1;
constexpr float kLeastRangeM = 0.5F;
constexpr double kBendsPerMetre = 1024.0;

// A column has entries of a few pieces; where it has very many, as in spray before the lens, the nearest of these say enough.
constexpr std::size_t kMostInColumn = 24;

std::span<const OutlineEntry> SeenIn(const PieceTable& pieces, int column) {
  const auto seen = pieces.InColumn(column);
  return seen.first(std::min(seen.size(), kMostInColumn));
}

// To each side.
int CrowdColumns(const ScanGrid& grid) {
  const double columns = std::round(kCrowdRad / std::max(1e-4, grid.column_step_rad()));
  return std::clamp(static_cast<int>(columns), 1, kMostCrowdColumns);
}

}  // namespace

void PieceMeasurer::LookAround(const ScanGrid& grid, const PieceTable& pieces) {
  few_.Clear();
  for (int column = 0; column < grid.num_columns(); ++column) {
    const auto seen = SeenIn(pieces, column);
    bool is_covered = false;  // a drop covers nothing
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const OutlineEntry& entry = seen[i];
      const bool is_few = pieces[entry.piece].num_returns <= kCrowdReturns;
      if (is_few && IsJudged(pieces, entry.piece)) few_.Add(entry);
      if (is_covered) ++Of(entry.piece, PieceFeature::kCovered);
      const bool has_below = entry.min_ring > 0 && grid.NearestOfShot(entry.min_ring - 1, column) < entry.near_point.range_m;
      if (has_below) ++Of(entry.piece, PieceFeature::kWaterBefore);
      is_covered = is_covered || !is_few;
      // Pieces behind are sorted: the next is the nearest.
      const bool has_backdrop = i + 1 < seen.size() && seen[i + 1].near_point.range_m - entry.far_point.range_m <= kBackdropM;
      if (has_backdrop) ++Of(entry.piece, PieceFeature::kBackdrop);
    }
    few_.begin_of_column.push_back(few_.piece.size());
  }
  if (few_.piece.empty()) return;
  const int crowd_columns = CrowdColumns(grid);
  for (int column = 0; column < grid.num_columns(); ++column) {
    // Over the seam, too.
    const int first = column - crowd_columns;
    const int end = column + crowd_columns + 1;
    for (const OutlineEntry& entry : SeenIn(pieces, column)) {
      int crowd = few_.NumAbout(entry, std::max(first, 0), std::min(end, grid.num_columns()));
      if (first < 0) crowd += few_.NumAbout(entry, first + grid.num_columns(), grid.num_columns());
      if (end > grid.num_columns()) crowd += few_.NumAbout(entry, 0, end - grid.num_columns());
      Of(entry.piece, PieceFeature::kCrowd) += static_cast<float>(crowd);
    }
  }
}

void PieceMeasurer::LookAlongRings(const ScanGrid& grid, const PieceTable& pieces) {
  surfaces_.assign(static_cast<std::size_t>(pieces.size()), {});
  const auto of_returns = pieces.of_returns();
  for (std::size_t i = 0; i < of_returns.size(); ++i) {
    const std::int32_t piece = of_returns[i];
    if (piece < 0) continue;
    const auto index = static_cast<std::int32_t>(i);
    const int line = grid.LineOf(index);
    const int column = grid.ColumnOf(index);
    const double range_m = grid.RangeAt(line, column);
    // Of a shot of two returns the one of the piece that is nearer in range.
    const auto beside = [&](int other_column) {
      double best_m = std::numeric_limits<double>::infinity();
      for (int layer = 0; layer < grid.num_layers(); ++layer) {
        const int other_line = grid.RingOf(line) * grid.num_layers() + layer;
        const std::int32_t other = grid.At(other_line, other_column);
        if (other == ScanGrid::kNone || of_returns[static_cast<std::size_t>(other)] != piece) continue;
        const double other_m = grid.RangeAt(other_line, other_column);
        if (std::abs(other_m - range_m) < std::abs(best_m - range_m)) best_m = other_m;
      }
      return best_m;
    };
    const double before_m = beside(grid.Wrap(column - 1));
    const double after_m = beside(grid.Wrap(column + 1));
    Surface& surface = surfaces_[static_cast<std::size_t>(piece)];
    if (!std::isinf(before_m) && !std::isinf(after_m)) {
      surface.bend += std::llround(std::abs(before_m - 2.0 * range_m + after_m) * kBendsPerMetre);
      ++surface.num_bends;
    }
    if (std::isinf(before_m) && std::isinf(after_m)) ++surface.num_lone;
  }
}

int PieceMeasurer::Few::NumAbout(const OutlineEntry& entry, int first_column, int end_column) const {
  const std::size_t begin = begin_of_column[static_cast<std::size_t>(first_column)];
  const std::size_t end = begin_of_column[static_cast<std::size_t>(end_column)];
  const float nearest_m = entry.near_point.range_m - kCrowdM;
  const float farthest_m = entry.far_point.range_m + kCrowdM;
  int num = 0;
  for (std::size_t at = begin; at < end; ++at) {
    num += (far_m[at] >= nearest_m ? 1 : 0) & (near_m[at] <= farthest_m ? 1 : 0) & (piece[at] != entry.piece ? 1 : 0);
  }
  return num;
}

std::span<const PieceFeatures> PieceMeasurer::Measure(const ScanGrid& grid, const PieceTable& pieces, double lidar_above_water_m) {
  features_.assign(static_cast<std::size_t>(pieces.size()), {});
  LookAround(grid, pieces);
  LookAlongRings(grid, pieces);
  const double crowd_scale = kCrowdBeams / ((2.0 * CrowdColumns(grid) + 1.0) * grid.num_rings());
  for (std::int32_t piece = 0; piece < pieces.size(); ++piece) {
    const PieceFacts& facts = pieces[piece];
    const auto set = [&](PieceFeature feature, double value) { Of(piece, feature) = FeatureOf(value); };
    const double depth_m = facts.max_range_m - facts.min_range_m;
    const double height_m = facts.max_height_m - facts.min_height_m;
    const double num_columns = facts.num_columns;
    const int num_rings = facts.max_ring - facts.min_ring + 1;
    set(PieceFeature::kRange, facts.min_range_m);
    set(PieceFeature::kReturns, facts.num_returns);
    set(PieceFeature::kAngle, grid.SquareDegreesOf(facts.weight));
    set(PieceFeature::kRise, RadToDeg(grid.ElevationOf(facts.max_ring) - grid.ElevationOf(facts.min_ring) +
                                      (grid.RingStepOf(facts.max_ring) + grid.RingStepOf(facts.min_ring)) / 2.0));
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
    set(PieceFeature::kCrowd, Of(piece, PieceFeature::kCrowd) / num_columns * crowd_scale);
    const Surface& surface = surfaces_[static_cast<std::size_t>(piece)];
    set(PieceFeature::kRough, surface.num_bends == 0 ? -1.0 : static_cast<double>(surface.bend) / kBendsPerMetre / surface.num_bends);
    set(PieceFeature::kLone, surface.num_lone / static_cast<double>(facts.num_returns));
    set(PieceFeature::kWaterBefore, Of(piece, PieceFeature::kWaterBefore) / num_columns);
    set(PieceFeature::kBottomRings,
        (facts.min_height_m + lidar_above_water_m) / (grid.RingStepOf(facts.min_ring) * std::max(facts.min_range_m, kLeastRangeM)));
  }
  return features_;
}

}  // namespace lookout::segmenter
