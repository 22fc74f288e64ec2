// How much time is left, and how much of it this boat needs.
#pragma once

#include "common/core/elementary.hpp"
#include "services/tracker/core/encounter.hpp"

namespace lookout::tracker {

/// Abilities of the own boat. Sources: config/schema/tracker.proto.
struct OwnAbility {
  double reaction_s = 5.0;         // from the alert to the hand on the helm or throttle
  double deceleration_mps2 = 0.5;  // of a stop
  double turn_rate_radps = 0.175;  // of a turn
  double least_braking_s = 1.0;    // of a slow boat, too
};

/// Seconds to stop or to turn aside by 60 degrees, whichever is sooner, with the reaction before it. A slow boat stops within its length.
double TimeToAct(double speed_mps, const OwnAbility& ability);

/// Seconds until the hulls are nearer than the limit, if both keep course and speed: on a straight way d^2 = cpa^2 + v^2 (tcpa - t)^2.
/// @return 0 if they are nearer already and will come nearer by 10 % of their distance, 0.3 m at least; NaN if they never will
double TimeLeft(const ClosestApproach& approach, double limit_m);

}  // namespace lookout::tracker
