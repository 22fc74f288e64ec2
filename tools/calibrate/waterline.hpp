// Height of the lidar above the water, by the feet of upright faces: quays, hulls, walls.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "tools/calibrate/pose_track.hpp"
#include "tools/calibrate/surroundings.hpp"

namespace lookout::calibrate {

struct WaterHeight {
  double lidar_above_water_m = 0.0;  // when the boat floats at rest
  double sd_m = 0.0;
  std::size_t num_feet = 0;
};

/// Between the lowest ring that met an upright face and the next lower one, which met nothing, lies the water. Each such pair is an interval of
/// heights; the height that most of them hold, narrow ones counting for more, is told.
///
/// @param assumed  with the mounting that was found
/// @return nullopt where fewer than 500 feet are seen, in fewer than five of eight parts of the time, or the rings do not lie about level
std::optional<WaterHeight> HeightAboveWater(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed);

}  // namespace lookout::calibrate
