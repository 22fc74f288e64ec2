// Motions of the boat in the recording, and motions that are missing in it.
#pragma once

#include <string>
#include <vector>

#include "common/core/angles.hpp"
#include "tools/calibrate/calibration.hpp"

namespace lookout::calibrate {

/// Less does not show the mounting.
inline const double kLeastTurnRad = DegToRad(180.0);

Manoeuvres ManoeuvresOf(const Recording& recording, const std::vector<odometer::Motion>& motions);

/// Motions that would show what is not shown yet, in words for whoever steers.
std::vector<std::string> MissingMotions(const Calibration& calibration);

}  // namespace lookout::calibrate
