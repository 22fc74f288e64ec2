// The values of an autopilot's messages, out of their lines in NAV_RAW.
#pragma once

#include <string_view>

#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

/// Parses ATTITUDE, GLOBAL_POSITION_INT and GPS_RAW_INT in a line of core/mavlink_lines.hpp. Trailing zeros of a payload that were not sent are put
/// back.
///
/// @return kBadChecksum also where the frame's own checksum is wrong, kBadField where the line holds no frame of these messages
ParseResult ParseMavlinkLine(std::string_view line);

}  // namespace lookout::navigator
