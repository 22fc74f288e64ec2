// A bus in memory: what waits is handled, and what comes is kept.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/memory_bus.hpp"

namespace lookout::support {

/// Handles all that waits, and what comes of it.
inline void HandleAll(bus::MemoryBus& bus) {
  while (bus.HandleOnce()) continue;
}

/// Publishes a message and handles all that waits.
template <typename Message>
void Send(bus::MemoryBus& bus, const bus::Channel& channel, const Message& message) {
  bus::Publish(bus, channel, message);
  HandleAll(bus);
}

/// The messages of a channel, as they come.
template <typename Message>
class Kept : public std::vector<Message> {
 public:
  Kept(bus::Bus& bus, const bus::Channel& channel) {
    bus::Subscribe<Message>(bus, channel, [this](const Message& message) { this->push_back(message); });
  }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
};

/// A bus that keeps what was published, in its order.
struct KeepingBus {
  bus::MemoryBus bus;
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> sent;  // channel and bytes

  KeepingBus() {
    bus.SubscribeAll([this](std::string_view channel, Bytes bytes) { sent.emplace_back(channel, std::vector(bytes.begin(), bytes.end())); });
  }
  KeepingBus(const KeepingBus&) = delete;
  KeepingBus& operator=(const KeepingBus&) = delete;

  /// The messages of a channel.
  template <typename Message>
  std::vector<Message> All(const bus::Channel& channel) const {
    std::vector<Message> all;
    for (const auto& [name, bytes] : sent) {
      if (name == channel.name) all.push_back(bus::Decode<Message>(bytes).value());
    }
    return all;
  }
};

}  // namespace lookout::support
