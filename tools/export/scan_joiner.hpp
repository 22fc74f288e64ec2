// Brings each part of a turn together with the labels that SEGMENTS holds for it. SEGMENTS stand behind their scan in a log.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "lookout/lidar_scan_t.hpp"
#include "lookout/segments_t.hpp"

namespace lookout::exporter {

/// A part of a turn.
struct LabelledScan {
  lidar_scan_t scan;
  std::optional<segments_t> segments;  // of the same part; nullopt when the log holds none
};

/// Whether the counts of a scan agree with its arrays and its time is one.
bool IsConsistent(const lidar_scan_t& scan);
bool IsConsistent(const segments_t& segments);

class ScanJoiner {
 public:
  using Handler = std::function<void(const LabelledScan&)>;

  /// @param handler  gets every part that came in, in the order in which they came, once
  explicit ScanJoiner(Handler handler) : handler_(std::move(handler)) {}

  /// Takes a consistent part. It waits for its labels; behind kMaxWaiting others it goes without.
  void Add(lidar_scan_t scan);

  /// Takes the consistent labels of one part. Parts before it got none: segmenter goes in order.
  void Add(segments_t segments);

  /// End of the input: what waits goes without labels.
  void Flush() { Release(waiting_.size()); }

  /// Messages of labels without their scan.
  std::int64_t num_orphans() const { return num_orphans_; }

  // A few seconds of turns in parts, some megabytes: more than segmenter is ever behind.
  static constexpr std::size_t kMaxWaiting = 64;

 private:
  void Release(std::size_t count);

  Handler handler_;
  std::deque<LabelledScan> waiting_;
  std::int64_t num_orphans_ = 0;
};

}  // namespace lookout::exporter
