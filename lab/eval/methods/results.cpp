#include "lab/eval/methods/results.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace lookout::eval {
namespace {

auto AdditiveOfMethod(auto& score) {
  return std::tie(score.iou, score.water_iou, score.segments, score.false_segments, score.with_segment, score.over_segmented, score.under_segmented,
                  score.over_entropy, score.under_entropy, score.panoptic_quality, score.segmentation_quality, score.recognition_quality,
                  score.true_positives, score.components, score.near_land_found, score.land_segments, score.segments_of_land_object,
                  score.iou_by_kind, score.recall_by_range, score.iou_by_range, score.near_recall_by_kind, score.outcomes_by_kind, score.confidence,
                  score.num_not_scored);
}

}  // namespace

void Score::Add(const Score& other) {
  AddEach(AdditiveOfMethod(*this), AdditiveOfMethod(other));
  time_ms.insert(time_ms.end(), other.time_ms.begin(), other.time_ms.end());
}

bool HasPartialView(const MethodResult& method) {
  return std::ranges::any_of(method.by_scene, [](const auto& entry) { return entry.second.num_not_scored > 0; });
}

double MeanOverScenes(const Results& results, const MethodResult& method, Mean Score::*figure) {
  Mean mean;
  for (const auto& scene : results.scenes) {
    const auto found = method.by_scene.find(scene);
    if (found == method.by_scene.end()) continue;
    if (const double value = (found->second.*figure).value(); std::isfinite(value)) mean.Add(value);
  }
  return mean.value();
}

Score Total(const MethodResult& method) {
  Score total;
  for (const auto& [scene, score] : method.by_scene) total.Add(score);
  return total;
}

bool IsPeer(const MethodResult& method) { return !method.method.starts_with("ours") && !method.method.starts_with("paper"); }

bool IsTunedPeer(const MethodResult& method) { return IsPeer(method) && method.method.find("(tuned") != std::string::npos; }

}  // namespace lookout::eval
