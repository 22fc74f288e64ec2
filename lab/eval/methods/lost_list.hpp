// Each thing that a method lost in a scan, as a row of a CSV file: to count failures by kind, distance and whatever else.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "lab/eval/methods/run_plan.hpp"

namespace lookout::eval {

/// Columns: method, scene, seed, scan (from 0, of the seed), object, name, kind, returns, range_m (of its nearest return), iou, outcome (Outcome),
/// segment (that holds most of its returns), held_by and held_by_kind (the object of most of that segment's returns; empty = none).
class LostList {
 public:
  /// Writes the header. @param out  outlives this
  explicit LostList(std::ostream& out);

  void Add(const std::string& method, const ScanPlace& place, const LabelledScan& truth, const std::vector<std::int32_t>& label);

 private:
  std::ostream& out_;
};

}  // namespace lookout::eval
