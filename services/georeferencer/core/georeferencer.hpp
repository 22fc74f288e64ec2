// Brings segments and poses together: a scan is placed once POSE has reached its last return.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "common/core/health.hpp"
#include "common/core/pose.hpp"
#include "services/georeferencer/core/obstacle.hpp"
#include "services/georeferencer/core/placement.hpp"
#include "services/georeferencer/core/second_lidar.hpp"

namespace lookout::georeferencer {

/// The output depends on the order of the segments and on the order of the poses, not on how the two interleave, as long as host time is kept out
/// (AdvanceTo is not called), POSE does not go back in time (navigator starts again in the past), and runs ahead by less than
/// PoseHistory::kLength, or segments by less than kMaxWaiting.
class Georeferencer {
 public:
  /// Messages that may wait for POSE: at 10 scans a second 100 s of them.
  static constexpr std::size_t kMaxWaiting = 1000;

  /// Obstacles of the second lidar have numbers above this, in the order in which they go out: no segment of the first has.
  static constexpr std::int32_t kSecondLidarId = 32768;

  /// @param T_vessel_lidar_2  nullopt: there is one lidar
  Georeferencer(const PlacementParams& placement, std::chrono::microseconds pose_timeout,
                const std::optional<Eigen::Isometry3d>& T_vessel_lidar_2 = std::nullopt);

  /// Each of these returns the segments that can be released now, in the order in which they came.
  std::vector<ObstaclePart> AddSegments(SegmentPart part);
  std::vector<ObstaclePart> AddPose(const Pose& pose);
  /// Segments of the second lidar go out as further parts of the scan of the first lidar during which they were seen.
  std::vector<ObstaclePart> AddSecond(const SegmentPart& part);

  /// Live only. Segments that have waited for longer than the time-out by the host's clock are released, and all of them while POSE has not come for
  /// twice that long; a part, or a pose, has arrived at the host time of the call before it came.
  std::vector<ObstaclePart> AdvanceTo(Utime host_time);

  /// End of input: waiting segments are released, with the poses that are there.
  std::vector<ObstaclePart> Finish();

  std::int64_t num_waiting() const { return static_cast<std::int64_t>(waiting_.size()); }
  const PoseHistory& poses() const { return poses_; }
  std::vector<Counter> counters() const;
  /// Segments of the second lidar that were dropped because the times of the two lidars do not fit.
  std::int64_t num_untimely() const { return second_.num_untimely(); }
  /// Host time of the last release by time-out.
  std::optional<Utime> last_timeout() const { return last_timeout_; }

 private:
  struct Waiting {
    SegmentPart part;
    std::optional<Utime> arrival;  // host time, where there is one
  };
  static constexpr auto kCountNames = std::to_array<std::string_view>(
      {"parts_released", "parts_timed_out", "parts_overflowed", "parts_flushed", "parts_waiting", "poses_taken", "poses_duplicate", "pose_restarts",
       "obstacles_ok", "obstacles_vessel_frame_only", "obstacles_pose_timeout", "footprints_thinned", "waterlines_thinned", "obstacles_of_second",
       "segments_of_second_dropped", "segments_of_second_untimely"});

  bool IsReady(const SegmentPart& part) const;
  void ReleaseFront(bool has_timed_out, std::vector<ObstaclePart>& released);
  void TakeSecond(const ScanHead& head);
  void ReleaseSecond(const ScanHead& head, bool has_timed_out, std::vector<ObstaclePart>& released);
  void Place(const Segment& segment, bool has_timed_out, const PlacementParams& placement, ObstaclePart& placed);
  void ReleaseReady(std::vector<ObstaclePart>& released);

  // Parts that the second lidar adds to the scan that is being released.
  struct Further {
    ScanHead head;  // of the scan's first part
    std::vector<std::vector<Segment>> parts;
    std::int32_t num_segments = 0;
    SecondSight sight = SecondSight::kWhole;
  };

  PlacementParams placement_;
  std::optional<PlacementParams> second_placement_;
  SecondLidar second_;
  Further further_;
  std::chrono::microseconds pose_timeout_;
  PoseHistory poses_;
  std::deque<Waiting> waiting_;
  std::optional<Utime> host_time_;
  std::optional<Utime> pose_arrival_;  // host time of the last pose; before any pose, since when host time is known
  std::optional<Utime> last_timeout_;
  std::int64_t num_second_silent_ = 0;  // scans of the first
  std::int64_t num_second_holes_ = 0;
  Counts<kCountNames> counts_;
};

}  // namespace lookout::georeferencer
