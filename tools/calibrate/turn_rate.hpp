// Latency between lidar and heading: compares the rate of turn past standing things with the rate by POSE.
#pragma once

#include <optional>
#include <vector>

#include "services/odometer/core/odometer.hpp"
#include "tools/calibrate/pose_track.hpp"

namespace lookout::calibrate {

struct TurnLatency {
  double latency_s = 0.0;  // as Correction::latency_s
  double sd_s = 0.0;
  double rate_rms_radps = 0.0;  // of the changes of the rate of turn, by POSE
  std::size_t num_motions = 0;
};

/// Least squares of the difference of both rates over shifts of up to 1 s, on a grid of 10 ms, with a parabola through the least.
///
/// @return nullopt where fewer than 50 motions are known, or the rate changes too little to tell a shift
std::optional<TurnLatency> LatencyByTurning(const std::vector<odometer::Motion>& motions, const PoseTrack& track);

/// How the boat moved from scan to scan, by odometer::Odometer.
std::vector<odometer::Motion> OdometryOf(const std::vector<odometer::Scan>& scans, const odometer::OdometerParams& params);

}  // namespace lookout::calibrate
