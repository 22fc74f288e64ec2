#include "services/segmenter/core/numbering.hpp"

#include <algorithm>

namespace lookout::segmenter {

void Numbering::Number(const Groups& components, std::span<const std::int32_t> cluster_of_component, int min_points, std::int32_t max_segments) {
  clusters_.assign(static_cast<std::size_t>(components.count), {});
  const auto cluster_of = [&](std::size_t component) {
    return cluster_of_component.empty() ? static_cast<std::int32_t>(component) : cluster_of_component[component];
  };
  in_order_.clear();
  // Returns that follow each other are of one component in most cases.
  const auto& of_return = components.of_return;
  for (std::size_t i = 0, end = 0; i < of_return.size(); i = end) {
    const std::int32_t component = of_return[i];
    for (end = i + 1; end < of_return.size() && of_return[end] == component;) ++end;
    if (component == Groups::kNone) continue;
    const std::int32_t cluster = cluster_of(static_cast<std::size_t>(component));
    auto& num_points = clusters_[static_cast<std::size_t>(cluster)].num_points;
    if (num_points == 0) in_order_.push_back(cluster);
    num_points += static_cast<std::int32_t>(end - i);
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
  number_of_component_.resize(clusters_.size());
  for (std::size_t component = 0; component < clusters_.size(); ++component) {
    number_of_component_[component] = clusters_[static_cast<std::size_t>(cluster_of(component))].number;
  }
  groups_.of_return.resize(of_return.size());
  for (std::size_t i = 0; i < of_return.size(); ++i) {
    const std::int32_t component = of_return[i];
    groups_.of_return[i] = component == Groups::kNone ? Groups::kNone : number_of_component_[static_cast<std::size_t>(component)];
  }
}

}  // namespace lookout::segmenter
