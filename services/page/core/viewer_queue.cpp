#include "services/page/core/viewer_queue.hpp"

#include <algorithm>
#include <utility>

namespace lookout::page {

void ViewerQueue::Put(ViewerMessage message) {
  const auto size = message.bytes->size();
  if (size > kMaxBytes) {
    ++num_dropped_;
    return;
  }
  const auto is_same = [channel = message.channel](const ViewerMessage& one) { return one.channel == channel; };
  std::size_t num_same = 0;
  std::size_t num_same_bytes = 0;
  for (const auto& one : waiting_) {
    if (!is_same(one)) continue;
    ++num_same;
    num_same_bytes += one.bytes->size();
  }
  for (; num_same > 0 && (num_same >= kMaxMessages || num_same_bytes + size > kMaxChannelBytes); --num_same) {
    const auto oldest = std::ranges::find_if(waiting_, is_same);
    num_same_bytes -= oldest->bytes->size();
    Drop(oldest);
  }
  while (num_bytes_ + size > kMaxBytes) Drop(waiting_.begin());
  num_bytes_ += size;
  waiting_.push_back(std::move(message));
}

std::optional<ViewerMessage> ViewerQueue::Take() {
  if (waiting_.empty()) return std::nullopt;
  auto message = std::move(waiting_.front());
  waiting_.pop_front();
  num_bytes_ -= message.bytes->size();
  return message;
}

void ViewerQueue::Forget(std::size_t channel) {
  std::erase_if(waiting_, [&](const ViewerMessage& one) {
    if (one.channel != channel) return false;
    num_bytes_ -= one.bytes->size();
    return true;
  });
}

void ViewerQueue::Drop(const std::deque<ViewerMessage>::iterator& message) {
  num_bytes_ -= message->bytes->size();
  waiting_.erase(message);
  ++num_dropped_;
}

}  // namespace lookout::page
