#include "tools/eval/baselines/peers.hpp"

#include <memory>

#include "tools/eval/baselines/depth_clustering.hpp"
#include "tools/eval/baselines/euclidean.hpp"
#include "tools/eval/baselines/f3d.hpp"

namespace lookout::eval {

namespace {

// The choice that peers give between what they find and what they find for nothing: a least size. 1 and 3 were in the grid of tuning.
constexpr SizeLimits kThreeOrMore{3};

// Of any size unless said: on the water a single return may be a buoy.
EuclideanParams Within(double distance_m, SizeLimits limits = {}) { return {distance_m, limits}; }

// Tuned values: README.md says on which scenes and over which grid.
DepthClusteringParams TunedDepthClustering(SizeLimits limits = {}) {
  DepthClusteringParams params;
  params.ground.reset();
  params.angle_rad = DegToRad(10);
  params.reach_columns = 16;
  params.reach_rings = 1;
  params.limits = limits;
  return params;
}

F3dParams TunedF3d(SizeLimits limits = {}) {
  F3dParams params;
  params.ground.reset();
  params.run_distance_m = 2.0;
  params.merge_distance_m = 3.0;
  params.limits = limits;
  return params;
}

}  // namespace

Methods MakePeers(const segmenter::ReturnFilter& filter) {
  Methods methods;
  methods.push_back(std::make_unique<EuclideanClustering>("Euclidean 0.02 m (PCL tutorial)", filter, EuclideanParams{}));
  methods.push_back(std::make_unique<EuclideanClustering>("Euclidean 0.5 m", filter, Within(0.5)));
  methods.push_back(std::make_unique<EuclideanClustering>("Euclidean 2 m", filter, Within(2.0)));
  methods.push_back(std::make_unique<EuclideanClustering>("Euclidean 4 m", filter, Within(4.0)));
  methods.push_back(std::make_unique<EuclideanClustering>("Euclidean 2.5 m (tuned)", filter, Within(2.5)));
  methods.push_back(std::make_unique<EuclideanClustering>("Euclidean 2.5 m (tuned, 3 returns or more)", filter, Within(2.5, kThreeOrMore)));
  methods.push_back(std::make_unique<DepthClustering>("depth clustering (defaults)", filter, DepthClusteringParams{}));
  methods.push_back(std::make_unique<DepthClustering>("depth clustering (tuned)", filter, TunedDepthClustering()));
  methods.push_back(std::make_unique<DepthClustering>("depth clustering (tuned, 3 returns or more)", filter, TunedDepthClustering(kThreeOrMore)));
  methods.push_back(std::make_unique<F3d>("F3D (defaults)", filter, F3dParams{}));
  methods.push_back(std::make_unique<F3d>("F3D (tuned)", filter, TunedF3d()));
  methods.push_back(std::make_unique<F3d>("F3D (tuned, 3 returns or more)", filter, TunedF3d(kThreeOrMore)));
  return methods;
}

}  // namespace lookout::eval
