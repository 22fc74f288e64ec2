// The lookout method: from the returns of a scan to its obstacles, on the lidar's own rings and columns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/partition.hpp"
#include "services/segmenter/core/groups.hpp"
#include "services/segmenter/core/lookout/evidence.hpp"
#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/pairs.hpp"
#include "services/segmenter/core/lookout/piece_features.hpp"
#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/lookout/tight_pieces.hpp"
#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

/// Probabilities of a group. Segmenter (Decide) makes confidence and kind of them.
struct GroupFacts {
  float land_probability = 0.0F;
  float thing_probability = 0.0F;  // to be a thing, and not spray, rain, foam or a glint
  float seen_share = 1.0F;         // share of the columns between its ends that show it: in the rest something nearer hides it, or nothing came back
};

/// LookoutParams::link for a lidar with this step between columns: with wider columns than a VLP-16's the reach is longer.
Reach LinkFor(Reach link, double column_step_rad);

/// Works on one scan after the other, and keeps nothing of the last but allocated memory: the same scan gives the same groups. Turning the scene by
/// whole columns or mirroring it changes nothing but the numbers of the groups.
class LookoutMethod {
 public:
  LookoutMethod(const LookoutParams& params, const Eigen::Matrix3d& R_vessel_lidar)
      : params_(params), R_vessel_lidar_(R_vessel_lidar), pair_finder_(params.lidar_above_water_m) {}

  /// Groups the returns; each is in one group, unless the scan has more than TightPieces::kMostPieces tight pieces. Results hold until the next call.
  /// Cost: about proportional to the returns and cells. Allocates nothing once it has seen a scan of that size.
  void Group(const Scan& scan, std::span<const Return> returns);

  /// Group calls FindPieces, then kNumMerges times FindPairs and Merge, then MeasureGroups and Judge. lookout-fit and the table `merges` of
  /// lookout-export call them one by one.
  ///
  /// Links returns to tight pieces.
  void FindPieces(const Scan& scan, std::span<const Return> returns);
  /// Features of the pairs of pieces; valid until the pieces change.
  std::span<const PiecePair> FindPairs(std::size_t merge);
  /// Merges pieces by the log odds of these pairs.
  void Merge(std::size_t merge, std::span<const PiecePair> pairs);
  /// Features of each piece: after the last round a piece is a group.
  std::span<const PieceFeatures> MeasureGroups();
  /// Probabilities of each group.
  void Judge(std::span<const PieceFeatures> features);

  const ScanGrid& grid() const { return grid_; }
  const PieceTable& pieces() const { return pieces_; }
  const TightPieces& tight_pieces() const { return tight_; }
  std::int32_t num_tight_pieces() const { return tight_.count(); }
  std::int32_t num_left_out() const { return tight_.num_left_out(); }

  const Groups& groups() const { return groups_; }
  const GroupFacts& FactsOf(std::int32_t group) const { return facts_[static_cast<std::size_t>(group)]; }
  const PieceFeatures& FeaturesOf(std::int32_t group) const { return features_[static_cast<std::size_t>(group)]; }
  /// The nearest return of that group in each of its columns, from left to right as the lidar sees them. Until the next call.
  std::span<const std::int32_t> NearestOf(std::int32_t group);

 private:
  LookoutParams params_;
  Eigen::Matrix3d R_vessel_lidar_;
  ScanGrid grid_;
  TightPieces tight_;
  PieceTable pieces_;
  PairFinder pair_finder_;
  std::vector<EvidencePair> evidence_;
  Partition partition_;
  PieceMeasurer piece_measurer_;
  std::span<const PieceFeatures> features_;  // of its last call
  Groups groups_;
  std::vector<GroupFacts> facts_;
  std::vector<std::int32_t> judged_;  // groups
  std::vector<std::int32_t> nearest_;
};

}  // namespace lookout::segmenter
