#include "services/segmenter/core/segmenter.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace lookout::segmenter {

namespace {

constexpr std::int32_t kMaxSegments = std::numeric_limits<std::int16_t>::max();

std::vector<std::int32_t> EachByItself(const Groups& components) {
  std::vector<std::int32_t> cluster_of(static_cast<std::size_t>(components.count));
  std::iota(cluster_of.begin(), cluster_of.end(), 0);
  return cluster_of;
}

// Labels of the returns that are not looked at, completed.
std::vector<std::int16_t> LabelReturns(ClassifiedReturns classified, const Groups& components, const Groups& segments) {
  auto label = std::move(classified.label);
  const auto& returns = classified.returns;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::int32_t segment = segments.of_return[i];
    const Reason reason = components.of_return[i] == Groups::kNone ? Reason::kShadowed : Reason::kTooSmall;
    label[static_cast<std::size_t>(returns[i].cell)] = segment == Groups::kNone ? ToLabel(reason) : static_cast<std::int16_t>(segment + 1);
  }
  for (const auto& repeat : classified.repeats) {
    label[static_cast<std::size_t>(repeat.cell)] = label[static_cast<std::size_t>(returns[static_cast<std::size_t>(repeat.of_return)].cell)];
  }
  return label;
}

}  // namespace

NumberedSegments NumberSegments(const Groups& components, std::span<const std::int32_t> cluster_of_component, int min_points,
                                std::int32_t max_segments) {
  struct Cluster {
    std::int32_t num_points = 0;
    std::int32_t number = Groups::kNone;  // in the order of the first return
  };
  std::vector<Cluster> clusters(cluster_of_component.size());
  std::vector<std::int32_t> in_order;  // clusters that are kept
  NumberedSegments result;
  const auto cluster_of = [&](std::size_t i) { return cluster_of_component[static_cast<std::size_t>(components.of_return[i])]; };
  for (std::size_t i = 0; i < components.of_return.size(); ++i) {
    if (components.of_return[i] == Groups::kNone) continue;
    Cluster& cluster = clusters[static_cast<std::size_t>(cluster_of(i))];
    if (cluster.num_points++ == 0) in_order.push_back(cluster_of(i));
  }
  const auto size_of = [&](std::int32_t cluster) { return clusters[static_cast<std::size_t>(cluster)].num_points; };
  result.num_too_small = static_cast<std::int32_t>(std::erase_if(in_order, [&](std::int32_t cluster) { return size_of(cluster) < min_points; }));
  const auto limit = static_cast<std::size_t>(max_segments);
  if (in_order.size() > limit) {
    // Keeps the largest; of equals, the first.
    auto by_size = in_order;
    std::ranges::stable_sort(by_size, std::ranges::greater(), size_of);
    for (std::size_t i = limit; i < by_size.size(); ++i) clusters[static_cast<std::size_t>(by_size[i])].num_points = 0;
    result.num_over_limit = static_cast<std::int32_t>(std::erase_if(in_order, [&](std::int32_t cluster) { return size_of(cluster) == 0; }));
  }
  for (const std::int32_t cluster : in_order) clusters[static_cast<std::size_t>(cluster)].number = result.groups.count++;
  result.groups.of_return.assign(components.of_return.size(), Groups::kNone);
  for (std::size_t i = 0; i < components.of_return.size(); ++i) {
    if (components.of_return[i] != Groups::kNone) result.groups.of_return[i] = clusters[static_cast<std::size_t>(cluster_of(i))].number;
  }
  return result;
}

Segments SegmentScan(const Scan& scan, const Params& params) {
  auto classified = ClassifyReturns(scan, params.filter);
  const auto& returns = classified.returns;
  const auto components = LabelComponents(scan, returns, params.labelling);
  const auto clusters = params.component_clustering ? ClusterComponents(Centroids(returns, components), params.clustering) : EachByItself(components);
  const auto numbered = NumberSegments(components, clusters, params.min_segment_points, kMaxSegments);
  Segments result;
  const Eigen::Vector3d vessel_up_in_lidar = params.filter.T_vessel_lidar.linear().row(2);
  result.segments = Measure(scan, returns, numbered.groups, vessel_up_in_lidar);
  result.num_repeats = static_cast<std::int64_t>(classified.repeats.size());
  result.label = LabelReturns(std::move(classified), components, numbered.groups);
  result.num_too_small = numbered.num_too_small;
  result.num_over_limit = numbered.num_over_limit;
  return result;
}

}  // namespace lookout::segmenter
