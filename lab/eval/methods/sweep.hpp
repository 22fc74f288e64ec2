// One field of the segmenter's config over a range of values: a curve of mIoU for each scene.
#pragma once

#include <string>
#include <vector>

#include "lab/eval/methods/results.hpp"
#include "lab/eval/methods/run_plan.hpp"

namespace lookout::eval {

struct Sweep {
  std::string field;           // of config/schema/segmenter.proto
  std::vector<double> values;  // from, from + step, ... up to `to`
};

/// Reads FIELD=FROM:TO:STEP; FIELD is any number of config/schema/segmenter.proto, or e1, e2, e3 for the thresholds of the paper.
///
/// @throws std::invalid_argument with the reason, and the fields that there are where that helps
Sweep ParseSweep(const std::string& text);

/// The config of the boat with one field set.
///
/// @throws config::ConfigError as the loader, when the value is out of the field's range
segmenter::Params ParamsWith(const Boat& boat, const std::string& field, double value);

/// mIoU in per cent against the field, all else as the boat's config has it: a line for each scene with objects.
Curve RunSweep(const Sweep& sweep, const RunPlan& plan, const Boat& boat, std::FILE* progress);

/// At most so many values: a step that is too small is a slip of the pen.
inline constexpr int kMaxSweepValues = 200;

}  // namespace lookout::eval
