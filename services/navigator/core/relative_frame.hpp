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

/// Poses in it depend on what was added and on the poses on the earth that were shown to it, in their order.
class RelativeFrame {
 public:
  /// It begins so long after the start where nothing told of a place: no sentence at all, or sentences without position and heading.
  static constexpr std::chrono::milliseconds kBeginsSilent{500};
  static constexpr std::chrono::seconds kBeginsWithSentences{3};
  /// And so long after the last pose on the earth, by when tracks have ended; sooner where the earth had not been known for so long.
  static constexpr std::chrono::seconds kBeginsAfterEarth{30};
  /// Without a known motion the boat goes on as it went for so long; then its own motion is not known.
  static constexpr std::chrono::milliseconds kFresh{350};
  static constexpr std::chrono::seconds kCoasts{3};

  void Begin(Utime start);
  void NoteSentence() { has_sentence_ = true; }
  void Add(const OdometryMotion& motion);

  /// Whether motions would be used at this time.
  bool Wants(Utime time) const;

  /// @param earth  the pose by all other inputs; of one that places nothing its roll, pitch, heave and heading are used
  /// @param tilt_sd_rad  of roll and pitch that are not measured
  /// @return the same where it is placed, or no motion has come; else the pose in this frame. Its variance of heading is that of the turn in the last
  ///         3 s. Where the own motion is not known the pose stays, and velocity and its covariance are NaN
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
  void Activate(const Pose& earth);
  void TurnTo(double heading_rad, double shown_rad);
  Node NodeAt(Utime time) const;
  Node Extrapolated(Utime time) const;
  static Node Moved(const Node& from, Utime time, const Eigen::Vector2d& displacement_m, double turn_rad, const Eigen::Matrix3d& covariance);

  std::optional<Utime> start_;
  std::optional<Utime> first_earth_;  // pose on the earth since the last frame, or since the start
  std::optional<Utime> last_earth_;
  bool has_sentence_ = false;
  bool has_motion_ = false;  // one has come, known or not
  bool is_active_ = false;
  std::int64_t num_frames_ = 0;
  double number_ = kNan;  // height of the datum: begin of the frame, whole milliseconds since 1970
  HeadingSource heading_source_ = HeadingSource::kNone;
  std::deque<Node> nodes_;
  // Forward, port (m/s), turn (rad/s, clockwise) at the last node, and their covariance.
  Eigen::Vector3d rates_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rates_covariance_ = Eigen::Matrix3d::Zero();
  std::optional<Utime> last_known_;  // end of the last known motion
};

}  // namespace lookout::navigator
