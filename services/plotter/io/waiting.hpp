// Since when the oldest message waits that a receiver has not confirmed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "services/plotter/io/port.hpp"

namespace lookout::plotter {

class Waiting {
 public:
  void Add(std::size_t num_bytes, SteadyTime now) {
    messages_.push_back({num_bytes, now});
    num_bytes_ += num_bytes;
  }

  /// @param num_waiting_bytes  at the end of all that was added, that are still on the way: here, in the kernel, on the network
  /// @return how many messages were confirmed by that
  std::int64_t Confirm(std::size_t num_waiting_bytes) {
    std::int64_t num_confirmed = 0;
    while (!messages_.empty() && num_waiting_bytes <= num_bytes_ - messages_.front().num_bytes) {
      num_bytes_ -= messages_.front().num_bytes;
      messages_.pop_front();
      ++num_confirmed;
    }
    return num_confirmed;
  }

  /// @return how many messages were waiting
  std::int64_t Clear() {
    const auto num_messages = static_cast<std::int64_t>(messages_.size());
    messages_.clear();
    num_bytes_ = 0;
    return num_messages;
  }

  bool is_empty() const { return messages_.empty(); }
  bool IsLate(SteadyTime now) const { return !messages_.empty() && now - messages_.front().time > kMaxWait; }

 private:
  struct Message {
    std::size_t num_bytes;
    SteadyTime time;
  };
  std::deque<Message> messages_;
  std::size_t num_bytes_ = 0;
};

}  // namespace lookout::plotter
