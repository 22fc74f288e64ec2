// Returns of a scan from above, for pictures.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/eval/methods/method.hpp"

namespace lookout::eval {

/// A return, by true object (0 = none; returns that the method does not look at belong to none here) and segment (0 = none).
struct Spot {
  std::int32_t object = 0;
  std::int32_t segment = 0;
  double right_m = 0.0;  // of the lidar's x axis, seen from above
  double forward_m = 0.0;
};

/// In the order of the cells. Precondition: a label and a true object for each cell
std::vector<Spot> SpotsOf(const LabelledScan& truth, const std::vector<std::int32_t>& label);

}  // namespace lookout::eval
