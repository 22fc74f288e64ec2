// Whether a log holds messages of two publishers of one channel: two boats, or two processes of one name, on one bus.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/stream_guard.hpp"
#include "common/core/bytes.hpp"
#include "common/core/log_time.hpp"
#include "common/core/utime.hpp"

namespace lookout::log {

struct Interleaving {
  std::string channel;
  std::int64_t event = 0;  // first message of the second publisher, counted over all events, from 0
  Utime time;
  std::int64_t num_messages = 0;  // of the second publisher
};

/// A guard for each channel, on the times of the events.
class Publishers {
 public:
  /// A message of any channel, in the order of the log. Reads no more than the head and a digest.
  ///
  /// @param event  its number
  /// @return nullopt where the numbers of this channel, or of this version of its type, are not watched
  std::optional<bus::StreamGuard::Decision> Add(std::int64_t event, Utime time, std::string_view channel, Bytes bytes) {
    const auto* entry = bus::FindChannel(channel);
    const auto place = entry != nullptr && bus::IsGuarded(*entry) ? bus::PlaceOf(*entry, bytes) : std::nullopt;
    if (!place) return std::nullopt;
    auto found = guards_.find(channel);
    if (found == guards_.end()) found = guards_.emplace(std::string(channel), bus::StreamGuard(*entry)).first;
    return found->second.Next(*place, time.time_since_epoch(), event);
  }

  /// Channels with two publishers, in the order in which the second was first heard.
  std::vector<Interleaving> Interleavings() const {
    std::vector<Interleaving> interleavings;
    for (const auto& [channel, guard] : guards_) {
      const auto& first = guard.first_interleaving();
      if (!first) continue;
      interleavings.push_back({channel, first->mark, Utime(std::chrono::duration_cast<std::chrono::microseconds>(first->time)), guard.num_refused()});
    }
    std::ranges::sort(interleavings, {}, &Interleaving::event);
    return interleavings;
  }

  std::map<std::string, bus::StreamGuard, std::less<>>& guards() { return guards_; }
  const std::map<std::string, bus::StreamGuard, std::less<>>& guards() const { return guards_; }

 private:
  std::map<std::string, bus::StreamGuard, std::less<>> guards_;
};

/// "two publishers of POSE from event 812 on, 2026-11-21T13:45:01.123456Z: 350 messages are of the second"
inline std::string InWords(const Interleaving& interleaving) {
  return fmt::format("two publishers of {} from event {} on, {}: {} messages are of the second", interleaving.channel, interleaving.event,
                     TimeText(interleaving.time), interleaving.num_messages);
}

/// The consequence for a replay of the log.
inline constexpr const char* kOutsideProof = "from there on the log stands outside the proof: what a replay gives need not equal the live run";

}  // namespace lookout::log
