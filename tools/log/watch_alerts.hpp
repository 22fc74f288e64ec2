// ALERTS that the tracker sent because no scan came.
#pragma once

#include <string_view>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/alerts_t.hpp"

namespace lookout::log {

/// Whether a message is one of these. They come by the host's clock: no replay computes them again.
inline bool IsWatchAlert(std::string_view channel, Bytes bytes) {
  if (channel != bus::kAlerts.name) return false;
  const auto message = bus::Decode<alerts_t>(bytes);
  return message && message->is_watch;
}

}  // namespace lookout::log
