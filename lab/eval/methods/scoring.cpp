#include "lab/eval/methods/scoring.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "lab/eval/methods/label_entropy.hpp"

namespace lookout::eval {

Labelling SureOnly(Labelling labelling) {
  for (auto& label : labelling.label) {
    if (label > 0 && !labelling.is_sure.empty() && !labelling.is_sure.at(static_cast<std::size_t>(label - 1))) label = 0;
  }
  labelling.is_sure.clear();
  labelling.probability.reset();  // of all segments together
  return labelling;
}

Confusion::Matches MatchScan(const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  const auto& range = truth.scan.columns.range;
  if (label.size() != range.size() || truth.object.size() != range.size()) throw std::logic_error("MatchScan: labels and cells do not agree");
  Confusion confusion;
  for (std::size_t cell = 0; cell < range.size(); ++cell) {
    if (range[cell] != 0 && label[cell] != kNotScored) confusion.Add(truth.object[cell], label[cell]);
  }
  return confusion.Match();
}

namespace {

bool IsThing(const ScanObject& about, const Confusion::Object& object) { return object.num_returns >= Score::kMinReturnsOfThing && !IsLand(about); }

// Range of the nearest scored return of each object.
std::map<std::int32_t, double> NearestM(const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  std::map<std::int32_t, double> nearest_m;
  for (std::size_t cell = 0; cell < label.size(); ++cell) {
    const auto range = truth.scan.columns.range[cell];
    if (range == 0 || label[cell] == kNotScored) continue;
    auto& least_m = nearest_m.try_emplace(truth.object[cell], std::numeric_limits<double>::infinity()).first->second;
    least_m = std::min(least_m, range * truth.scan.head.range_unit_m);
  }
  return nearest_m;
}

// Segments more than half of land, of a scan in which land is seen.
void CountLandSegments(const LabelledScan& truth, const Confusion::Matches& matches, Score& score) {
  const auto is_land = [&truth](std::int32_t id) { return id > 0 && IsLand(truth.objects.at(id)); };
  const auto num_objects = std::ranges::count_if(matches.objects, [&](const auto& entry) { return is_land(entry.first); });
  if (num_objects == 0) return;
  const auto is_of_land = [&](const auto& entry) {
    std::int64_t num_of_land = 0;
    for (const auto& [id, count] : entry.second.returns_by_object) num_of_land += is_land(id) ? count : 0;
    return 2 * num_of_land > entry.second.num_returns;
  };
  const auto num_segments = static_cast<double>(std::ranges::count_if(matches.segments, is_of_land));
  score.land_segments.Add(num_segments);
  score.segments_of_land_object.Add({num_objects, num_segments});
}

}  // namespace

std::vector<LostThing> LostThingsOf(const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  const auto matches = MatchScan(truth, label);
  const auto nearest_m = NearestM(truth, label);
  std::vector<LostThing> lost;
  for (const auto& [id, object] : matches.objects) {
    if (!IsThing(truth.objects.at(id), object) || object.iou >= kFoundIou) continue;
    lost.push_back({id, object.num_returns, nearest_m.at(id), object.iou, FateOf(id, matches, truth.objects)});
  }
  return lost;
}

Score ScoreScan(const LabelledScan& truth, const Labelling& labelling, const std::set<std::int32_t>& near_land) {
  const auto matches = MatchScan(truth, labelling.label);
  const auto nearest_m = NearestM(truth, labelling.label);
  Score score;
  for (std::size_t cell = 0; cell < labelling.label.size(); ++cell) {
    if (truth.scan.columns.range[cell] != 0 && labelling.label[cell] == kNotScored) ++score.num_not_scored;
  }

  Mean iou;
  Mean water_iou;
  for (const auto& [id, object] : matches.objects) {
    const auto& about = truth.objects.at(id);
    const double is_found = object.iou >= kFoundIou ? 1.0 : 0.0;
    const int bin = static_cast<int>(nearest_m.at(id) / Score::kRangeBinM);
    iou.Add(object.iou);
    if (about.is_in_water) water_iou.Add(object.iou);
    score.iou_by_kind[about.kind].Add(object.iou);
    score.recall_by_range[bin].Add(is_found);
    score.iou_by_range[bin].Add(object.iou);
    if (nearest_m.at(id) < Score::kNearM) score.near_recall_by_kind[about.kind].Add(is_found);
    if (object.num_returns >= Score::kMinReturnsOfThing) score.with_segment.Add(object.has_own_segment ? 1.0 : 0.0);
    if (IsThing(about, object)) {
      score.outcomes_by_kind[about.kind].Add(FateOf(id, matches, truth.objects).outcome);
      if (about.is_in_water && near_land.contains(id)) score.near_land_found.Add(is_found);
    }
    score.over_segmented.Add(object.num_parts >= 2 ? 1.0 : 0.0);
    score.true_positives.count += object.num_returns;
  }
  if (iou.count > 0) score.iou.Add(iou.value());
  if (water_iou.count > 0) score.water_iou.Add(water_iou.value());

  double num_false = 0.0;
  for (const auto& [label, segment] : matches.segments) {
    score.under_segmented.Add(segment.num_parts >= 2 ? 1.0 : 0.0);
    if (!segment.has_object) ++num_false;
    if (segment.majority_object > 0) score.true_positives.sum += static_cast<double>(segment.num_of_majority);
  }
  CountLandSegments(truth, matches, score);
  const auto entropy = EntropyOf(matches);
  score.over_entropy.Add(entropy.over);
  score.under_entropy.Add(entropy.under);
  const auto panoptic = PanopticQualityOf(matches);
  score.panoptic_quality.Add(panoptic.quality);
  score.segmentation_quality.Add(panoptic.segmentation);
  score.recognition_quality.Add(panoptic.recognition);
  score.confidence = ConfidenceOf(matches, labelling, Score::kMinReturnsOfThing);
  score.segments.Add(static_cast<double>(matches.segments.size()));
  score.false_segments.Add(num_false);
  if (labelling.num_components) score.components.Add(static_cast<double>(*labelling.num_components));
  return score;
}

}  // namespace lookout::eval
