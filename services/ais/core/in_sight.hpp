// Whether the lidar should see a ship: near enough, in its field of view, and with nothing nearer in between.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "common/core/angles.hpp"
#include "common/core/pose.hpp"
#include "services/ais/core/association.hpp"
#include "services/ais/core/likelihood.hpp"
#include "services/ais/core/ships.hpp"

namespace lookout::ais {

struct SightParams {
  double range_m = 50.0;     // the lidar sees the hull of any ship within this range
  double min_range_m = 1.0;  // of the segmenter
  Sector field_of_view;      // of the segmenter, lidar frame, counter-clockwise from its x axis
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
};

/// @param own        pose of the own boat in the map, placed
/// @param tracks     all that is tracked: it hides what is behind
/// @param shore_m    middles of remembered land where free water meets it, map frame
/// @return true where wherever the ship is, within twice the deviation of its place, at least four fifths of it are in free sight, and no land is so
/// near that it may be taken for a part of it
bool ShouldBeSeen(const ShipInReach& ship, const Place& own, std::span<const TrackedThing> tracks, std::span<const Eigen::Vector2d> shore_m,
                  const SightParams& params);

}  // namespace lookout::ais
