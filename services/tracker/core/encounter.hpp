// What a track will do: closest approach of two hulls, its probability, and the encounter as the COLREGs see it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/elementary.hpp"

namespace lookout::tracker {

/// A hull and how it moves, in the map frame.
struct Moving {
  std::vector<Eigen::Vector2d> hull_m;  // convex, counter-clockwise, at least one corner
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
};

/// Position and velocity of the one relative to the other: east, north, and their rates.
using RelativeCovariance = Eigen::Matrix4d;

struct EncounterParams {
  double limit_m = 0.0;       // hull to hull
  double look_ahead_s = 0.0;  // what comes later does not count
};

// Numbers are those of the wire.
enum class Encounter : std::int32_t { kNone = 0, kHeadOn = 1, kCrossingGiveWay = 2, kCrossingStandOn = 3, kOvertaking = 4, kOvertaken = 5 };

struct ClosestApproach {
  double distance_m = 0.0;            // hull to hull, now; 0 where they overlap
  double cpa_m = 0.0;                 // hull to hull; that of now where they part, or hardly move against each other
  double tcpa_s = 0.0;                // 0 where they part
  double probability = 0.0;           // that the least distance within look_ahead_s is below limit_m
  double bearing_drift_radps = kNan;  // of the true bearing from own to other, clockwise; NaN where they overlap
};

/// Both keep course and speed, and do not turn. The hulls are convex, so their difference (Minkowski) is one polygon, and the closest approach is
/// that of a point to it.
///
/// Probability: in closed form. The path of the relative position is known across the relative velocity with a normal deviation (position and
/// velocity propagated to the time of the closest approach); where the relative speed does not stand out from its deviation, it is that of a normal
/// spread that grows from the distance now. Error: below 0.01 of a Monte Carlo run (property test tracker_encounter).
/// @param covariance  of (other - own)
ClosestApproach ClosestApproachOf(const Moving& own, const Moving& other, const RelativeCovariance& covariance, const EncounterParams& params);

/// Rules 13 to 15: overtaking from more than 22.5 deg abaft the beam of the one that is overtaken; head-on on nearly reciprocal courses; else
/// crossing, where what is to starboard of the own boat has the right of way. NONE where the other stands, where both part, or beyond look_ahead_s.
/// @param own_course_rad  from north, clockwise: heading where it stands
Encounter EncounterOf(const Moving& own, double own_heading_rad, const Moving& other, const ClosestApproach& approach, const EncounterParams& params);

}  // namespace lookout::tracker
