// A bus inside one process, for replay and tests: messages are handled in the order in which they were published.
#pragma once

#include <algorithm>
#include <deque>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"

namespace lookout::bus {

class MemoryBus final : public Bus {
 public:
  /// Handles the oldest message that waits: each subscriber of its channel, in the order of subscription. Never waits.
  bool HandleOnce(std::chrono::milliseconds /*timeout*/ = std::chrono::milliseconds(0)) override {
    if (messages_.empty()) return false;
    const Message message = std::move(messages_.front());
    messages_.pop_front();
    for (const auto& subscription : subscriptions_) {
      if (subscription.channel.empty() || subscription.channel == message.channel) subscription.handler(message.channel, message.bytes);
    }
    return true;
  }

  int QueueDepth(std::string_view channel) const override { return static_cast<int>(std::ranges::count(messages_, channel, &Message::channel)); }

 protected:
  bool Send(const Channel& channel, std::vector<std::uint8_t>&& bytes) override {
    messages_.push_back({channel.name, std::move(bytes)});
    return true;
  }
  void Attach(const Channel* channel, RawHandler handler) override {
    subscriptions_.push_back({channel == nullptr ? std::string_view() : channel->name, std::move(handler)});
  }

 private:
  struct Message {
    std::string_view channel;  // of the channel table
    std::vector<std::uint8_t> bytes;
  };
  struct Subscription {
    std::string_view channel;  // empty = all
    RawHandler handler;
  };
  std::deque<Message> messages_;
  std::vector<Subscription> subscriptions_;
};

}  // namespace lookout::bus
