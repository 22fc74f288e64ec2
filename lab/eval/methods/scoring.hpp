// Scores: one scan's labels against the truth.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "lab/eval/methods/results.hpp"

namespace lookout::eval {

/// The operating point at which only sure segments count: returns of tentative segments are in none.
Labelling SureOnly(Labelling labelling);

/// Objects and segments of the cells with a return whose label is not kNotScored.
///
/// @throws std::logic_error unless labels and cells agree in number
Confusion::Matches MatchScan(const LabelledScan& truth, const std::vector<std::int32_t>& label);

/// An object of a scan that the method did not find.
struct LostThing {
  std::int32_t object = 0;
  std::int64_t num_returns = 0;
  double range_m = 0.0;  // of the object's nearest return
  double iou = 0.0;
  Fate fate;
};

/// Things of Score::kMinReturnsOfThing or more, in the order of their ids.
std::vector<LostThing> LostThingsOf(const LabelledScan& truth, const std::vector<std::int32_t>& label);

/// Score of a single scan at one operating point, without times: every segment of the labelling counts. README.md defines the figures; found is an
/// IoU of kFoundIou, and components are what the method says. A scan without objects has no IoU.
///
/// @param near_land  objects that lie near land (NearLand)
/// Precondition: labelling.label is as long as the scan has cells; is_sure is not looked at.
/// Ids of segments are names only: numbered otherwise, or with gaps, the score is the same. Cost: n log n in the returns.
Score ScoreScan(const LabelledScan& truth, const Labelling& labelling, const std::set<std::int32_t>& near_land = {});

}  // namespace lookout::eval
