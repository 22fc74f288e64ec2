#include "tools/eval/scoring.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>

namespace lookout::eval {

Labelling SureOnly(Labelling labelling) {
  for (auto& label : labelling.label) {
    if (label > 0 && !labelling.is_sure.empty() && !labelling.is_sure.at(static_cast<std::size_t>(label - 1))) label = 0;
  }
  labelling.is_sure.clear();
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

Score ScoreScan(const LabelledScan& truth, const Labelling& labelling) {
  const auto matches = MatchScan(truth, labelling.label);
  Score score;
  std::map<std::int32_t, double> nearest_m;  // of each object
  for (std::size_t cell = 0; cell < labelling.label.size(); ++cell) {
    const auto range = truth.scan.columns.range[cell];
    if (range == 0) continue;
    if (labelling.label[cell] == kNotScored) {
      ++score.num_not_scored;
    } else {
      auto& least_m = nearest_m.try_emplace(truth.object[cell], std::numeric_limits<double>::infinity()).first->second;
      least_m = std::min(least_m, range * truth.scan.head.range_unit_m);
    }
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
  score.segments.Add(static_cast<double>(matches.segments.size()));
  score.false_segments.Add(num_false);
  if (labelling.num_components) score.components.Add(static_cast<double>(*labelling.num_components));
  return score;
}

}  // namespace lookout::eval
