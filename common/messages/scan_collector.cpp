#include "common/messages/scan_collector.hpp"

#include <algorithm>

namespace lookout::messages {

template <typename Message>
bool ScanCollector::Add(Message message, std::map<std::int32_t, Message> ScanMessages::*parts) {
  if (!IsWellFormed(message)) return false;
  const auto lacking = std::ranges::find_if(waiting_, [&](const ScanMessages& scan) {
    return scan.utime_us == message.utime_us && scan.seq == message.seq && !(scan.*parts).contains(message.part_index);
  });
  const auto index = static_cast<std::size_t>(lacking - waiting_.begin());
  if (lacking == waiting_.end()) waiting_.push_back({message.utime_us, message.seq, {}, {}, {}, {}});
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
template bool ScanCollector::Add(tracks_t, std::map<std::int32_t, tracks_t> ScanMessages::*);

void ScanCollector::HandOn(std::size_t index) {
  const auto last = waiting_.begin() + static_cast<std::ptrdiff_t>(index);
  const auto first = order_ == Order::kOfArrival ? waiting_.begin() : last;
  std::for_each(first, last + 1, on_scan_);
  waiting_.erase(first, last + 1);
}

}  // namespace lookout::messages
