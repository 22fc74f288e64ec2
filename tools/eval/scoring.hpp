// Scores: one scan's labels against the truth.
#pragma once

#include "tools/eval/method.hpp"
#include "tools/eval/results.hpp"

namespace lookout::eval {

/// IoU from which an object counts as found.
inline constexpr double kFoundIou = 0.5;

/// The operating point at which only what the method is sure of counts: returns of tentative segments are in none.
Labelling SureOnly(Labelling labelling);

/// Objects and segments of the cells with a return whose label is not kNotScored.
///
/// @throws std::logic_error unless labels and cells agree in number
Confusion::Matches MatchScan(const LabelledScan& truth, const std::vector<std::int32_t>& label);

/// Score of a single scan at one operating point, without times: every segment of the labelling counts. README.md defines the figures; found is an
/// IoU of kFoundIou, and components are what the method says. A scan without objects has no IoU.
///
/// Precondition: labelling.label is as long as the scan has cells; is_sure is not looked at.
/// Ids of segments are names only: numbered otherwise, or with gaps, the score is the same. Cost: n log n in the returns.
Score ScoreScan(const LabelledScan& truth, const Labelling& labelling);

}  // namespace lookout::eval
