// The result in words, for whoever mounts the lidar.
#pragma once

#include <string>

#include "tools/calibrate/calibration.hpp"

namespace lookout::calibrate {

/// The results with deviations, the missing motions, and the lines for boat.txtpb; after a refusal its reason instead.
std::string ReportOf(const Calibration& calibration, const config::BoatFacts& boat);

/// One line "name value sd" a number, for scripts: angles in degrees, latency in ms, height in m. Empty where there is no fit.
std::string FiguresOf(const Calibration& calibration);

/// Step of the latencies in PairsCsv.
inline constexpr double kCsvLatencyStepS = 0.002;

/// A CSV of the pairs of the last fit, with which another program can repeat it: times; the motion by the lidar (rows of [R t]); its weight; both
/// poses, for the latency that was found less a step, for that latency, and for a step more. Poses are in metres from the first one.
std::string PairsCsv(const Calibration& calibration, const PoseTrack& track);

}  // namespace lookout::calibrate
