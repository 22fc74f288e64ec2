// Tests 1 to 3 of the paper on our scenes, with the paper's method at its full width.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "lab/eval/methods/results.hpp"
#include "lab/eval/methods/run_plan.hpp"

namespace lookout::eval {

/// Test 1 (scene kayak_shore): from how far off the shore is the kayak its own segment? Test 2 (shore_20m): a shore should be one object. Test 3
/// (motorboat_6m): the same of a motor boat. README.md (Definitions) says what is counted. e2 is 50 degrees in Tests 1 and 3, e3 is 3.5 m in Tests 1
/// and 2, e1 is 0.95 in 2 and 3.
///
/// @param number   1, 2 or 3
/// @param plan     seeds and, for Tests 2 and 3, seconds; its scenes are not looked at. Test 1 takes the 40 s that its kayak needs
/// @throws config::ConfigError as ForEachScan; std::runtime_error when the scene of a test does not hold one kayak, shore or motor boat
Curve RunPaperTest(int number, RunPlan plan, const Boat& boat, std::FILE* progress);

/// Of Test 1: a scan in which the kayak and the shore are seen.
struct ShoreGap {
  double distance_m = 0.0;  // from the kayak's returns to the nearest of any other object
  double iou = 0.0;         // of the kayak
};

/// @return the least distance from which on the kayak is its own segment: in steps of a metre up to 30 m, those with scans, its mean IoU is kFoundIou
///         or more; nullopt when it is not even at the farthest
std::optional<double> OwnSegmentFromM(const std::vector<ShoreGap>& gaps);

}  // namespace lookout::eval
