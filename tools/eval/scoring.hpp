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

/// Score of a single scan at one operating point, without times: every segment of the labelling counts.
///
/// Scored are the cells with a return whose label is not kNotScored. Let p_ij be the returns of true object i in segment j, n_i all of the object,
/// m_j all of the segment. Returns of the own vessel and of no object are no object; in a segment they count in m_j.
/// - IoU of object i: the greatest p_ij / (n_i + m_j - p_ij) over the segments, 0 when none holds any of it. mIoU of the scan: the mean over the k
///   objects with a return (the paper's equation). A scan without objects has none. The same over objects in the water alone.
/// - By kind, and by range of the object's nearest return in bins of Score::kRangeBinM: object-scans and their IoU; found is an IoU of kFoundIou. By
///   kind, found among the objects nearer than Score::kNearM.
/// - Thing: an object with Score::kMinReturnsOfThing returns or more. It has a segment when more than half of the returns of some segment are its.
/// - False segment: none of its returns is of an object.
/// - Over-segmented object: two segments or more with p_ij >= n_i / 10. Under-segmented: a segment with p_ij >= n_i / 10 for two objects or more.
/// - Components: as the method says.
/// - True positive (the paper's TPR): a return of an object in a segment that belongs to that object. A segment belongs to whatever has most
///   returns in it; of equals to an object before the own vessel and strays, then to the least id.
///
/// Precondition: labelling.label is as long as the scan has cells; is_sure is not looked at.
/// Ids of segments are names only: numbered otherwise, or with gaps, the score is the same. Cost: n log n in the returns.
Score ScoreScan(const LabelledScan& truth, const Labelling& labelling);

}  // namespace lookout::eval
