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
  double least_braking_s = 1.0;    // however slow it is
};

/// To stop or to turn aside by 60 degrees, whichever is sooner, with the reaction before. A slow boat stops within its length.
double TimeToAct(double speed_mps, const OwnAbility& ability);

/// Until both hulls are nearer than the limit, as both go now: on a straight way d^2 = cpa^2 + v^2 (tcpa - t)^2.
/// @return 0 where they are and come nearer by a tenth of their distance at least; NaN where they do not come nearer than that
double TimeLeft(const ClosestApproach& approach, double limit_m);

}  // namespace lookout::tracker
