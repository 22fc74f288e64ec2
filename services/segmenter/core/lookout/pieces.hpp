// Pieces of a scan: returns that form one surface, the sums of each piece, and its outline seen from above.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/lookout/scan_grid.hpp"

namespace lookout::segmenter {

/// Columns [first, first + num) round the circle.
struct Arc {
  std::int32_t first = 0;
  std::int32_t num = 0;
};

/// Columns that two arcs share.
int SharedColumns(const Arc& one, const Arc& other, int num_columns);

/// The part of a piece in one column.
struct OutlineEntry {
  std::int32_t piece = 0;
  std::int32_t column = 0;
  std::int32_t nearest = 0;  // index of the return
  std::int32_t farthest = 0;
  std::int32_t min_ring = 0;
  std::int32_t max_ring = 0;
  float min_height_m = 0.0F;  // over the lidar
  float max_height_m = 0.0F;
  LevelPoint near_point{};
  LevelPoint far_point{};
};

/// Rounds to 2^-10, a millimetre: half of the resolution of a VLP-16, and far above the rounding of coordinates, which changes as the scene turns. So
/// 0 stays 0: the depth of returns of one range, or the distance of two returns from the line through them.
inline float FeatureOf(double value) {
  constexpr double kRounder = 1.5 * (std::uint64_t{1} << 42U);  // in a sum with it, 2^-10 is the last place
  return static_cast<float>((value + kRounder) - kRounder);
}

struct PieceFacts {
  std::int32_t num_returns = 0;
  std::int64_t weight = 0;       // sum of ScanGrid::WeightOfRing
  std::int32_t num_columns = 0;  // in which it has a return
  std::int32_t num_beams = 0;    // between its ends, over its lines: num_returns where every beam met it
  std::int32_t min_ring = 0;
  std::int32_t max_ring = 0;
  float min_range_m = 0.0F;
  float max_range_m = 0.0F;
  float min_height_m = 0.0F;  // over the lidar
  float max_height_m = 0.0F;
  Arc arc{};
  // The line through it, seen from above.
  Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double length_m = 0.0;       // along it
  double off_m = 0.0;          // off it, root mean square
  double radius_m = 0.0;       // from the mean to the farthest return
  double mean_height_m = 0.0;  // over the lidar
  double width_m = 0.0;        // across the line of sight: of its arc, at its nearest range
};

class PieceTable {
 public:
  /// @param piece_of_return  [returns] 0 to count - 1, each with a return at least; -1: of none
  /// Cost: proportional to the returns. Allocates nothing once it has seen a scan of that size.
  void Build(const ScanGrid& grid, std::span<const std::int32_t> piece_of_return, std::int32_t count);

  /// Makes a piece of each group. The result is that of Build for the groups, but for the rounding of sums; it is computed from the sums of the
  /// pieces.
  ///
  /// @param group_of_piece  [size()] 0 to count - 1, in the order of the first piece of each
  /// Cost: proportional to the columns of all pieces; the returns are only labelled.
  void Merge(const ScanGrid& grid, std::span<const std::int32_t> group_of_piece, std::int32_t count);

  std::int32_t size() const { return static_cast<std::int32_t>(facts_.size()); }
  std::span<const std::int32_t> of_returns() const { return piece_of_return_; }
  const PieceFacts& operator[](std::int32_t piece) const { return facts_[static_cast<std::size_t>(piece)]; }

  /// All outlines, by column from 0 on.
  std::span<const OutlineEntry> entries() const { return entries_; }
  /// The entries of a column: one for each piece, the nearest first.
  std::span<const OutlineEntry> InColumn(std::int32_t column) const {
    const auto at = static_cast<std::size_t>(column);
    return std::span<const OutlineEntry>(entries_).subspan(begin_of_column_[at], begin_of_column_[at + 1] - begin_of_column_[at]);
  }

 private:
  // Sums over the returns of a piece.
  struct Sums {
    double x_m = 0.0;
    double y_m = 0.0;
    double height_m = 0.0;
    double xx_m2 = 0.0;
    double xy_m2 = 0.0;
    double yy_m2 = 0.0;
  };
  // Empty columns between two that follow each other in a piece.
  struct Gap {
    std::int32_t num = -1;
    float nearer_end_m = 0.0F;  // ranges of the nearest returns of the two
    float farther_end_m = 0.0F;
    std::int32_t after = 0;  // the column that ends it
  };
  // The widest gap between the columns of a piece, as far as they have been looked at.
  struct Columns {
    std::int32_t num = 0;
    std::int32_t first = -1;
    std::int32_t last = 0;
    float first_m = 0.0F;
    float last_m = 0.0F;
    Gap widest;
  };
  // Returns of a piece in columns [first, last] of a line.
  struct Run {
    std::int32_t line = 0;
    std::int32_t first = 0;
    std::int32_t last = 0;
    std::int32_t piece = 0;
  };
  // Columns of a piece in the line that is looked at.
  struct Span {
    std::int32_t line = -1;
    std::int32_t first = 0;
    std::int32_t last = 0;
    std::int32_t widest_gap = 0;
  };

  void SumReturns(const ScanGrid& grid);
  void BuildOutlines(const ScanGrid& grid);
  void FindRuns(const ScanGrid& grid);
  void MergeFacts(std::span<const std::int32_t> group_of_piece, std::int32_t count);
  void MergeOutlines(std::span<const std::int32_t> group_of_piece);
  OutlineEntry* EntryOf(std::int32_t piece, std::size_t first_of_column, std::size_t end);
  void SortColumn(std::size_t first, std::size_t end);
  // Values derived from sums, outlines and runs, of the new pieces.
  void Measure(const ScanGrid& grid);
  void FindArcs(int num_columns);
  static void WidenGap(Columns& columns, std::int32_t column, std::int32_t after, float range_m);
  void CountBeams(int num_columns);
  void FitLines(double column_step_rad);

  std::vector<std::int32_t> piece_of_return_;  // [returns]
  std::vector<PieceFacts> facts_;              // [pieces]
  std::vector<std::uint8_t> is_new_;           // [pieces] 1: built or merged since the last round, and to be measured
  std::vector<OutlineEntry> entries_;          // by column
  std::vector<std::size_t> begin_of_column_;   // [columns + 1]
  std::vector<Run> runs_;                      // line by line
  std::vector<Sums> sums_;                     // [pieces]
  // Scratch, [pieces].
  std::vector<Columns> columns_;
  std::vector<Span> spans_;
  struct Extent {
    double least_m;
    double greatest_m;
    double radius_m2;
  };
  std::vector<Extent> extents_;
};

}  // namespace lookout::segmenter
