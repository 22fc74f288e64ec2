// Figures of the labels of returns, over scans: labels of single scans and labels by tracks are held against the truth by the same.
#pragma once

#include <set>

#include "lab/eval/metrics.hpp"

namespace lookout::eval {

struct LabelFigures {
  Mean iou;                   // of scans with a return of an object: mean over these objects
  Mean land_iou;              // the same, over land alone
  Mean land_too_many;         // a scan in which land is seen: labels more than half of land, beyond one for each object of land
  Mean lost;                  // share of things (not land) with 5 returns or more: IoU below 0.5
  Mean over_entropy;          // EntropyOf
  Mean under_entropy;         // the same
  Mean panoptic_quality;      // PanopticQualityOf
  Mean segmentation_quality;  // the same
  Mean recognition_quality;   // the same

  void Add(const LabelFigures& other);
  /// As one value of each figure that there is: a mean over scenes, each counting the same.
  void AddValues(const LabelFigures& scene);
};

/// Figures of one scan. @param land  ids of the objects that are land
LabelFigures LabelFiguresOf(const Confusion::Matches& matches, const std::set<int>& land);

}  // namespace lookout::eval
