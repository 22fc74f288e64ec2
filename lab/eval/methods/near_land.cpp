#include "lab/eval/methods/near_land.hpp"

#include <utility>
#include <vector>

#include "lab/eval/baselines/point_tree.hpp"
#include "lab/eval/methods/outcome.hpp"
#include "services/segmenter/core/returns.hpp"

namespace lookout::eval {

std::set<std::int32_t> NearLand(const LabelledScan& truth, double distance_m) {
  std::vector<segmenter::Point> land_m;
  std::vector<std::pair<std::int32_t, segmenter::Point>> things_m;
  for (const auto& one : segmenter::ClassifyReturns(truth.scan, {}).returns) {
    const auto id = truth.object[static_cast<std::size_t>(one.cell)];
    if (id <= 0) continue;
    if (IsLand(truth.objects.at(id))) {
      land_m.push_back(one.point);
    } else {
      things_m.emplace_back(id, one.point);
    }
  }
  std::set<std::int32_t> near_land;
  const PointTree tree(std::move(land_m));
  for (const auto& [id, point_m] : things_m) {
    if (near_land.contains(id)) continue;
    const auto nearest = tree.FindNearest(point_m);
    if (nearest && nearest->distance_m < distance_m) near_land.insert(id);
  }
  return near_land;
}

}  // namespace lookout::eval
