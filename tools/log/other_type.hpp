// Messages of a log that another version of Lookout wrote, with another type on the channel.
#pragma once

#include <cstdint>
#include <string>

#include "common/bus/stream_guard.hpp"

namespace lookout::log {

/// Whether a message is long enough for a fingerprint, and that is not the one of the channel's type.
inline bool IsOfOtherType(const bus::Channel& channel, Bytes bytes) {
  constexpr std::size_t kFingerprintBytes = 8;
  return bytes.size() >= kFingerprintBytes && !bus::IsOfType(channel, bus::ReadU64BigEndian(bytes, 0));
}

/// Whether lookout-replay makes the channel's messages anew out of the raw ones.
constexpr bool IsMadeAnew(const bus::Channel& channel) { return channel.is_replayed && !channel.is_raw; }

/// Messages of another type: their probable origin, and advice.
inline std::string OtherTypeText(const bus::Channel& channel, std::int64_t num_messages) {
  const std::string name(channel.name);
  const std::string what = std::to_string(num_messages) + " messages of " + name + " are of another type than this version's " + name;
  return IsMadeAnew(channel) ? what + ": lookout-replay makes " + name + " anew of the log" : what;
}

}  // namespace lookout::log
