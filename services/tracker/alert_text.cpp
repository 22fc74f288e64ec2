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

std::string_view KindText(TrackKind kind) {
  switch (kind) {
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

// That an alert is over, and why.
std::string EndText(const Alert& alert) {
  const auto who = NameOf(alert);
  switch (alert.end) {
    case AlertEnd::kPassed:
      return who + " has passed";
    case AlertEnd::kGone:
      return who + " is gone: nothing is there any more";
    case AlertEnd::kHidden:
      return who + " was not seen again: it may be hidden";
    case AlertEnd::kMerged:
      return who + " is part of what is told already";
    default:
      return who + " is clear";
  }
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

std::string BearingsText(const Sector& bearing) {
  constexpr std::int64_t kCircleDeg = 360;
  const auto whole_deg = [](double bearing_rad) { return std::lround(RadToDeg(bearing_rad)) % kCircleDeg; };
  if (bearing.width_rad >= kTwoPi - 1e-9) return "all round";
  return fmt::format("{} to {} deg", whole_deg(bearing.start_rad), whole_deg(bearing.start_rad + bearing.width_rad));
}

std::string_view ReasonText(Cover why) {
  switch (why) {
    case Cover::kNear:
      return "something nearer than 1 m covers the lidar";
    case Cover::kOwnGone:
      return "the lidar saw the own boat there, and sees nothing any more: window covered, or a part of the boat gone";
    default:
      return "the lidar sees nothing any more: lasers off, or window covered";
  }
}

// Three are named.
template <typename Part>
std::string PartsText(std::span<const Part> parts, std::string (*text_of)(const Part&)) {
  constexpr std::size_t kMostParts = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(parts.size(), kMostParts); ++i) text += (i > 0 ? "; " : "") + text_of(parts[i]);
  if (parts.size() > kMostParts) text += fmt::format("; and {} more", parts.size() - kMostParts);
  return text;
}

std::string PartText(const CoveredPart& part) { return fmt::format("{} ({})", BearingsText(part.bearing), ReasonText(part.why)); }

std::string PartText(const UnseenPart& part) {
  std::string text = BearingsText(part.bearing);
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
  return (is_whole ? "no look-out in the whole guard zone: " : "no look-out in part of the guard zone: ") + PartsText<UnseenPart>(parts, PartText);
}

std::string TextOf(std::span<const CoveredPart> parts) { return "no look-out: " + PartsText<CoveredPart>(parts, PartText); }

std::string NameOf(const Alert& alert) {
  if (alert.cause == AlertCause::kWatch) return {};
  if (!alert.name.empty()) return alert.name;
  if (alert.thing == kLandTrack) return "land";
  if (alert.thing <= kUnnamed) return "obstacle";
  return fmt::format("{} {}", KindText(alert.kind), alert.thing);
}

std::string TextOf(const Alert& alert) {
  if (alert.thing == kUnseenBySecond) return alert.Holds() ? "no look-out by the second lidar" : "look-out by the second lidar again";
  if (alert.thing == kSeesNothing) return alert.Holds() ? std::string(kSeesNothingText) : "the lidar sees something again";
  if (alert.cause == AlertCause::kWatch) return "no look-out";
  if (!alert.Holds()) return EndText(alert);
  const auto who = NameOf(alert);
  const auto where = BearingText(alert.bearing_rad);
  if (alert.sight == AlertSight::kLost) return fmt::format("{} is not seen any more: last {:.1f} m from here{}", who, alert.distance_m, where);
  std::string text;
  if ((alert.is_in_zone && !alert.tells_way) || !alert.comes_near) {
    text = fmt::format("{} in the guard zone: {:.1f} m{}", who, alert.distance_m, where);
    if (alert.comes_near && alert.tcpa_s > 0.0) text += fmt::format("; passes at {:.0f} m in {:.0f} s", alert.cpa_m, alert.tcpa_s);
  } else if (alert.tcpa_s > 0.0) {
    text = fmt::format("{}: closest approach {:.0f} m in {:.0f} s{}", who, alert.cpa_m, alert.tcpa_s, where);
  } else {
    text = fmt::format("{} is near: {:.1f} m{}", who, alert.distance_m, where);
  }
  if (alert.sight == AlertSight::kJustSeen) text += " (just seen)";
  return text;
}

std::string SummaryOf(std::span<const Alert> alerts) {
  constexpr int kFew = 3;
  int count = 0;
  double farthest_m = 0.0;
  const Alert* nearest = nullptr;
  for (const auto& alert : alerts) {
    if (!alert.Holds() || alert.cause == AlertCause::kWatch) continue;
    ++count;
    if (std::isnan(alert.distance_m)) continue;
    farthest_m = std::max(farthest_m, alert.distance_m);
    if (nearest == nullptr || alert.distance_m < nearest->distance_m) nearest = &alert;
  }
  if (count <= kFew || nearest == nullptr) return {};
  return fmt::format("{} things within {:.0f} m, the nearest {}, {:.0f} m{}", count, std::ceil(farthest_m), NameOf(*nearest), nearest->distance_m,
                     BearingText(nearest->bearing_rad));
}

}  // namespace lookout::tracker
