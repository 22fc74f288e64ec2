#include "services/tracker/alert_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "common/core/angles.hpp"

namespace lookout::tracker {

namespace {

// ", 40 deg to starboard"; nothing where it is not known.
std::string BearingText(double bearing_rad) {
  if (std::isnan(bearing_rad)) return {};
  const double degrees = RadToDeg(WrapToPi(bearing_rad));
  return fmt::format(", {:.0f} deg to {}", std::abs(degrees), degrees < 0.0 ? "port" : "starboard");
}

std::string_view KindText(std::optional<TrackKind> kind) {
  switch (kind.value_or(TrackKind::kUnknown)) {
    case TrackKind::kBuoy:
      return "buoy";
    case TrackKind::kBoat:
      return "boat";
    case TrackKind::kStructure:
      return "structure";
    default:
      return "obstacle";
  }
}

std::string WhoText(std::int64_t track_id, std::optional<TrackKind> kind) {
  if (track_id == kLandTrack) return "land";
  if (track_id == kUnnamed) return "obstacle";
  return fmt::format("{} {}", KindText(kind), track_id);
}

}  // namespace

std::string TextOf(const Alert& alert, std::optional<TrackKind> kind) {
  const auto who = WhoText(alert.track_id, kind);
  switch (alert.cause) {
    case AlertCause::kGuardZone:
      return fmt::format("{} in the guard zone: {:.1f} m{}", who, alert.distance_m, BearingText(alert.bearing_rad));
    case AlertCause::kClosestApproach:
      return fmt::format("{}: closest approach {:.0f} m in {:.0f} s{}", who, alert.cpa_m, alert.tcpa_s, BearingText(alert.bearing_rad));
    case AlertCause::kWatch:
      break;
  }
  return "no look-out";
}

}  // namespace lookout::tracker
