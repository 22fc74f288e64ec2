// Whether a log holds messages of two publishers of one channel: two boats, or two processes of one name, on one bus.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/stream_guard.hpp"
#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::log {

/// Time of an event for a guard.
inline bus::StreamGuard::Time GuardTime(Utime time) { return time.time_since_epoch(); }

class Publishers {
 public:
  /// A message of any channel, in the order of the log. Reads no more than the head and a digest.
  ///
  /// @return how many messages are missing before it, or among those that it shows to be a new start; nullopt where the numbers of this channel, or
  /// of
  ///         this version of its type, are not watched
  std::optional<std::int64_t> Add(Utime time, std::string_view channel, Bytes bytes);

  struct Interleaving {
    std::string channel;
    std::int64_t event = 0;  // its first message of the second publisher, counted over all events that were added, from 0
    Utime time;
    std::int64_t num_messages = 0;  // of the second publisher
  };
  /// Channels with two publishers, in the order in which the second was first heard.
  std::vector<Interleaving> Interleavings() const;

 private:
  std::map<std::string, bus::StreamGuard, std::less<>> guards_;
  std::int64_t num_events_ = 0;
};

/// "two publishers of POSE from event 812 on, 2026-11-21T13:45:01.123456Z: 350 messages are of the second"
std::string InWords(const Publishers::Interleaving& interleaving);

/// What that means for who computes the log again.
inline constexpr const char* kOutsideProof = "from there on the log stands outside the proof: what a replay gives need not equal the live run";

}  // namespace lookout::log
