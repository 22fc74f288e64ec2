#include "lab/eval/methods/label_entropy.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace lookout::eval {
namespace {

// Entropy of the shares of some parts; empty parts add nothing.
double EntropyOfParts(const std::vector<std::int64_t>& parts) {
  std::int64_t sum = 0;
  for (const auto part : parts) sum += part;
  double entropy = 0.0;
  for (const auto part : parts) {
    if (part == 0) continue;
    const double share = static_cast<double>(part) / static_cast<double>(sum);
    entropy -= share * std::log(share);
  }
  return std::max(entropy, 0.0);  // and not -0
}

}  // namespace

LabelEntropy EntropyOf(const Confusion::Matches& matches) {
  if (matches.objects.empty()) return {};
  std::map<int, std::vector<std::int64_t>> parts_of_object;
  double over = 0.0;
  double under = 0.0;
  for (const auto& [label, segment] : matches.segments) {
    std::vector<std::int64_t> parts{0};  // the first is of no object
    parts.reserve(segment.returns_by_object.size() + 1);
    for (const auto& [object, count] : segment.returns_by_object) {
      if (object > 0) {
        parts.push_back(count);
        parts_of_object[object].push_back(count);
      } else {
        parts.front() += count;
      }
    }
    under += EntropyOfParts(parts);
  }
  for (const auto& [id, object] : matches.objects) {
    auto& parts = parts_of_object[id];
    std::int64_t num_unlabelled = object.num_returns;
    for (const auto part : parts) num_unlabelled -= part;
    parts.push_back(num_unlabelled);
    over += EntropyOfParts(parts);
  }
  return {{1, over}, {1, under}};
}

PanopticQuality PanopticQualityOf(const Confusion::Matches& matches) {
  constexpr double kLeastIou = 0.5;
  std::int64_t num_labels = 0;
  std::int64_t num_pairs = 0;
  double sum_of_iou = 0.0;
  for (const auto& [label, segment] : matches.segments) {
    std::int64_t num_of_objects = 0;
    for (const auto& [object, count] : segment.returns_by_object) num_of_objects += object > 0 ? count : 0;
    if (2 * num_of_objects > segment.num_returns) ++num_labels;
  }
  // The greatest IoU of an object is the only one that can be above a half. Its label is then mostly of it.
  for (const auto& [id, object] : matches.objects) {
    if (object.iou <= kLeastIou) continue;
    ++num_pairs;
    sum_of_iou += object.iou;
  }
  const auto num_both = static_cast<std::int64_t>(matches.objects.size()) + num_labels;  // 2 pairs + objects alone + labels alone
  return {{num_both, 2.0 * sum_of_iou}, {num_pairs, sum_of_iou}, {num_both, 2.0 * static_cast<double>(num_pairs)}};
}

}  // namespace lookout::eval
