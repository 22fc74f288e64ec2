#include "lab/eval/results.hpp"

#include <algorithm>
#include <cmath>

namespace lookout::eval {
namespace {

void AddTo(auto& means, const auto& more) {
  for (const auto& [key, mean] : more) means[key].Add(mean);
}

}  // namespace

void Score::Add(const Score& other) {
  for (const auto mean : {&Score::iou, &Score::water_iou, &Score::segments, &Score::false_segments, &Score::with_segment, &Score::over_segmented,
                          &Score::under_segmented, &Score::over_entropy, &Score::under_entropy, &Score::panoptic_quality,
                          &Score::segmentation_quality, &Score::recognition_quality, &Score::true_positives, &Score::components,
                          &Score::near_land_found, &Score::land_segments, &Score::segments_of_land_object}) {
    (this->*mean).Add(other.*mean);
  }
  AddTo(iou_by_kind, other.iou_by_kind);
  AddTo(recall_by_range, other.recall_by_range);
  AddTo(iou_by_range, other.iou_by_range);
  AddTo(near_recall_by_kind, other.near_recall_by_kind);
  for (const auto& [kind, outcomes] : other.outcomes_by_kind) outcomes_by_kind[kind].Add(outcomes);
  confidence.Add(other.confidence);
  num_not_scored += other.num_not_scored;
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
