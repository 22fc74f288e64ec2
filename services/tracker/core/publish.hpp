// From followed tracks to the published picture.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "services/tracker/core/followed.hpp"
#include "services/tracker/core/picture.hpp"
#include "services/tracker/core/scan.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

inline constexpr double kOwnVelocitySdMps = 0.15;  // where POSE is placed

/// The own boat, as closest approach sees it.
Moving SelfOf(const Pose& own, double turn_rate_radps, const TrackerParams& params);

/// @return by id: confirmed tracks, with those that ended in this scan (lost), and tentative tracks that have a body
/// Notes overtaking in `tracks`, and forgets parents and children after 10 s.
/// @param self  the own boat; nullopt: its pose is not known
std::vector<Track> Published(const ScanInput& scan, const TrackerParams& params, const std::optional<Moving>& self, std::deque<Followed>& tracks);

}  // namespace lookout::tracker
