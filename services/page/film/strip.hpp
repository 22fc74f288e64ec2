// The heat strip of the time line.
#pragma once

#include <string>

#include "services/page/core/request.hpp"
#include "services/page/film/timeline.hpp"

namespace lookout::page {

inline constexpr std::size_t kMaxStripEvents = 2000;

/// JSON text of a `strip` (PROTOCOL.md). Buckets shorter than a second show what was in their second; losses stand in the first of them.
std::string StripText(const Timeline& timeline, const StripRequest& request);

}  // namespace lookout::page
