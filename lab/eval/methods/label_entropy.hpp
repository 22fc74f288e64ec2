// How far objects and labels are mixed: entropy of over- and of under-segmentation, and panoptic quality.
#pragma once

#include "lab/eval/metrics.hpp"

namespace lookout::eval {

/// Entropies of one scan; natural logarithm, 0 is best. Both are sums over the scan, as published; without an object in the scan there is none.
///
/// Over (OSE): for each object the entropy of the labels of its returns, where returns in no segment count as one label more; summed over the
/// objects. Under (USE): for each label the entropy of the objects of its returns, where returns of no object count as one object more; summed over
/// the labels.
/// Source: M. Oh et al., "TRAVEL: Traversable ground and above-ground object segmentation using graph representation of 3D LiDAR scans", IEEE RA-L 7
/// (2022), section IV.
struct LabelEntropy {
  Mean over;
  Mean under;
};
LabelEntropy EntropyOf(const Confusion::Matches& matches);

/// A label and an object are a pair where their IoU is above 0.5: none has two. All three add up over scans.
///
/// Labels at least half of whose returns are of no object are left out, as panoptic quality leaves out what is void; they count as false segments
/// elsewhere. In an IoU such returns of a label count, as in mIoU.
/// Source: A. Kirillov et al., "Panoptic segmentation", CVPR 2019, equations 1 and 2, with one class.
struct PanopticQuality {
  Mean quality;       // PQ: sum of the IoUs of pairs over pairs + (labels without an object + objects without a label) / 2; = SQ x RQ
  Mean segmentation;  // SQ: mean IoU of the pairs
  Mean recognition;   // RQ: pairs over the same
};
PanopticQuality PanopticQualityOf(const Confusion::Matches& matches);

}  // namespace lookout::eval
