#include "services/segmenter/core/numbering.hpp"

#include <algorithm>

namespace lookout::segmenter {

void Numbering::Number(const Groups& components, std::span<const std::int32_t> cluster_of_component, int min_points, std::int32_t max_segments) {
  clusters_.assign(cluster_of_component.size(), {});
  in_order_.clear();
  const auto cluster_of = [&](std::size_t i) { return cluster_of_component[static_cast<std::size_t>(components.of_return[i])]; };
  for (std::size_t i = 0; i < components.of_return.size(); ++i) {
    if (components.of_return[i] == Groups::kNone) continue;
    Cluster& cluster = clusters_[static_cast<std::size_t>(cluster_of(i))];
    if (cluster.num_points++ == 0) in_order_.push_back(cluster_of(i));
  }
  const auto size_of = [&](std::int32_t cluster) { return clusters_[static_cast<std::size_t>(cluster)].num_points; };
  num_too_small_ = static_cast<std::int32_t>(std::erase_if(in_order_, [&](std::int32_t cluster) { return size_of(cluster) < min_points; }));
  num_over_limit_ = 0;
  const auto limit = static_cast<std::size_t>(max_segments);
  if (in_order_.size() > limit) {
    auto by_size = in_order_;
    std::ranges::stable_sort(by_size, std::ranges::greater(), size_of);
    for (std::size_t i = limit; i < by_size.size(); ++i) clusters_[static_cast<std::size_t>(by_size[i])].num_points = 0;
    num_over_limit_ = static_cast<std::int32_t>(std::erase_if(in_order_, [&](std::int32_t cluster) { return size_of(cluster) == 0; }));
  }
  groups_.count = 0;
  for (const std::int32_t cluster : in_order_) clusters_[static_cast<std::size_t>(cluster)].number = groups_.count++;
  groups_.of_return.assign(components.of_return.size(), Groups::kNone);
  for (std::size_t i = 0; i < components.of_return.size(); ++i) {
    if (components.of_return[i] != Groups::kNone) groups_.of_return[i] = clusters_[static_cast<std::size_t>(cluster_of(i))].number;
  }
}

}  // namespace lookout::segmenter
