// The fourth step of the lookout method: land, walls and piers, and what is of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/near_sets.hpp"
#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/runs.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

/// Finds land among the pieces, in this order:
/// 1. Straight pieces in line with each other are one wall or pier, if whatever hides what lies between them is nearer than their line: a moored
///    boat does not cut the wall behind it, and open water between two boats does not make them one.
/// 2. A piece of `land_length_m` or more is land. So is the water's edge: runs of one ring that follow each other at most `shore_gap` apart over
///    that length. What stands before both its neighbours there, as a kayak before a beach does, is no part of it.
/// 3. Pieces that stand behind land in its own columns, at most `behind_land` from it, are of it: terraces and trees. So is what is tall and wide
///    beside it, at most `beside_land` off. Straight walls and piers take nothing in this way, and land that shows no depth takes in what is tall
///    alone: a boat may lie behind a pier.
/// 4. Pieces of land are one that are near each other: at most `beside_land` apart, of which only half is taken at the lidar.
/// What is joined to objects afterwards may be trees whose shore is not seen. FindGroves: three or more that are tall and wide, each at most
/// `beside_land` from the next, over `land_length_m`, are land, and take in as above.
class LandFinder {
 public:
  explicit LandFinder(const LookoutParams& params) : params_(params) {}

  void Find(const ScanGrid& grid, const RunTable& runs, PieceTable& pieces);
  /// After Find in the same scan.
  void FindGroves(const ScanGrid& grid, PieceTable& pieces);

 private:
  struct Fragment {
    std::int32_t piece = 0;
    std::int32_t first_run = 0;
    std::int32_t last_run = 0;
    bool is_before = false;  // nearer than both its neighbours
  };

  // What a piece of land shows in one column.
  struct LandEntry {
    std::int32_t root = 0;
    LevelPoint near_point{};
    LevelPoint far_point{};
  };
  // What land shows in the column that is being looked at.
  struct LandDepth {
    std::int32_t column = -1;
    float nearest_m = 0.0F;
    float farthest_m = 0.0F;
    std::int32_t num_columns = 0;
    std::int32_t num_deep = 0;
  };

  // Returns of a piece above tall_m.
  struct Tall {
    std::int32_t num_returns = 0;
    double x_m = 0.0;  // sums
    double y_m = 0.0;
    double squared_m2 = 0.0;  // of the distance from the lidar
  };
  struct Grove {
    int num_trees = 0;
    double length_m = 0.0;
    Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
    double radius_m = 0.0;
  };

  void Complete(const ScanGrid& grid, PieceTable& pieces);
  void JoinInLine(const ScanGrid& grid, PieceTable& pieces);
  bool IsHiddenBetween(const ScanGrid& grid, const PieceTable& pieces, const PieceFacts& line, const PieceFacts& other) const;
  void FindShores(const ScanGrid& grid, const RunTable& runs, PieceTable& pieces);
  void TakeChain(const ScanGrid& grid, const RunTable& runs, PieceTable& pieces);
  bool TakeIn(const ScanGrid& grid, PieceTable& pieces);
  bool FindWhatTakesIn(const ScanGrid& grid, const PieceTable& pieces);
  void ListLand(const ScanGrid& grid, const PieceTable& pieces);
  std::span<const LandEntry> LandInColumn(std::int32_t column) const {
    const auto at = static_cast<std::size_t>(column);
    return std::span(land_entries_).subspan(begin_of_land_[at], begin_of_land_[at + 1] - begin_of_land_[at]);
  }
  std::int32_t LandBefore(const ScanGrid& grid, const PieceTable& pieces, std::int32_t root) const;
  std::int32_t LandBeside(const ScanGrid& grid, const PieceTable& pieces, std::int32_t root) const;
  bool TakesIn(std::int32_t root, std::uint8_t at_least) const { return takes_in_[static_cast<std::size_t>(root)] >= at_least; }
  void MeasureTall(const ScanGrid& grid, const PieceTable& pieces);
  bool IsTall(const PieceTable& pieces, std::int32_t root) const;
  void JoinTrees(const ScanGrid& grid, PieceTable& pieces);
  void JoinLand(const ScanGrid& grid, PieceTable& pieces);

  LookoutParams params_;
  UnionFind chains_;
  std::vector<std::int32_t> order_;
  std::vector<std::int32_t> num_of_chain_;   // [runs of a line] returns; 0 unless a chain begins with it
  std::vector<std::int32_t> next_of_chain_;  // [runs of a line]
  std::vector<std::int32_t> last_of_chain_;  // [runs of a line]
  std::vector<std::int32_t> chain_;
  std::vector<Fragment> fragments_;
  std::vector<std::int32_t> candidates_;
  std::vector<std::uint8_t> takes_in_;      // [pieces] what land takes in: nothing, what is tall, all
  std::vector<float> land_m_;               // [columns] range of the nearest return of such land in this column or beside it
  std::vector<LandEntry> land_entries_;     // by column
  std::vector<std::size_t> begin_of_land_;  // [columns + 1]
  std::vector<std::uint8_t> is_land_;       // [pieces] of roots
  std::vector<LandDepth> depth_of_;         // [pieces] of roots
  std::vector<Tall> tall_;                  // [pieces] of each by itself
  std::vector<Grove> groves_;               // [pieces]
  NearSets near_sets_;
};

}  // namespace lookout::segmenter
