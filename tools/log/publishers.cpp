#include "tools/log/publishers.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/log/time_text.hpp"

namespace lookout::log {

std::optional<bus::StreamGuard::Decision> Publishers::Add(std::int64_t event, Utime time, std::string_view channel, Bytes bytes) {
  const auto* entry = bus::FindChannel(channel);
  const auto place = entry != nullptr && bus::IsGuarded(*entry) ? bus::PlaceOf(*entry, bytes) : std::nullopt;
  if (!place) return std::nullopt;
  auto found = guards_.find(channel);
  if (found == guards_.end()) found = guards_.emplace(std::string(channel), bus::StreamGuard(*entry)).first;
  return found->second.Next(*place, time.time_since_epoch(), event);
}

std::vector<Interleaving> Publishers::Interleavings() const {
  std::vector<Interleaving> interleavings;
  for (const auto& [channel, guard] : guards_) {
    const auto& first = guard.first_interleaving();
    if (!first) continue;
    interleavings.push_back({channel, first->mark, Utime(std::chrono::duration_cast<std::chrono::microseconds>(first->time)), guard.num_refused()});
  }
  std::ranges::sort(interleavings, {}, &Interleaving::event);
  return interleavings;
}

std::string InWords(const Interleaving& interleaving) {
  return fmt::format("two publishers of {} from event {} on, {}: {} messages are of the second", interleaving.channel, interleaving.event,
                     TimeText(interleaving.time), interleaving.num_messages);
}

}  // namespace lookout::log
