// Times as people write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/core/utime.hpp"

namespace lookout::log {

/// "2026-11-21T13:45:01.123456Z"
std::string TimeText(Utime time);

/// "83.123456 s"
std::string SecondsText(std::chrono::microseconds duration);

/// @param text   seconds from the start ("12.5"), or UTC ("2026-11-21T13:45:01Z", with up to six decimals)
/// @param start  of the log
/// @return nullopt when it is neither, or out of the bounds of Utime
std::optional<Utime> ParseTime(std::string_view text, Utime start);

}  // namespace lookout::log
