#include "common/bus/memory_bus.hpp"

#include <algorithm>
#include <utility>

namespace lookout::bus {

bool MemoryBus::HandleOnce(std::chrono::milliseconds /*timeout*/) {
  if (messages_.empty()) return false;
  const Message message = std::move(messages_.front());
  messages_.pop_front();
  for (const auto& subscription : subscriptions_) {
    if (subscription.channel.empty() || subscription.channel == message.channel) subscription.handler(message.channel, message.bytes);
  }
  return true;
}

int MemoryBus::QueueDepth(std::string_view channel) const { return static_cast<int>(std::ranges::count(messages_, channel, &Message::channel)); }

bool MemoryBus::Send(const Channel& channel, Bytes bytes) {
  messages_.push_back({channel.name, {bytes.begin(), bytes.end()}});
  return true;
}

bool MemoryBus::SendOwned(const Channel& channel, std::vector<std::uint8_t>&& bytes) {
  messages_.push_back({channel.name, std::move(bytes)});
  return true;
}

void MemoryBus::Attach(const Channel* channel, RawHandler handler) {
  subscriptions_.push_back({channel == nullptr ? std::string_view() : channel->name, std::move(handler)});
}

}  // namespace lookout::bus
