#include "lab/eval/methods/method_comparison.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "lab/eval/methods/near_land.hpp"
#include "lab/eval/methods/scoring.hpp"

namespace lookout::eval {
namespace {

double ToMs(std::chrono::nanoseconds duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

}  // namespace

MethodComparison::MethodComparison(const Methods& methods, ScoredScanHandler on_scored) : methods_(methods), on_scored_(std::move(on_scored)) {
  for (const auto& method : methods) {
    results_.push_back({method->name() + std::string(method->knows_doubt() ? kAllSegments : ""), {}, {}, {}});
    if (method->knows_doubt()) results_.push_back({method->name() + std::string(kSureOnly), {}, {}, {}});
  }
}

void MethodComparison::Add(const ScanPlace& place, const LabelledScan& truth) {
  auto result = results_.begin();
  const auto near_land = NearLand(truth, Score::kNearLandM);
  for (const auto& method : methods_) {
    if (!method->BeginScan(place)) {
      result += method->knows_doubt() ? 2 : 1;
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    auto labelling = method->Segment(truth.scan);
    const double time_ms = ToMs(std::chrono::steady_clock::now() - begin - labelling.untimed);
    for (const auto& [stage, stage_time] : labelling.stages) result->stage_ms[stage].push_back(ToMs(stage_time));
    if (method->knows_doubt()) {
      AddPoint(*result++, place, truth, near_land, labelling, time_ms);
      labelling = SureOnly(std::move(labelling));
    }
    AddPoint(*result++, place, truth, near_land, std::move(labelling), time_ms);
  }
}

void MethodComparison::AddPoint(MethodResult& result, const ScanPlace& place, const LabelledScan& truth, const std::set<std::int32_t>& near_land,
                                Labelling labelling, double time_ms) {
  Score score = ScoreScan(truth, labelling, near_land);
  if (on_scored_) on_scored_(result.method, place, truth, labelling.label, score);
  if (labelling.is_timed) score.time_ms.push_back(time_ms);
  result.by_scene[place.scene].Add(score);
  if (score.iou.count > 0) KeepIfBad(result, place, score.iou.value(), truth, std::move(labelling.label));
}

void MethodComparison::KeepIfBad(MethodResult& result, const ScanPlace& place, double iou, const LabelledScan& truth,
                                 std::vector<std::int32_t> label) const {
  auto& worst = result.worst;
  const auto same_scene = std::ranges::find(worst, place.scene, &WorstScan::scene);
  if (same_scene != worst.end()) {
    if (same_scene->iou <= iou) return;
    worst.erase(same_scene);
  } else if (worst.size() == kMaxWorstScans) {
    if (worst.back().iou <= iou) return;
    worst.pop_back();
  }
  const auto at = std::ranges::upper_bound(worst, iou, {}, &WorstScan::iou);
  worst.insert(at, {place.scene, place.seed, place.index, iou, truth, std::move(label)});
}

}  // namespace lookout::eval
