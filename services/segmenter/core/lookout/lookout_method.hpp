// The lookout method: from the returns of a scan to its obstacles, on the lidar's own rings and columns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/groups.hpp"
#include "services/segmenter/core/lookout/land.hpp"
#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/objects.hpp"
#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/run_links.hpp"
#include "services/segmenter/core/lookout/runs.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/lookout/thin_pieces.hpp"
#include "services/segmenter/core/measure.hpp"
#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

/// What is said of a group beside its returns.
struct GroupFacts {
  bool is_land = false;
  std::int32_t grounds = 0;  // bits of Ground
  float seen_share = 1.0F;   // of the columns from its first to its last: in the others something nearer hides it, or there is no return
};

/// LookoutParams::link for a lidar whose columns are so far apart: where they are wider than those of a VLP-16, the reach is longer.
Reach LinkFor(Reach link, double column_step_rad);

/// Works on one scan after the other and keeps nothing of the last but its memory. Pure in what it gives: the same scan gives the same groups,
/// whatever came before. Turning the scene by whole columns or mirroring it changes nothing but the numbers of the groups.
class LookoutMethod {
 public:
  LookoutMethod(const LookoutParams& params, const Eigen::Matrix3d& R_vessel_lidar)
      : params_(params), R_vessel_lidar_(R_vessel_lidar), land_(params), thin_(params), objects_(params) {}

  /// Groups the returns; each is in one. Results hold until the next call.
  /// Cost: about proportional to the returns and cells. Allocates nothing once it has seen a scan of that size.
  void Group(const Scan& scan, std::span<const Return> returns);

  /// Single pieces, and the piece that names the group of each.
  const Groups& pieces() const { return piece_groups_; }
  std::span<const std::int32_t> group_of_piece() const { return root_of_piece_; }
  /// Of the group that this piece names.
  const GroupFacts& FactsOf(std::int32_t root) const { return facts_[static_cast<std::size_t>(root)]; }
  /// The nearest return of that group in each of its columns, from left to right as the lidar sees them. Until the next call.
  std::span<const std::int32_t> NearestOf(std::int32_t root);

 private:
  void Judge();

  LookoutParams params_;
  Eigen::Matrix3d R_vessel_lidar_;
  ScanGrid grid_;
  RunTable runs_;
  RunLinker linker_;
  UnionFind sets_of_runs_;
  PieceTable pieces_;
  LandFinder land_;
  ThinPieces thin_;
  ObjectJoiner objects_;
  Groups piece_groups_;
  std::vector<std::int32_t> root_of_piece_;
  std::vector<GroupFacts> facts_;
  struct Span {
    std::int32_t line = -1;
    std::int32_t num_returns = 0;
    std::int32_t first = 0;  // counted from the begin of the arc
    std::int32_t last = 0;
    std::int32_t num_beams = 0;  // of the lines before
  };
  std::vector<Span> spans_;
  std::vector<std::int32_t> num_seen_;
  std::vector<std::int32_t> nearest_;
};

}  // namespace lookout::segmenter
