// Parameters of the lookout method. Lengths in metres, "per range" in metres per metre of distance.
#pragma once

#include <array>
#include <cstddef>

#include "services/segmenter/core/lookout/evidence.hpp"
#include "services/segmenter/core/lookout/pairs.hpp"
#include "services/segmenter/core/lookout/piece_features.hpp"
#include "services/segmenter/core/lookout/reach.hpp"

namespace lookout::segmenter {

/// The sums of a file of evidence: that two pieces are one, in each round of merging; that a group is land; that it is a thing, not clutter.
inline constexpr std::size_t kNumMerges = 3;
inline constexpr std::size_t kLandSum = kNumMerges;
inline constexpr std::size_t kThingSum = kNumMerges + 1;
inline constexpr std::size_t kNumSums = kNumMerges + 2;
inline constexpr std::array<EvidenceLayout, kNumSums> kEvidenceLayouts{{{"merge_1", kPairFeatureNames},
                                                                        {"merge_2", kPairFeatureNames},
                                                                        {"merge_3", kPairFeatureNames},
                                                                        {"land", kLandFeatureNames},
                                                                        {"thing", kPieceFeatureNames}}};

/// The sums that are compiled in, in the order of the layouts.
std::array<Evidence, kNumSums> DefaultEvidences();

/// One round of merging: pairs within reach are merged while their mean log odds are above a threshold.
struct MergeParams {
  Reach reach;
  double log_odds = 0.0;        // 0: more likely one than two
  bool reaches_behind = false;  // the part of a gap that something nearer hides does not count for the reach
};

/// Defaults are those of config/schema/segmenter.proto, which says where they come from.
struct LookoutParams {
  // Pieces: returns that lie so close that nothing passes between them.
  Reach link{0.3, 0.01};
  // Certain pairs merge first; then the rest, by features of the larger pieces. Reaches and thresholds belong to the evidence, which is fitted with
  // them; they were chosen on the families of scenes (DECISIONS.md).
  std::array<MergeParams, kNumMerges> merges{{{{1.0, 0.03}, 2.0}, {{2.5, 0.08}, 1.0}, {{6.0, 0.12}, 0.0, true}}};
  // A group of two returns or more is sure if thing_probability > sure_probability. A sure group is land if its land probability > land_probability.
  double land_probability = 0.7;
  double sure_probability = 0.5;
  std::array<Evidence, kNumSums> evidence = DefaultEvidences();
  /// Height of the lidar over the water when the boat floats at rest.
  double lidar_above_water_m = 1.0;
};

}  // namespace lookout::segmenter
