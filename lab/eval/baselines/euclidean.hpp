// Euclidean clustering: returns within a distance of each other are one.
#pragma once

#include "lab/eval/baselines/peer.hpp"

namespace lookout::eval {

/// Connected components of the graph that joins points nearer to each other than a distance, by breadth-first search over a k-d tree.
///
/// Source: R. B. Rusu, "Semantic 3D Object Maps for Everyday Manipulation in Human Living Environments", TU Muenchen 2009, section 6.2; with
/// the semantics of PCL's EuclideanClusterExtraction. Written from these. Cost: one search per return, and the neighbours it finds.
Grouping EuclideanGrouping(double distance_m);

}  // namespace lookout::eval
