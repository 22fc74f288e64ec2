// Features of a piece by itself and of its surroundings, which say whether it is land, and whether it is a thing at all.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"

namespace lookout::segmenter {

/// Heights are over the water at rest.
enum class PieceFeature : std::uint8_t {
  kRange,  // m, of its nearest return
  kReturns,
  kAngle,     // deg^2, the part of the sphere that its beams see
  kRise,      // deg, from below its lowest ring to above its highest
  kWidth,     // m, across the line of sight
  kDepth,     // m, along the line of sight
  kLength,    // m, of the line through it
  kOff,       // m, root mean square off that line
  kTop,       // m
  kBottom,    // m
  kMiddle,    // m, mean height
  kSlope,     // rise from bottom to top over the depth, which counts as 0.1 m at least
  kFill,      // returns over beams between its ends
  kBoxFill,   // returns over the shots of its columns and rings
  kGaps,      // share of the columns of its arc in which it has no return
  kBackdrop,  // share of its columns in which something stands at most 5 m behind
  kCovered,   // share of its columns in which something of more than two returns stands nearer
  kCrowd,     // pieces of one or two returns within 3 m of range and 1.6 deg of one of its columns: as many as 272 beams there would meet, as of a
              // VLP-16
  // Of the sum of a thing alone.
  kRough,        // m, mean of |second difference| of the ranges of three returns beside each other in a ring; -1 where it has no such three
  kLone,         // share of its returns without one of it beside them in their ring
  kWaterBefore,  // share of its columns in which the beam below its lowest return met something nearer
  kBottomRings,  // bottom over what one ring rises at its range: below 1 of what floats, as the ring below would meet the water
  kNum
};
inline constexpr std::size_t kNumPieceFeatures = static_cast<std::size_t>(PieceFeature::kNum);
inline constexpr std::array<std::string_view, kNumPieceFeatures> kPieceFeatureNames{
    "range_m", "returns", "deg2",     "rise_deg", "width_m",  "depth_m", "length_m", "off_m",   "top_m", "bottom_m",     "middle_m",
    "slope",   "fill",    "box_fill", "gaps",     "backdrop", "covered", "crowd",    "rough_m", "lone",  "water_before", "bottom_rings"};
/// The sum of land asks for these first ones alone.
inline constexpr std::span<const std::string_view> kLandFeatureNames =
    std::span(kPieceFeatureNames).first<static_cast<std::size_t>(PieceFeature::kRough)>();
using PieceFeatures = std::array<float, kNumPieceFeatures>;

/// No water gives so many groups; in heavy rain there are 4000. Where a scan has more, those of one or two returns are clutter, whatever is measured.
inline constexpr std::int32_t kMostJudged = 8192;
inline bool IsJudged(const PieceTable& pieces, std::int32_t piece) { return pieces.size() <= kMostJudged || pieces[piece].num_returns > 2; }

class PieceMeasurer {
 public:
  /// @return [pieces], until the next call
  /// Cost: about proportional to the columns of all pieces. Allocates nothing once it has seen a scan of that size.
  std::span<const PieceFeatures> Measure(const ScanGrid& grid, const PieceTable& pieces, double lidar_above_water_m);

 private:
  float& Of(std::int32_t piece, PieceFeature feature) { return features_[static_cast<std::size_t>(piece)][static_cast<std::size_t>(feature)]; }
  void LookAround(const ScanGrid& grid, const PieceTable& pieces);
  void LookAlongRings(const ScanGrid& grid, const PieceTable& pieces);

  // Pieces of few returns, column by column.
  struct Few {
    std::vector<float> near_m;
    std::vector<float> far_m;
    std::vector<std::int32_t> piece;
    std::vector<std::size_t> begin_of_column;

    void Clear() {
      near_m.clear();
      far_m.clear();
      piece.clear();
      begin_of_column.assign(1, 0);
    }
    void Add(const OutlineEntry& entry) {
      near_m.push_back(entry.near_point.range_m);
      far_m.push_back(entry.far_point.range_m);
      piece.push_back(entry.piece);
    }
    // Pieces in columns from first to before end, and about as far off.
    int NumAbout(const OutlineEntry& entry, int first_column, int end_column) const;
  };

  // Whole numbers: their sums do not depend on the order of the returns.
  struct Surface {
    std::int64_t bend = 0;  // sum of |second difference| of the range, 2^-10 m
    std::int32_t num_bends = 0;
    std::int32_t num_lone = 0;
  };

  std::vector<PieceFeatures> features_;
  std::vector<Surface> surfaces_;  // [pieces]
  Few few_;
};

}  // namespace lookout::segmenter
