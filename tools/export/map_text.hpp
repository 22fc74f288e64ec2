// Text and times as the formats of maps write them.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/core/log_time.hpp"
#include "common/core/printable.hpp"
#include "common/core/utime.hpp"

namespace lookout::exporter {

/// For text and for attributes in double quotes; printable ASCII, since XML 1.0 forbids some characters of Unicode.
inline std::string XmlText(std::string_view text) {
  std::string escaped;
  for (const char letter : Printable(text)) {
    switch (letter) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += letter;
    }
  }
  return escaped;
}

/// "2026-07-01T10:00:00.000000Z"
inline std::string IsoTime(std::int64_t utime_us) { return TimeText(Utime(std::chrono::microseconds(utime_us))); }

}  // namespace lookout::exporter
