// Whether the own boat goes towards land, as far as land is remembered.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/core/pose.hpp"
#include "services/tracker/core/encounter.hpp"
#include "services/tracker/core/told_places.hpp"

namespace lookout::tracker {

struct LandApproach {
  ClosestApproach approach;  // to the place that is likely to come too near first; where none is likely, to the likeliest
  double limit_m = 0.0;      // nearer land is too near
  double bearing_rad = 0.0;  // of that place, from the bow clockwise
  std::vector<DangerPlace>
      places;  // places that are likely to come too near: of each bearing the nearest to the boat's way, and of those on the way the nearest
};

/// Land stands, so only the own way counts. A boat beside a quay is nearer to it than the limit all the time. So land is too near only where the way
/// also leads below half of the distance to the nearest land now, which counts as 0.5 m at least.
///
/// @param own       placed, with a velocity; `self` is its hull, velocity and turn
/// @param shore_m   [places] map: cells of land with water before them
/// @param velocity_sd_mps  deviation of the own velocity, along each axis
/// @return nullopt: no land is near the way
/// Cost: some 20 ns for each place of the shore, and 10 us for each bearing that the way comes near to; 100 us in a turn.
std::optional<LandApproach> ApproachToLand(const Pose& own, const Moving& self, std::span<const Eigen::Vector2d> shore_m,
                                           const EncounterParams& params, double velocity_sd_mps);

}  // namespace lookout::tracker
