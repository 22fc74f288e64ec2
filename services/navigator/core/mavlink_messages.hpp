// The values of an autopilot's messages, out of their lines in NAV_RAW.
#pragma once

#include <string_view>

#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

/// Of ATTITUDE, GLOBAL_POSITION_INT and GPS_RAW_INT, in a line of core/mavlink_lines.hpp. A payload whose trailing zeros were not sent has them
/// again.
///
/// @return kBadChecksum also where that of the frame is wrong, kBadField where the line holds no frame of these messages
ParseResult ParseMavlinkLine(std::string_view line);

}  // namespace lookout::navigator
