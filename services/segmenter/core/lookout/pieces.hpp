// The third step of the lookout method: pieces of surface, what is known of each, and joining them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/lookout/runs.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

/// Columns [first, first + num) round the circle.
struct Arc {
  std::int32_t first = 0;
  std::int32_t num = 0;
};

/// What a piece shows in one column, seen from above: its nearest and its farthest return.
struct OutlineEntry {
  std::int32_t piece = 0;
  std::int32_t column = 0;
  std::int32_t nearest = 0;  // index of the return
  LevelPoint near_point{};
  LevelPoint far_point{};
};

/// Of a piece, or of pieces that were joined.
struct PieceFacts {
  std::int32_t num_returns = 0;
  float min_range_m = 0.0F;
  float max_range_m = 0.0F;
  float max_height_m = 0.0F;  // over the lidar
  std::int32_t min_ring = 0;
  std::int32_t max_ring = 0;
  bool is_land = false;
  bool is_dock = false;  // stands on posts
  Arc arc{};
  // Of the line through it.
  Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double length_m = 0.0;  // along it
  double off_m = 0.0;     // off it, root mean square
  double radius_m = 0.0;  // from the mean to the farthest return
};

/// Pieces are numbered in the order of their first run. A set of joined pieces is named by its root; FactsOf holds for roots.
class PieceTable {
 public:
  void Build(const ScanGrid& grid, const RunTable& runs, UnionFind& sets_of_runs);

  std::int32_t size() const { return static_cast<std::int32_t>(facts_.size()); }
  std::int32_t OfRun(std::int32_t run) const { return piece_of_run_[static_cast<std::size_t>(run)]; }
  std::span<const std::int32_t> of_returns() const { return piece_of_return_; }
  /// After Settle().
  std::int32_t RootOf(std::int32_t piece) const { return root_of_piece_[static_cast<std::size_t>(piece)]; }
  std::span<const std::int32_t> roots() const { return roots_; }
  const PieceFacts& FactsOf(std::int32_t root) const { return facts_[static_cast<std::size_t>(root)]; }

  /// Of a single piece.
  const Arc& ArcOf(std::int32_t piece) const { return arcs_[static_cast<std::size_t>(piece)]; }
  /// Outline of a single piece, by column from 0 on.
  std::span<const std::int32_t> OutlineOf(std::int32_t piece) const { return Part(entries_of_piece_, begin_of_piece_, piece); }
  const OutlineEntry& Entry(std::int32_t entry) const { return entries_[static_cast<std::size_t>(entry)]; }
  /// All that is seen in a column: one entry for each piece.
  std::span<const OutlineEntry> InColumn(std::int32_t column) const { return Part(entries_, begin_of_column_, column); }
  /// Pieces of a set, from the root on; kNone ends it.
  std::int32_t NextMember(std::int32_t piece) const { return next_member_[static_cast<std::size_t>(piece)]; }
  static constexpr std::int32_t kNone = -1;

  /// Wants two sets to be one. Nothing changes before Settle.
  void Join(std::int32_t one, std::int32_t other) { joins_.push_back({one, other}); }
  void MarkLand(std::int32_t piece) { new_land_.push_back(piece); }
  void MarkDock(std::int32_t piece) { facts_[static_cast<std::size_t>(RootOf(piece))].is_dock = true; }
  /// Carries out what was wanted. What is of a set with land is land.
  /// @return whether anything changed
  bool Settle(const ScanGrid& grid);

 private:
  struct Pair {
    std::int32_t one;
    std::int32_t other;
  };

  template <typename T>
  static std::span<const T> Part(const std::vector<T>& values, const std::vector<std::int32_t>& begin, std::int32_t index) {
    const auto at = static_cast<std::size_t>(index);
    return std::span<const T>(values).subspan(static_cast<std::size_t>(begin[at]), static_cast<std::size_t>(begin[at + 1] - begin[at]));
  }

  // Sums over the returns of a piece, or of pieces that were joined.
  struct Sums {
    double x_m = 0.0;
    double y_m = 0.0;
    double xx_m2 = 0.0;
    double xy_m2 = 0.0;
    double yy_m2 = 0.0;
  };
  // The widest gap between the columns of a piece, as far as they have been looked at.
  struct Gap {
    std::int32_t first_column = 0;  // of the piece
    std::int32_t widest = 0;
    std::int32_t after_widest = 0;
  };

  void NumberPieces(const ScanGrid& grid, const RunTable& runs, UnionFind& sets_of_runs);
  void SumReturns(const ScanGrid& grid, const RunTable& runs);
  void BuildOutlines(const ScanGrid& grid);
  void AddToOutline(std::int32_t piece, std::int32_t column, std::int32_t first_of_column, std::int32_t nearest, std::int32_t farthest,
                    const ScanGrid& grid);
  void FindArcs(const RunTable& runs, int num_columns);
  void FitLine(std::int32_t root);
  Arc CoveringArc(int num_columns);

  std::vector<std::int32_t> piece_of_run_;     // [runs]
  std::vector<std::int32_t> piece_of_return_;  // [returns]
  std::vector<PieceFacts> facts_;              // [pieces]
  std::vector<Sums> sums_;                     // [pieces]
  std::vector<Arc> arcs_;                      // [pieces] of each by itself
  std::vector<std::int32_t> next_member_;      // [pieces]
  std::vector<std::int32_t> last_member_;      // [pieces] of roots
  std::vector<std::int32_t> roots_;
  UnionFind sets_;
  std::vector<std::int32_t> root_of_piece_;
  std::vector<OutlineEntry> entries_;  // by column
  std::vector<std::int32_t> begin_of_column_;
  std::vector<std::int32_t> entries_of_piece_;
  std::vector<std::int32_t> begin_of_piece_;
  std::vector<Pair> joins_;
  std::vector<std::int32_t> new_land_;
  // Scratch.
  std::vector<Arc> to_cover_;
  std::vector<std::int32_t> number_of_root_;
  std::vector<std::int32_t> last_entry_;
  std::vector<std::int32_t> cursor_;  // where the next one of a part goes
  std::vector<Gap> gaps_;             // [pieces]
  std::vector<std::int32_t> changed_;
};

/// Columns that two arcs share.
int SharedColumns(const Arc& one, const Arc& other, int num_columns);

/// Least distance between two single pieces seen from above, by the entries of their outlines; above `limit_m` when there is none within it.
double PlanGap(const ScanGrid& grid, const PieceTable& pieces, std::int32_t one, std::int32_t other, double limit_m);

}  // namespace lookout::segmenter
