// Brings together TRACKS of a scan, the pose at its end, and all that AIS said before its end.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "common/core/health.hpp"
#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/ais/core/watcher.hpp"

namespace lookout::ais {

/// A scan goes on, in the order of TRACKS, once NAV_RAW and POSE have reached its end: then every sentence that arrived before it is known. The
/// tracker itself waited for that POSE, so the wait is as long as the two channels differ in their way over the bus. What goes on depends on the
/// order within each channel, not on how they interleave, as long as host time is kept out (AdvanceTo is not called), time does not go back, and the
/// channels are ahead of each other by less than kMostWaiting scans, kMostItems sentences and PoseHistory::kLength.
class Gatherer {
 public:
  static constexpr std::size_t kMostWaiting = 64;    // 6 s at 10 scans a second
  static constexpr std::size_t kMostItems = 20'000;  // some minutes of the busiest port

  /// Something that the watcher is to take, in this order.
  struct Step {
    std::optional<Item> item = {};  // else a scan
    std::optional<TracksOfScan> scan = {};
    std::optional<Pose> own = {};  // of the scan
  };
  using Steps = std::vector<Step>;

  /// @param timeout  live only: how long a scan waits, by the host's clock
  explicit Gatherer(std::chrono::microseconds timeout) : timeout_(timeout) {}

  /// NAV_RAW has come to a time, with a sentence that may be of AIS, a start mark, or something else.
  Steps AddTime(Utime time);
  Steps Add(Item item);
  Steps Add(const Pose& pose);
  Steps Add(TracksOfScan scan);

  /// Live only.
  Steps AdvanceTo(Utime host_time);

  /// End of input.
  Steps Finish();

  std::int64_t num_waiting() const { return static_cast<std::int64_t>(waiting_.size()); }
  std::optional<Utime> last_timeout() const { return last_timeout_; }
  std::vector<Counter> counters() const;

 private:
  struct Waiting {
    TracksOfScan scan;
    std::optional<Utime> arrival;  // host time, where there is one
  };

  bool IsReady(const TracksOfScan& scan) const;
  void ReleaseReady(Steps& steps);
  void ReleaseFront(Steps& steps);
  void Flush(Steps& steps);

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"scans_released", "scans_timed_out", "scans_overflowed", "scans_flushed", "scans_waiting", "scans_doubled",
                                       "scans_without_pose", "sentences_early", "poses_taken", "poses_duplicate", "pose_restarts"});

  std::chrono::microseconds timeout_;
  std::deque<Item> items_;  // that no scan has come for
  std::optional<Utime> nav_time_;
  PoseHistory poses_;
  std::deque<Waiting> waiting_;
  std::optional<Utime> newest_;  // end of the last scan
  std::optional<Utime> host_time_;
  std::optional<Utime> last_timeout_;
  Counts<kCountNames> counts_;
};

}  // namespace lookout::ais
