// An alert in words, for people.
#pragma once

#include <optional>
#include <string>

#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

/// "boat 17: closest approach 3 m in 21 s, 40 deg to starboard", "land in the guard zone: 7.3 m, 12 deg to port"
/// @param kind  of its track; nullopt: it is of none, or that is gone
std::string TextOf(const Alert& alert, std::optional<TrackKind> kind);

}  // namespace lookout::tracker
