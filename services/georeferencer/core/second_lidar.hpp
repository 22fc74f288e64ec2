// The segments of a second lidar, which go out with the scan of the first during which they were seen.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/core/utime.hpp"
#include "services/georeferencer/core/obstacle.hpp"

namespace lookout::georeferencer {

/// What it gives depends on measurement times alone, as long as SEGMENTS_2 come within kMaxWait of POSE.
class SecondLidar {
 public:
  /// A scan of the first waits for the second until POSE is so far ahead of it.
  static constexpr std::chrono::milliseconds kMaxWait{500};
  /// The second counts from so long after its first scan on, by which this has come for sure, until so long after its last.
  static constexpr std::chrono::seconds kSettled{1};
  static constexpr std::chrono::seconds kSilence{2};
  /// With one scan of the first: as many messages as they may need are bounded.
  static constexpr std::size_t kMaxSegments = 180;

  /// The next SEGMENTS_2. Parts of one scan have one end, and come in their order.
  void Add(const SegmentPart& part);

  /// Whether a scan of the first must wait for more.
  ///
  /// @param newest_pose  time of the newest POSE
  bool Holds(Utime end_time, Utime newest_pose) const;

  /// @return the segments that were seen since the scan of the first before, at most 0.3 s ahead of this one's beginning, until its end; all earlier
  ///         ones are forgotten. Those that were seen while the first was dark lie before `time`
  std::vector<Segment> Take(Utime time, Utime end_time);

  std::int64_t num_dropped() const { return num_dropped_; }  // seen during no scan of the first, or too many
  /// Of them, those that came when the scan to which they belong had gone out, or so far ahead of the first that they were forgotten: the times of
  /// the two lidars do not fit. The first second of the second does not count.
  std::int64_t num_untimely() const { return num_untimely_; }
  std::int64_t num_taken() const { return num_taken_; }

 private:
  bool IsGoingOn(Utime end_time) const;

  std::deque<Segment> segments_;     // by arrival
  std::deque<Utime> ends_;           // of scans, rising
  std::optional<Utime> began_;       // end of the first scan since it was silent
  std::optional<Utime> last_taken_;  // end of the last scan of the first
  std::int64_t num_dropped_ = 0;
  std::int64_t num_untimely_ = 0;
  std::int64_t num_taken_ = 0;
};

}  // namespace lookout::georeferencer
