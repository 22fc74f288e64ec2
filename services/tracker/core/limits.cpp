#include "services/tracker/core/limits.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::tracker {

Limits LimitsOf(const LimitParams& params, const Settings& settings, double own_mps, const OwnAbility& ability) {
  constexpr double kWholeRad = 1e-6;  // less than a float tells
  Limits limits{settings.mode, params.guard_zone, params.cpa_limit_m};
  auto& zone = limits.guard_zone;
  if (!std::isnan(settings.guard_zone_range_m)) {
    zone.range_m = settings.guard_zone_range_m > 0.0
                       ? std::max(std::clamp(settings.guard_zone_range_m, params.least_guard_zone_m, params.most_guard_zone_m), params.own_reach_m)
                       : 0.0;
  }
  if (!std::isnan(settings.guard_zone_from_rad) && !std::isnan(settings.guard_zone_to_rad)) {
    const double turn_rad = settings.guard_zone_to_rad - settings.guard_zone_from_rad;
    const double width_rad = WrapTo2Pi(turn_rad);
    const bool is_whole = std::fabs(turn_rad) > kTwoPi - kWholeRad || width_rad < kWholeRad;
    zone.bearing = {WrapTo2Pi(settings.guard_zone_from_rad), is_whole ? kTwoPi : width_rad};
  }
  if (!std::isnan(settings.cpa_limit_m)) limits.cpa_limit_m = std::clamp(settings.cpa_limit_m, params.least_cpa_limit_m, params.most_cpa_limit_m);
  if (limits.mode == Mode::kHarbour && std::isfinite(own_mps)) {
    const double way_m = own_mps * TimeToAct(own_mps, ability);
    zone.range_m = std::min(zone.range_m, params.own_reach_m + way_m + params.harbour_margin_m);
    limits.cpa_limit_m = std::min(limits.cpa_limit_m, std::max(params.harbour_cpa_limit_m, 0.5 * way_m));
  }
  return limits;
}

}  // namespace lookout::tracker
