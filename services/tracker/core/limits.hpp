// How near is too near: limits of the config, limits that a skipper has set, and in harbour limits by the own speed.
#pragma once

#include "common/core/guard_sector.hpp"
#include "services/tracker/core/order.hpp"
#include "services/tracker/core/urgency.hpp"

namespace lookout::tracker {

/// Limits of the config. Those that a skipper sets are kept within least_ and most_.
struct LimitParams {
  Mode mode = Mode::kOpenWater;
  GuardZoneParams guard_zone = {};
  double cpa_limit_m = 0.0;
  double least_guard_zone_m = 0.1;
  double most_guard_zone_m = 1000.0;
  double least_cpa_limit_m = 0.1;
  double most_cpa_limit_m = 500.0;
  // From the reference point to the farthest corner of own_vessel: a zone within it sees nothing.
  double own_reach_m = 0.0;
  // In harbour the zone reaches so far beyond own_vessel and the way that the boat goes before it stops.
  double harbour_margin_m = 2.0;
  double harbour_cpa_limit_m = 1.0;  // the least
};

struct Limits {
  Mode mode = Mode::kOpenWater;
  GuardZoneParams guard_zone = {};
  double cpa_limit_m = 0.0;
};

/// In harbour both limits shrink with the own speed, and never grow beyond the set ones: the zone to own_vessel, the way that the boat goes before it
/// stops, and a margin; the closest approach to half of that way. Where the speed is not known neither shrinks.
/// @param settings  NaN: as the config says; the mode of the settings counts. A sector of 0 to 360 deg, or of none, is all round
/// @param own_mps   NaN: not known
Limits LimitsOf(const LimitParams& params, const Settings& settings, double own_mps, const OwnAbility& ability);

}  // namespace lookout::tracker
