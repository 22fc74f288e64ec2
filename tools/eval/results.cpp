#include "tools/eval/results.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lookout::eval {
namespace {

double Ratio(double sum, std::int64_t count) { return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN(); }

template <typename Key, typename Sum>
void AddTo(std::map<Key, std::pair<std::int64_t, Sum>>& sums, const std::map<Key, std::pair<std::int64_t, Sum>>& more) {
  for (const auto& [key, sum] : more) {
    auto& total = sums[key];
    total.first += sum.first;
    total.second += sum.second;
  }
}

}  // namespace

void Score::Add(const Score& other) {
  num_scans += other.num_scans;
  num_scans_with_object += other.num_scans_with_object;
  sum_iou += other.sum_iou;
  num_scans_with_water_object += other.num_scans_with_water_object;
  sum_water_iou += other.sum_water_iou;
  AddTo(iou_by_kind, other.iou_by_kind);
  AddTo(recall_by_range, other.recall_by_range);
  for (const auto& [kind, more] : other.near_recall_by_kind) {
    auto& recall = near_recall_by_kind[kind];
    recall.num_object_scans += more.num_object_scans;
    recall.num_found += more.num_found;
  }
  AddTo(iou_by_range, other.iou_by_range);
  num_segments += other.num_segments;
  num_false_segments += other.num_false_segments;
  num_object_scans += other.num_object_scans;
  num_things += other.num_things;
  num_things_with_segment += other.num_things_with_segment;
  num_over_segmented += other.num_over_segmented;
  num_under_segmented += other.num_under_segmented;
  num_returns += other.num_returns;
  num_labelled_returns += other.num_labelled_returns;
  num_not_scored += other.num_not_scored;
  num_scans_with_components += other.num_scans_with_components;
  num_components += other.num_components;
  time_ms.insert(time_ms.end(), other.time_ms.begin(), other.time_ms.end());
}

double MeanIou(const Score& score) { return Ratio(score.sum_iou, score.num_scans_with_object); }

double MeanWaterIou(const Score& score) { return Ratio(score.sum_water_iou, score.num_scans_with_water_object); }

double FalseSegmentsPerScan(const Score& score) { return Ratio(static_cast<double>(score.num_false_segments), score.num_scans); }

double ThingsWithSegment(const Score& score) { return Ratio(static_cast<double>(score.num_things_with_segment), score.num_things); }

double SegmentsPerScan(const Score& score) { return Ratio(static_cast<double>(score.num_segments), score.num_scans); }

double OverSegmentedShare(const Score& score) { return Ratio(static_cast<double>(score.num_over_segmented), score.num_object_scans); }

double UnderSegmentedShare(const Score& score) { return Ratio(static_cast<double>(score.num_under_segmented), score.num_segments); }

double TruePositiveRatio(const Score& score) { return Ratio(static_cast<double>(score.num_labelled_returns), score.num_returns); }

double ComponentsPerScan(const Score& score) { return Ratio(static_cast<double>(score.num_components), score.num_scans_with_components); }

bool HasPartialView(const MethodResult& method) {
  return std::ranges::any_of(method.by_scene, [](const auto& entry) { return entry.second.num_not_scored > 0; });
}

double MeanOverScenes(const Results& results, const MethodResult& method, const Figure& figure) {
  double sum = 0.0;
  std::int64_t count = 0;
  for (const auto& scene : results.scenes) {
    const auto found = method.by_scene.find(scene);
    if (found == method.by_scene.end()) continue;
    const double value = figure(found->second);
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return Ratio(sum, count);
}

bool IsPeer(const MethodResult& method) { return !method.method.starts_with("ours") && !method.method.starts_with("paper"); }

bool IsTunedPeer(const MethodResult& method) { return IsPeer(method) && method.method.find("(tuned") != std::string::npos; }

}  // namespace lookout::eval
