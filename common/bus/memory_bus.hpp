// A bus inside one process, for replay and tests: messages are handled in the order in which they were published.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace lookout::bus {

class MemoryBus final : public Bus {
 public:
  /// Handles the oldest message that waits: each subscriber of its channel, in the order of subscription. Never waits.
  bool HandleOnce(std::chrono::milliseconds timeout = std::chrono::milliseconds(0)) override;

  int QueueDepth(std::string_view channel) const override;

 protected:
  bool Send(const Channel& channel, Bytes bytes) override;
  bool SendOwned(const Channel& channel, std::vector<std::uint8_t>&& bytes) override;
  void Attach(const Channel* channel, RawHandler handler) override;

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
