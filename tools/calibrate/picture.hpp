// Picture of standing things, accumulated on the map, with boat.txtpb and with the result.
#pragma once

#include <string>

#include "tools/calibrate/calibration.hpp"

namespace lookout::calibrate {

/// SVG of two maps side by side, north up: returns of standing things, and the way of the boat. The sharper map has the better mounting.
///
/// @param calibration  with a fit
std::string PictureOf(const Recording& recording, const Calibration& calibration, const CalibrationParams& params);

}  // namespace lookout::calibrate
