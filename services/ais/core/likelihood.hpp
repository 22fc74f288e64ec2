// How well a track fits a ship of AIS: log odds that both are one, against the track being anything else.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/core/elementary.hpp"
#include "services/ais/core/ships.hpp"

namespace lookout::ais {

/// A confirmed track at the end of a scan, as TRACKS has it. Map frame.
struct TrackedThing {
  std::int64_t id = 0;
  Eigen::Vector2d center_map_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();  // with the error of the own position
  Eigen::Vector2d velocity_map_mps = Eigen::Vector2d::Zero();
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();
  double length_m = kNan;
  double width_m = kNan;
  double length_bearing_rad = kNan;  // from true north, clockwise, 0 to pi
  double seen_share = 0.0;           // of the track's outline, 0 to 1
  std::vector<Eigen::Vector2d> outline_map_m;
};

/// Something that is no ship of AIS stands so often: tracks a square metre.
struct Background {
  double tracks_per_m2 = 0.0;
};

/// Log odds of the mean difference between a track and the place where the ship says it is.
double PositionLogOdds(const Eigen::Vector2d& mean_difference_m, const PredictedShip& ship, const TrackedThing& track, const Background& background);
/// Log odds of length and beam, where both ship and track know them.
double ShapeLogOdds(const Dimensions& dimensions, const TrackedThing& track);
/// Log odds of the direction of the hull, where both ship and track know it.
double HeadingLogOdds(const PredictedShip& ship, const TrackedThing& track);
/// Log odds of course and speed.
double VelocityLogOdds(const PredictedShip& ship, const TrackedThing& track);

}  // namespace lookout::ais
