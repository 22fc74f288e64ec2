// What the lookout method goes by. Lengths in metres, "per range" in metres per metre of distance.
#pragma once

#include "services/segmenter/core/lookout/evidence.hpp"
#include "services/segmenter/core/lookout/pairs.hpp"
#include "services/segmenter/core/lookout/piece_features.hpp"
#include "services/segmenter/core/lookout/reach.hpp"

namespace lookout::segmenter {

/// The sums of a file of weights, by what they are evidence of.
inline constexpr EvidenceLayout kMergeFirstLayout{"merge_first", kPairFeatureNames};    // that two tight pieces are one
inline constexpr EvidenceLayout kMergeSecondLayout{"merge_second", kPairFeatureNames};  // that two larger pieces are one
inline constexpr EvidenceLayout kLandLayout{"land", kPieceFeatureNames};                // that a group is land
inline constexpr EvidenceLayout kThingLayout{"thing", kPieceFeatureNames};              // that it is a thing, not clutter

/// Defaults are those of config/schema/segmenter.proto, which says where they come from.
struct LookoutParams {
  // Pieces: returns that lie so close that nothing passes between them.
  Reach link{0.3, 0.01};
  // Pairs of pieces that are asked whether they are one, in the first and in the second merging.
  Reach first_reach{1.5, 0.04};
  Reach second_reach{4.0, 0.12};
  // Merged when the mean evidence is above this.
  double first_log_odds = 1.5;
  double second_log_odds = 0.0;
  // What is above this is land, and sure.
  double land_log_odds = 0.0;
  double sure_log_odds = 2.0;
  Evidence merge_first = DefaultEvidence(kMergeFirstLayout);
  Evidence merge_second = DefaultEvidence(kMergeSecondLayout);
  Evidence land = DefaultEvidence(kLandLayout);
  Evidence thing = DefaultEvidence(kThingLayout);
  /// Of the lidar over the water when the boat floats at rest.
  double lidar_above_water_m = 1.0;
};

}  // namespace lookout::segmenter
