#include "lab/eval/baselines/dbscan.hpp"

#include <cstddef>

#include "lab/eval/baselines/point_tree.hpp"

namespace lookout::eval {

std::vector<std::int32_t> Dbscan(std::span<const segmenter::Point> points_m, const DbscanParams& params) {
  std::vector<std::int32_t> cluster_of(points_m.size(), kNoise);
  if (points_m.empty()) return cluster_of;
  const PointTree tree({points_m.begin(), points_m.end()});
  std::vector<std::int32_t> neighbours;
  // Finds the neighbours of a point. @return whether it is a core point
  const auto is_core = [&](std::int32_t index) {
    tree.FindWithin(points_m[static_cast<std::size_t>(index)], params.radius_m, neighbours);
    return static_cast<int>(neighbours.size()) >= params.min_points;
  };
  std::int32_t num_clusters = 0;
  std::vector<std::int32_t> queue;
  for (std::size_t first = 0; first < points_m.size(); ++first) {
    if (cluster_of[first] != kNoise || !is_core(static_cast<std::int32_t>(first))) continue;
    cluster_of[first] = num_clusters;
    queue.assign(1, static_cast<std::int32_t>(first));
    for (std::size_t next = 0; next < queue.size(); ++next) {
      if (!is_core(queue[next])) continue;
      for (const auto neighbour : neighbours) {
        auto& cluster = cluster_of[static_cast<std::size_t>(neighbour)];
        if (cluster != kNoise) continue;
        cluster = num_clusters;
        queue.push_back(neighbour);
      }
    }
    ++num_clusters;
  }
  return cluster_of;
}

}  // namespace lookout::eval
