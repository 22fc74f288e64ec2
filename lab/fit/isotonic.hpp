// Values on the corners of a cube that must not fall, or not rise, along some of its edges.
#pragma once

#include <span>

namespace lookout::fit {

/// Puts the nearest values in their place, by weighted least squares, that keep the order: isotonic regression by its max-min formula (T. Robertson,
/// F. Wright and R. Dykstra, "Order Restricted Statistical Inference", 1988, theorem 1.4.4), exact.
///
/// @param signs    [bits, 3 at most] +1: a corner with this bit has at least the value of the one without it; -1: at most; 0: either
/// @param weights  [2^bits] greater than 0
/// @param values   [2^bits] by the corner's number
void ProjectOnSigns(std::span<const int> signs, std::span<const double> weights, std::span<double> values);

}  // namespace lookout::fit
