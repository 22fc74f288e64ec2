#include "services/tracker/core/urgency.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::tracker {

namespace {

// The turn after which a boat is clear of a thing ahead that its course led to.
constexpr double kAsideRad = DegToRad(60.0);
// Beside a quay or a pile the distance wavers by so much and no more.
constexpr double kNearerShare = 0.1;
constexpr double kNearerM = 0.3;

}  // namespace

double TimeToAct(double speed_mps, const OwnAbility& ability) {
  const double stop_s = speed_mps / ability.deceleration_mps2;
  const double turn_s = kAsideRad / ability.turn_rate_radps;
  return ability.reaction_s + std::max(ability.least_braking_s, std::min(stop_s, turn_s));
}

double TimeLeft(const ClosestApproach& approach, double limit_m) {
  if (!(approach.tcpa_s > 0.0)) return kNan;
  const double now_m = approach.distance_m;
  const double cpa_m = approach.cpa_m;
  if (now_m <= limit_m) return now_m - cpa_m > std::max(kNearerM, kNearerShare * now_m) ? 0.0 : kNan;
  if (cpa_m >= limit_m) return kNan;
  return approach.tcpa_s * (1.0 - std::sqrt((limit_m * limit_m - cpa_m * cpa_m) / (now_m * now_m - cpa_m * cpa_m)));
}

}  // namespace lookout::tracker
