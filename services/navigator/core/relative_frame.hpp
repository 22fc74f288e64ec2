// A map frame of its own, where the earth is not known: it begins where the boat is, and the boat goes through it by LIDAR_ODOMETRY.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

#include "common/core/utime.hpp"
#include "services/navigator/core/odometry.hpp"
#include "services/navigator/core/pose.hpp"

namespace lookout::navigator {

/// Poses in this frame depend on the motions added and on the poses on the earth passed to At, in their order.
class RelativeFrame {
 public:
  /// The frame begins this long after the start where nothing told of a place: kBeginsSilent with motions alone, else kWaits.
  static constexpr std::chrono::milliseconds kBeginsSilent{500};
  static constexpr std::chrono::seconds kWaits{3};
  /// The frame begins this long after the last pose on the earth, by when tracks have ended; sooner (after kWaits at least) where the earth was known
  /// for a shorter time.
  static constexpr std::chrono::seconds kBeginsAfterEarth{30};
  /// Without a known motion the boat goes on as it went for so long; then its own motion is not known.
  static constexpr std::chrono::milliseconds kFresh{350};
  static constexpr std::chrono::seconds kCoasts{3};

  void Begin(Utime start);
  /// Time that was jumped over, by a clock that was set or a computer that slept: it does not count as time without the earth.
  void Skip(std::chrono::microseconds duration);
  void NoteSentence() { has_sentence_ = true; }
  /// A motion has come, used or not.
  void NoteMotion() { has_motion_ = true; }
  void Add(const OdometryMotion& motion);

  /// Whether motions would be used at this time.
  bool Wants(Utime time) const;

  /// @param earth  the pose by all other inputs; where it has no place its roll, pitch, heave and heading are used
  /// @param tilt_sd_rad  deviation of roll and pitch where they are not measured
  /// @return `earth` where it is placed; else the pose in this frame. Its variance of heading is the variance of the turn in the last 3 s, the
  ///         variance of the heading where a heading is measured. Where the own motion is not known the pose stays, and velocity and its covariance
  ///         are NaN
  Pose At(const Pose& earth, double tilt_sd_rad);

  std::int64_t num_frames() const { return num_frames_; }

 private:
  // Where the boat was, frame axes: heading clockwise from the y axis.
  struct Node {
    Utime time;
    Eigen::Vector2d p_m = Eigen::Vector2d::Zero();
    double heading_rad = 0.0;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of x, y, heading
  };
  bool MayBegin(Utime time) const;
  bool IsByLidar(Utime time) const { return last_known_ && time - *last_known_ <= kCoasts; }
  void Activate(const Pose& earth);
  void FollowHeading(const Pose& earth);
  Pose Shown(const Pose& earth, double tilt_sd_rad);
  Node NodeAt(Utime time) const;
  Node Extrapolated(Utime time) const;
  static Node Moved(const Node& from, Utime time, const Eigen::Vector2d& displacement_m, double turn_rad, const Eigen::Matrix3d& covariance);

  std::optional<Utime> start_;
  std::optional<Utime> first_earth_;  // pose on the earth since the last frame, or since the start
  std::optional<Utime> last_earth_;
  bool has_sentence_ = false;
  bool has_motion_ = false;
  bool is_active_ = false;
  std::int64_t num_frames_ = 0;
  double number_ = kNan;  // height of the datum: begin of the frame, whole milliseconds since 1970
  HeadingSource heading_source_ = HeadingSource::kNone;
  // The last pose went by a measured heading; by how much the frame's y axis is off north then, since the heading had been away.
  bool has_followed_ = false;
  double off_north_rad_ = 0.0;
  std::optional<Utime> last_shown_;  // time of the last pose
  std::deque<Node> nodes_;
  // Forward, port (m/s), turn (rad/s, clockwise) at the last node, and their covariance.
  Eigen::Vector3d rates_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rates_covariance_ = Eigen::Matrix3d::Zero();
  std::optional<Utime> last_known_;  // end of the last known motion
};

}  // namespace lookout::navigator
