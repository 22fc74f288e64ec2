#include "lab/eval/baselines/euclidean.hpp"

#include <cstddef>

#include "lab/eval/baselines/point_tree.hpp"

namespace lookout::eval {

namespace {

segmenter::Groups Group(std::span<const segmenter::Return> returns, double distance_m, StageClock& clock) {
  std::vector<segmenter::Point> points_m;
  points_m.reserve(returns.size());
  for (const auto& one : returns) points_m.push_back(one.point);
  const PointTree tree(std::move(points_m));
  clock.End("tree");

  segmenter::Groups groups;
  groups.of_return.assign(returns.size(), segmenter::Groups::kNone);
  std::vector<std::int32_t> queue;
  std::vector<std::int32_t> neighbours;
  for (std::size_t seed = 0; seed < returns.size(); ++seed) {
    if (groups.of_return[seed] != segmenter::Groups::kNone) continue;
    const auto group = groups.count++;
    groups.of_return[seed] = group;
    queue.assign(1, static_cast<std::int32_t>(seed));
    for (std::size_t next = 0; next < queue.size(); ++next) {
      tree.FindWithin(returns[static_cast<std::size_t>(queue[next])].point, distance_m, neighbours);
      for (const auto neighbour : neighbours) {
        auto& neighbours_group = groups.of_return[static_cast<std::size_t>(neighbour)];
        if (neighbours_group != segmenter::Groups::kNone) continue;
        neighbours_group = group;
        queue.push_back(neighbour);
      }
    }
  }
  clock.End("clusters");
  return groups;
}

}  // namespace

Grouping EuclideanGrouping(double distance_m) {
  return [distance_m](const segmenter::Scan&, std::span<const segmenter::Return> returns, StageClock& clock) {
    return Group(returns, distance_m, clock);
  };
}

}  // namespace lookout::eval
