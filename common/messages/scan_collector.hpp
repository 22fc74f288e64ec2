// Brings together the messages of one scan from the channels of a log.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <utility>

#include "common/messages/checks.hpp"

namespace lookout::messages {

/// The messages with one utime_us and seq, by part_index.
struct ScanMessages {
  std::int64_t utime_us = 0;
  std::int64_t seq = 0;
  std::map<std::int32_t, lidar_scan_t> scans;
  std::map<std::int32_t, segments_t> segments;
  std::map<std::int32_t, obstacles_t> obstacles;
  std::map<std::int32_t, tracks_t> tracks;
};

template <typename Message>
bool HasAllParts(const std::map<std::int32_t, Message>& parts) {
  return !parts.empty() && std::cmp_equal(parts.size(), parts.begin()->second.num_parts);
}

/// Messages of a channel come in their order; the channels may be ahead of each other by max_waiting scans. A part that came before begins its scan
/// once more, beside the first: a log that was read twice, or one of two publishers. A message belongs to the first of them that lacks it.
class ScanCollector {
 public:
  enum class Order { kOfArrival, kOfCompletion };
  using Predicate = bool (*)(const ScanMessages&);
  using Handler = std::function<void(const ScanMessages&)>;

  /// @param is_complete  whether a scan waits for nothing more
  /// @param order        kOfArrival: scans that came before a complete scan are handed on before it, complete or not
  /// @param on_scan      called once with each scan: when it is complete, or more than `max_waiting` wait and it is the first, or at the end
  ScanCollector(Predicate is_complete, Order order, std::size_t max_waiting, Handler on_scan)
      : is_complete_(is_complete), order_(order), max_waiting_(max_waiting), on_scan_(std::move(on_scan)) {}

  /// @return false where the message is not well-formed: it is left out
  bool Add(lidar_scan_t message) { return Add(std::move(message), &ScanMessages::scans); }
  bool Add(segments_t message) { return Add(std::move(message), &ScanMessages::segments); }
  bool Add(obstacles_t message) { return Add(std::move(message), &ScanMessages::obstacles); }
  bool Add(tracks_t message) { return Add(std::move(message), &ScanMessages::tracks); }

  /// End of the input: waiting scans are handed on.
  void Finish() {
    while (!waiting_.empty()) HandOn(0);
  }

 private:
  template <typename Message>
  bool Add(Message message, std::map<std::int32_t, Message> ScanMessages::*parts);
  void HandOn(std::size_t index);

  Predicate is_complete_;
  Order order_;
  std::size_t max_waiting_;
  Handler on_scan_;
  std::deque<ScanMessages> waiting_;
};

}  // namespace lookout::messages
