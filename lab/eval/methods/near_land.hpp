// Which things lie so near to land that a method may take them for a part of it.
#pragma once

#include <cstdint>
#include <set>

#include "lab/eval/methods/method.hpp"

namespace lookout::eval {

/// @return ids of the objects that are not land (IsLand) with a return nearer to one of land than distance_m, in space
/// The truth alone decides it: it is the same for all methods. Cost: n log n in the returns.
std::set<std::int32_t> NearLand(const LabelledScan& truth, double distance_m);

}  // namespace lookout::eval
