// From the filter's state to POSE.
#pragma once

#include <optional>
#include <string>

#include "common/core/geodesy.hpp"
#include "services/navigator/core/filter/params.hpp"
#include "services/navigator/core/filter/state.hpp"
#include "services/navigator/core/pose.hpp"

namespace lookout::navigator::filter {

/// @param map  of the datum; nullptr: no datum is known yet
Pose ToPose(const State& state, const std::optional<Datum>& datum, const LocalFrame* map, const FilterParams& params);

/// The inputs that came and do not come any more: "no position fix for 3 s, no heading for 2 s"; empty = none.
std::string StoppedInputs(const State& state);

}  // namespace lookout::navigator::filter
