// An alert in words, for people.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "common/core/cover_watch.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/tracker.hpp"
#include "services/tracker/core/zone_sight.hpp"

namespace lookout::tracker {

/// Where no return came for CoverWatch::kNothingS.
inline constexpr std::string_view kSeesNothingText =
    "perhaps no look-out: the lidar has seen nothing at all for 30 s (lasers off, window covered, or flat water and nothing near)";

/// Short: "boat 17", "land", "obstacle"; nothing where nobody looks.
std::string NameOf(const Alert& alert);

/// "boat 17: closest approach 3 m in 21 s, 40 deg to starboard", "boat 17 in the guard zone: 6.2 m, 20 deg to starboard; passes at 1 m in 4 s",
/// "boat 17 is not seen any more: last 6.2 m from here, 20 deg to port", "boat 17 has passed"
std::string TextOf(const Alert& alert);

/// Of more than three that hold: "5 things within 20 m, the nearest boat 7, 4 m, 12 deg to port"; else nothing.
std::string SummaryOf(std::span<const Alert> alerts);

/// "no look-out in part of the guard zone: 270 to 90 deg (the lidar does not fire there)", "no look-out in the whole guard zone: all round (...)".
/// Three parts are named, and how many more there are.
/// @param parts  one at least
std::string TextOf(std::span<const UnseenPart> parts, bool is_whole);

/// "no look-out: 150 to 210 deg (something nearer than 1 m covers the lidar)"
/// @param parts  one at least
std::string TextOf(std::span<const CoveredPart> parts);

}  // namespace lookout::tracker
