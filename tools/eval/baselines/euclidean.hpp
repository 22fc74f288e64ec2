// Euclidean clustering: what lies within a distance of each other is one.
#pragma once

#include "tools/eval/baselines/peer.hpp"

namespace lookout::eval {

/// Defaults: the tutorial of PCL's EuclideanClusterExtraction, which is about things on a table: 2 cm, 100 to 25 000 points.
struct EuclideanParams {
  double distance_m = 0.02;
  SizeLimits limits{100, 25'000};
};

/// Connected components of the graph that joins points nearer to each other than a distance, by breadth-first search over a k-d tree.
///
/// Source: R. B. Rusu, "Semantic 3D Object Maps for Everyday Manipulation in Human Living Environments", TU Muenchen 2009, section 6.2; with
/// the semantics of PCL's EuclideanClusterExtraction. Written from these. Cost: one search per return, and the neighbours it finds.
class EuclideanClustering final : public Peer {
 public:
  EuclideanClustering(std::string name, const segmenter::ReturnFilter& filter, const EuclideanParams& params)
      : Peer(std::move(name), filter, params.limits), params_(params) {}

 protected:
  segmenter::Groups GroupReturns(const segmenter::Scan& scan, std::span<const segmenter::Return> returns, StageClock& clock) const override;

 private:
  EuclideanParams params_;
};

}  // namespace lookout::eval
