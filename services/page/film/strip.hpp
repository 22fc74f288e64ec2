// The heat strip of the time line.
#pragma once

#include <string>

#include "services/page/core/replies.hpp"
#include "services/page/core/request.hpp"
#include "services/page/film/timeline.hpp"

namespace lookout::page {

inline constexpr std::size_t kMaxStripEvents = 2000;

/// JSON text of a `strip`, or of `refused` (PROTOCOL.md). Buckets shorter than a second show their second; losses stand in its first bucket.
std::string StripText(const Timeline& timeline, const StripRequest& request);

}  // namespace lookout::page
