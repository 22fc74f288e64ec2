#include "tools/log/publishers.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/log/time_text.hpp"

namespace lookout::log {

std::optional<std::int64_t> Publishers::Add(Utime time, std::string_view channel, Bytes bytes) {
  const auto number = num_events_++;
  const auto* entry = bus::FindChannel(channel);
  if (entry == nullptr || !bus::IsGuarded(*entry)) return std::nullopt;
  const auto place = bus::PlaceOf(*entry, bytes);
  if (!place) return std::nullopt;
  auto found = guards_.find(channel);
  if (found == guards_.end()) found = guards_.emplace(std::string(channel), bus::StreamGuard(*entry)).first;
  return found->second.Next(*place, GuardTime(time), number).num_lost;
}

std::vector<Publishers::Interleaving> Publishers::Interleavings() const {
  std::vector<Interleaving> interleavings;
  for (const auto& [channel, guard] : guards_) {
    const auto& first = guard.first_interleaving();
    if (!first) continue;
    interleavings.push_back({channel, first->mark, Utime(std::chrono::duration_cast<std::chrono::microseconds>(first->time)), guard.num_refused()});
  }
  std::ranges::sort(interleavings, {}, &Interleaving::event);
  return interleavings;
}

std::string InWords(const Publishers::Interleaving& interleaving) {
  return fmt::format("two publishers of {} from event {} on, {}: {} messages are of the second", interleaving.channel, interleaving.event,
                     TimeText(interleaving.time), interleaving.num_messages);
}

}  // namespace lookout::log
