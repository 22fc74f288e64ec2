#include "lab/eval/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lookout::eval {

void Confusion::Add(int object_id, int label) {
  if (object_id > 0) ++object_returns_[object_id];
  if (label > 0) ++returns_by_segment_[label][object_id];
}

Confusion::Matches Confusion::Match() const {
  Matches matches;
  for (const auto& [object_id, count] : object_returns_) matches.objects[object_id].num_returns = count;
  for (const auto& [label, by_object] : returns_by_segment_) {
    auto& segment = matches.segments[label];
    segment.returns_by_object = by_object;
    for (const auto& [object_id, count] : by_object) segment.num_returns += count;
    for (const auto& [object_id, num_both] : by_object) {
      if (num_both > segment.num_of_majority || (num_both == segment.num_of_majority && segment.majority_object <= 0)) {
        segment.majority_object = object_id;
        segment.num_of_majority = num_both;
      }
      segment.has_own_vessel = segment.has_own_vessel || object_id < 0;
      if (object_id <= 0) continue;
      segment.has_object = true;
      auto& object = matches.objects.at(object_id);
      object.iou = std::max(object.iou, static_cast<double>(num_both) / static_cast<double>(object.num_returns + segment.num_returns - num_both));
      object.has_own_segment = object.has_own_segment || 2 * num_both > segment.num_returns;
      object.num_in_largest = std::max(object.num_in_largest, num_both);
      ++object.num_segments;
      if (kLeastPartsOfObject * num_both < object.num_returns) continue;
      ++object.num_parts;
      ++segment.num_parts;
    }
  }
  return matches;
}

double Summary::Percentile(int percent) const {
  auto sorted = values_;
  std::ranges::sort(sorted);
  const std::size_t rank = (sorted.size() * static_cast<std::size_t>(percent) + 99) / 100;
  return sorted[rank > 0 ? rank - 1 : 0];
}

double Summary::Mean() const { return std::accumulate(values_.begin(), values_.end(), 0.0) / static_cast<double>(values_.size()); }

double Summary::Rms() const {
  return std::sqrt(std::inner_product(values_.begin(), values_.end(), values_.begin(), 0.0) / static_cast<double>(values_.size()));
}

}  // namespace lookout::eval
