#include "tools/eval/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lookout::eval {

void Confusion::Add(int object_id, int label) {
  if (object_id > 0) ++object_returns_[object_id];
  if (label > 0) {
    ++segment_returns_[label];
    ++returns_by_segment_[label][object_id];
  }
}

std::vector<Confusion::ObjectScore> Confusion::Scores() const {
  std::vector<ObjectScore> scores;
  for (const auto& [object_id, num_object] : object_returns_) {
    ObjectScore score{object_id, num_object, 0.0, false};
    for (const auto& [label, by_object] : returns_by_segment_) {
      const auto found = by_object.find(object_id);
      if (found == by_object.end()) continue;
      const std::int64_t num_both = found->second;
      const std::int64_t num_segment = segment_returns_.at(label);
      score.iou = std::max(score.iou, static_cast<double>(num_both) / static_cast<double>(num_object + num_segment - num_both));
      if (2 * num_both > num_segment) score.has_own_segment = true;
    }
    scores.push_back(score);
  }
  return scores;
}

int Confusion::MajorityObject(int label) const {
  const auto found = returns_by_segment_.find(label);
  if (found == returns_by_segment_.end()) return 0;
  int best = 0;
  std::int64_t best_count = 0;
  for (const auto& [object_id, count] : found->second) {
    if (count > best_count || (count == best_count && best <= 0)) {
      best = object_id;
      best_count = count;
    }
  }
  return best;
}

std::vector<int> Confusion::ClutterSegments() const {
  std::vector<int> labels;
  for (const auto& [label, by_object] : returns_by_segment_) {
    if (by_object.size() == 1 && by_object.begin()->first == 0) labels.push_back(label);
  }
  return labels;
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
