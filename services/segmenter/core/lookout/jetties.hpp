// Part of the first step of the lookout method: where a dock or jetty that touches the shore ends and the shore begins.
#pragma once

#include "services/segmenter/core/lookout/runs.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"

namespace lookout::segmenter {

/// How many returns at one end of a run are a jetty's, seen from the tip; 0 when there is none, all when the run is nothing else.
///
/// A jetty is at most 14 m long and straight for 3 m or more (within 5 cm and 0.003 of the range), from its tip or from the corner of its end face,
/// which is 0.5 to 3.5 m wide. Beyond its tip there is open water: what is seen next to it is 1.5 m farther, if anything. At its foot the run turns
/// by 34 degrees or more into a shore off whose line the tip stands 2 m or more. Where that shore ends in open water, too, it is 15 m or longer: a
/// boat shows two sides as well. Or the run ends at its foot with something near beyond; then only what has an end face of 0.8 m or more, square to
/// within 27 degrees, counts. The bends of a natural shore are no such corners.
///
/// @param from_end  looks at the last returns of the run, else at the first
/// Cost: proportional to the returns looked at.
int JettyReturns(const ScanGrid& grid, const Run& run, bool from_end);

}  // namespace lookout::segmenter
