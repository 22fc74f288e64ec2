// The method of the navigator process: items in; fixes, attitude and poses out. Its output depends on the items alone.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/health.hpp"
#include "services/navigator/core/filter/pose_filter.hpp"
#include "services/navigator/core/interpreter.hpp"
#include "services/navigator/core/item.hpp"
#include "services/navigator/core/measurement.hpp"
#include "services/navigator/core/relative_frame.hpp"

namespace lookout::navigator {

struct NavigatorParams : InterpreterParams {
  FilterParams filter;
  bool use_lidar_odometry = true;
  bool use_lidar_imu = true;  // use the IMU in a lidar, whose samples are turned by the lidar's mounting
};

/// Results of one item.
struct NavigatorOutput {
  std::optional<GnssFix> fix;
  std::optional<Attitude> attitude;
  std::vector<Pose> poses;  // by time
};

class Navigator {
 public:
  static constexpr std::chrono::milliseconds kPosePeriod{20};
  /// Poses of a longer stretch without an item are left out.
  static constexpr std::chrono::seconds kMaxGap{10};
  /// The lidar's clock may be ahead of the computer's by so much, a motion that waited while the process was held up among it.
  static constexpr std::chrono::seconds kMaxAhead{1};

  explicit Navigator(const NavigatorParams& params);

  /// Consumes the item; returns the poses of every whole 20 ms after the item before, up to this one. A start mark voids the earlier state; an end
  /// mark adds one more pose, at or after its time.
  ///
  /// @param item  not before the last one, unless it is a start mark
  NavigatorOutput Consume(const Item& item);

  /// End of input that has no end mark: the pose that an end mark would have added.
  NavigatorOutput Flush();

  /// Whether a motion of the odometer would be used now: with the first item of another kind.
  bool WantsOdometry() const { return time_ && params_.use_lidar_odometry; }
  /// Whether one has come within the last 2 s, and whether one that was too far ahead has.
  bool HasOdometry() const { return IsRecent(last_motion_); }
  bool IsOdometryAhead() const { return IsRecent(last_motion_ahead_); }
  const RelativeFrame& relative_frame() const { return relative_; }

  /// Time of the last item.
  const std::optional<Utime>& time() const { return time_; }
  /// The last pose since the start mark.
  const std::optional<Pose>& last_pose() const { return last_pose_; }
  const PoseFilter& filter() const { return filter_; }

  /// Computer's clock less UTC, as the sentences say; 0 while it counts as UTC.
  std::chrono::microseconds host_minus_utc() const { return interpreter_.host_minus_utc(); }

  std::vector<Counter> counters() const;

 private:
  bool IsRecent(const std::optional<Utime>& came) const;
  void OnOdometry(const Item& item);
  void OnSentence(const Item& item, NavigatorOutput& output);
  void AppendPose(NavigatorOutput& output);
  void Reset();

  NavigatorParams params_;
  Interpreter interpreter_;
  PoseFilter filter_;
  RelativeFrame relative_;
  std::int64_t num_motions_ = 0;
  std::optional<Utime> last_motion_;  // arrival of the last motion
  std::optional<Utime> last_motion_ahead_;
  std::int64_t num_bad_motions_ = 0;
  std::int64_t num_motions_ahead_ = 0;
  std::optional<Pose> last_pose_;
  std::optional<Utime> time_;
  Utime next_pose_{};
  std::int64_t num_time_jumps_ = 0;
};

}  // namespace lookout::navigator
