// An alert in words, for people.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/tracker.hpp"
#include "services/tracker/core/zone_sight.hpp"

namespace lookout::tracker {

/// "boat 17: closest approach 3 m in 21 s, 40 deg to starboard", "land in the guard zone: 7.3 m, 12 deg to port"
/// @param kind  of its track; nullopt: it is of none, or that is gone
std::string TextOf(const Alert& alert, std::optional<TrackKind> kind);

/// "no look-out in part of the guard zone: 270 to 90 deg (the lidar does not fire there)", "no look-out in the whole guard zone: all round (...)".
/// Three parts are named, and how many more there are.
/// @param parts  one at least
std::string TextOf(std::span<const UnseenPart> parts, bool is_whole);

}  // namespace lookout::tracker
