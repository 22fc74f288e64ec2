#include "common/messages/scan_collector.hpp"

#include <algorithm>

namespace lookout::messages {

template <typename Message>
bool ScanCollector::Add(Message message, std::map<std::int32_t, Message> ScanMessages::*parts) {
  if (!IsWellFormed(message)) return false;
  auto index = IndexOf(message.utime_us, message.seq);
  if (index < waiting_.size() && (waiting_[index].*parts).contains(message.part_index)) {
    HandOn(index);
    index = waiting_.size();
  }
  if (index == waiting_.size()) waiting_.push_back({message.utime_us, message.seq, {}, {}, {}});
  auto& scan = waiting_[index];
  const auto part_index = message.part_index;
  (scan.*parts).emplace(part_index, std::move(message));
  if (is_complete_(scan)) {
    HandOn(index);
  } else if (waiting_.size() > max_waiting_) {
    HandOn(0);
  }
  return true;
}

template bool ScanCollector::Add(lidar_scan_t, std::map<std::int32_t, lidar_scan_t> ScanMessages::*);
template bool ScanCollector::Add(segments_t, std::map<std::int32_t, segments_t> ScanMessages::*);
template bool ScanCollector::Add(obstacles_t, std::map<std::int32_t, obstacles_t> ScanMessages::*);

// Messages of a scan come close together: looked for from the newest on.
std::size_t ScanCollector::IndexOf(std::int64_t utime_us, std::int64_t seq) const {
  for (auto index = waiting_.size(); index > 0; --index) {
    if (waiting_[index - 1].utime_us == utime_us && waiting_[index - 1].seq == seq) return index - 1;
  }
  return waiting_.size();
}

void ScanCollector::HandOn(std::size_t index) {
  const auto last = waiting_.begin() + static_cast<std::ptrdiff_t>(index);
  const auto first = order_ == Order::kOfArrival ? waiting_.begin() : last;
  std::for_each(first, last + 1, on_scan_);
  waiting_.erase(first, last + 1);
}

}  // namespace lookout::messages
