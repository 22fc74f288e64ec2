#include "services/tracker/alert_text.hpp"

#include <fmt/format.h>

#include <algorithm>
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
  if (track_id <= kUnnamed) return "obstacle";
  return fmt::format("{} {}", KindText(kind), track_id);
}

std::string_view ReasonText(Unseen why) {
  switch (why) {
    case Unseen::kHeight:
      return "no beam passes within 1 m above the water";
    case Unseen::kNearerThanMin:
      return "nearer than min_range_m of the segmenter";
    case Unseen::kBeyondMax:
      return "beyond max_range_m of the segmenter";
    case Unseen::kFieldOfView:
      return "outside of the segmenter's field of view";
    case Unseen::kOwnBox:
      return "inside own_vessel, far from the hull";
    case Unseen::kNoBeams:
      return "the lidar does not fire there";
    default:
      return "the own boat or something at the lidar hides it";
  }
}

std::string PartText(const UnseenPart& part) {
  constexpr std::int64_t kCircleDeg = 360;
  const auto whole_deg = [](double bearing_rad) { return std::lround(RadToDeg(bearing_rad)) % kCircleDeg; };
  std::string text = "all round";
  if (part.bearing.width_rad < kTwoPi - 1e-9) {
    text = fmt::format("{} to {} deg", whole_deg(part.bearing.start_rad), whole_deg(part.bearing.start_rad + part.bearing.width_rad));
  }
  if (!part.begins_with_zone && !part.ends_with_zone) {
    text += fmt::format(", {:.1f} to {:.1f} m", part.from_m, part.to_m);
  } else if (!part.begins_with_zone) {
    text += fmt::format(", from {:.1f} m on", part.from_m);
  } else if (!part.ends_with_zone) {
    text += fmt::format(", up to {:.1f} m", part.to_m);
  }
  return text + fmt::format(" ({})", ReasonText(part.why));
}

}  // namespace

std::string TextOf(std::span<const UnseenPart> parts, bool is_whole) {
  constexpr std::size_t kMostParts = 3;
  std::string text = is_whole ? "no look-out in the whole guard zone: " : "no look-out in part of the guard zone: ";
  for (std::size_t i = 0; i < std::min(parts.size(), kMostParts); ++i) text += (i > 0 ? "; " : "") + PartText(parts[i]);
  if (parts.size() > kMostParts) text += fmt::format("; and {} more", parts.size() - kMostParts);
  return text;
}

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
