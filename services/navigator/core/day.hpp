// A day as config and command lines write it.
#pragma once

#include <chrono>
#include <optional>
#include <string_view>

namespace lookout::navigator {

/// @return the day of "2026-07-01"; nullopt when it is written in another way, or is no day from 1970 to 2199
std::optional<std::chrono::sys_days> ParseDay(std::string_view text);

}  // namespace lookout::navigator
