// Messages that wait to be sent to one viewer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "common/core/utime.hpp"

namespace lookout::page {

/// Bytes that several viewers are sent: made once.
using SharedText = std::shared_ptr<const std::string>;

struct ViewerMessage {
  std::size_t channel = 0;  // index
  Utime time;               // of reception
  SharedText bytes;         // not null
};

/// In the order in which they came. Where a channel has as many as it may, or all together are too large, the oldest of the channel, or of all, goes:
/// a viewer that is too slow sees the newest.
class ViewerQueue {
 public:
  static constexpr std::size_t kMaxMessages = 64;                                // of a channel
  static constexpr std::size_t kMaxChannelBytes = std::size_t{2} * 1024 * 1024;  // of a channel; a single larger message, as some clouds are, is kept
  static constexpr std::size_t kMaxBytes = std::size_t{16} * 1024 * 1024;

  void Put(ViewerMessage message);

  /// @return the next to send; nullopt where nothing waits
  std::optional<ViewerMessage> Take();

  /// Forgets what waits of a channel.
  void Forget(std::size_t channel);

  std::size_t num_bytes() const { return num_bytes_; }
  std::int64_t num_dropped() const { return num_dropped_; }

 private:
  void Drop(const std::deque<ViewerMessage>::iterator& message);

  std::deque<ViewerMessage> waiting_;
  std::size_t num_bytes_ = 0;
  std::int64_t num_dropped_ = 0;
};

}  // namespace lookout::page
