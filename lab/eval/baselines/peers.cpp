#include "lab/eval/baselines/peers.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "lab/eval/baselines/depth_clustering.hpp"
#include "lab/eval/baselines/euclidean.hpp"
#include "lab/eval/baselines/f3d.hpp"

namespace lookout::eval {

Methods MakePeers(const segmenter::ReturnFilter& filter) {
  Methods methods;
  const auto add = [&](const char* name, SizeLimits limits, Grouping grouping) {
    methods.push_back(std::make_unique<Peer>(name, filter, limits, std::move(grouping)));
  };
  // Segments of any size count unless said otherwise: on the water a single return may be a buoy. A least size is the peers' choice between recall
  // and false segments; 1 and 3 were in the grid of tuning.
  constexpr SizeLimits kAnySize{};
  constexpr SizeLimits kThreeOrMore{3};
  // PCL's tutorial is about things on a table.
  constexpr SizeLimits kTutorial{100, 25'000};
  // Tuned values: README.md says on which scenes and over which grid.
  const DepthClusteringParams depth;
  const DepthClusteringParams tuned_depth{
      .ground = std::nullopt, .angle_rad = DegToRad(10), .reach_columns = 16, .reach_rings = 1, .limits = kAnySize};
  const F3dParams f3d;
  const F3dParams tuned_f3d{.ground = std::nullopt, .run_distance_m = 2.0, .merge_distance_m = 3.0};
  const auto& mounting = filter.T_vessel_lidar;

  add("Euclidean 0.02 m (PCL tutorial)", kTutorial, EuclideanGrouping(0.02));
  add("Euclidean 0.5 m", kAnySize, EuclideanGrouping(0.5));
  add("Euclidean 1 m", kAnySize, EuclideanGrouping(1.0));
  add("Euclidean 2 m", kAnySize, EuclideanGrouping(2.0));
  add("Euclidean 4 m", kAnySize, EuclideanGrouping(4.0));
  add("Euclidean 2.5 m (tuned)", kAnySize, EuclideanGrouping(2.5));
  add("Euclidean 2.5 m (tuned, 3 returns or more)", kThreeOrMore, EuclideanGrouping(2.5));
  add("depth clustering (defaults)", depth.limits, DepthGrouping(depth));
  add("depth clustering (tuned)", kAnySize, DepthGrouping(tuned_depth));
  add("depth clustering (tuned, 3 returns or more)", kThreeOrMore, DepthGrouping(tuned_depth));
  add("F3D (defaults)", kAnySize, F3dGrouping(f3d, mounting));
  add("F3D (tuned)", kAnySize, F3dGrouping(tuned_f3d, mounting));
  add("F3D (tuned, 3 returns or more)", kThreeOrMore, F3dGrouping(tuned_f3d, mounting));
  return methods;
}

}  // namespace lookout::eval
