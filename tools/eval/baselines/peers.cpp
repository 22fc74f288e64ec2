#include "tools/eval/baselines/peers.hpp"

#include <memory>

#include "tools/eval/baselines/depth_clustering.hpp"
#include "tools/eval/baselines/euclidean.hpp"
#include "tools/eval/baselines/f3d.hpp"

namespace lookout::eval {

namespace {

// Of any size: on the water a single return may be a buoy.
EuclideanParams Within(double distance_m) { return {distance_m, SizeLimits{}}; }

// Tuned values: README.md says on which scenes and over which grid.
DepthClusteringParams TunedDepthClustering() {
  DepthClusteringParams params;
  params.ground.reset();
  params.angle_rad = DegToRad(10);
  params.reach_columns = 16;
  params.reach_rings = 1;
  params.limits = SizeLimits{};
  return params;
}

F3dParams TunedF3d() {
  F3dParams params;
  params.ground.reset();
  params.run_distance_m = 2.0;
  params.merge_distance_m = 3.0;
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
  methods.push_back(std::make_unique<DepthClustering>("depth clustering (defaults)", filter, DepthClusteringParams{}));
  methods.push_back(std::make_unique<DepthClustering>("depth clustering (tuned)", filter, TunedDepthClustering()));
  methods.push_back(std::make_unique<F3d>("F3D (defaults)", filter, F3dParams{}));
  methods.push_back(std::make_unique<F3d>("F3D (tuned)", filter, TunedF3d()));
  return methods;
}

}  // namespace lookout::eval
