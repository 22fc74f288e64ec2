// Whether a receiver repeats an old place while the boat moves on.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "services/navigator/core/measurement.hpp"
#include "services/navigator/core/odometry.hpp"

namespace lookout::navigator {

/// A place that repeats to the last digit comes from a boat that lies still, from a receiver that holds its place at walking pace, or from a receiver
/// that is frozen while its clock goes on. The place is frozen where the boat has moved since the place first came: by the velocity that the same
/// receiver states, or, where it states none, by the lidar in the first seconds. The receiver's next different place is believed again.
///
/// A receiver that says "at rest" is believed against the lidar, and so is a place that stood before the lidar's way began: a ship that gathers way
/// looks like a shore that moves.
///
/// Depends on the measurements and on their order alone.
class FrozenPlaces {
 public:
  /// More than a filtered speed adds up to at a stop, and two steps of a receiver's last digit.
  static constexpr double kMostWayM = 3.0;
  static constexpr double kMostSteps = 2.0;
  /// Step of a receiver before it is known: two decimals of a minute.
  static constexpr double kUnknownStepM = 18.5;
  /// The lidar tells a frozen place for so long after the place first came.
  static constexpr std::chrono::seconds kByLidar{10};
  /// Slower than this a boat counts as at rest: receivers hold their place then, and their speed is noise.
  static constexpr double kLeastSpeedMps = 0.5;

  /// @return whether the place of the fix is frozen
  bool Judge(const GnssFix& fix);
  /// @return whether the receiver's last place was frozen
  bool Judge(const GroundVelocity& velocity);
  void Add(const OdometryMotion& motion);

  /// The last fix that was frozen.
  struct Frozen {
    std::string source;
    Utime time;
    double for_s = 0.0;  // since the frozen place first came
    double way_m = 0.0;  // way of the boat since then
  };
  const std::optional<Frozen>& last() const { return last_; }

 private:
  // One sentence type of a receiver: types differ by their digits.
  struct Place {
    double latitude_deg = kNan;
    double longitude_deg = kNan;
    // Least difference of two places that follow each other.
    double latitude_step_deg = kNan;
    double longitude_step_deg = kNan;
    Utime since;
    Eigen::Vector2d way_m = Eigen::Vector2d::Zero();        // Receiver::WayAt when the place first came
    Eigen::Vector2d lidar_way_m = Eigen::Vector2d::Zero();  // lidar_way_m_ likewise
    bool is_frozen_by_lidar = false;

    double StepM() const;
  };
  struct Receiver {
    std::map<std::string, Place, std::less<>> places;  // by sentence type
    Eigen::Vector2d way_m = Eigen::Vector2d::Zero();   // sum of the receiver's velocities until velocity_time, east and north
    Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
    std::optional<Utime> velocity_time;
    bool is_frozen = false;

    Eigen::Vector2d WayAt(Utime time) const;
    bool HasVelocity(Utime time) const;
  };

  static void AddVelocity(Utime time, double speed_mps, double course_rad, Receiver& receiver);
  void Begin(const GnssFix& fix, const Receiver& receiver, Place& place) const;
  double WayM(Utime time, const Receiver& receiver, Place& place) const;

  std::map<std::string, Receiver, std::less<>> receivers_;  // by source
  // By the lidar, in axes of its own.
  Eigen::Vector2d lidar_way_m_ = Eigen::Vector2d::Zero();
  double lidar_heading_rad_ = 0.0;
  std::optional<Frozen> last_;
};

}  // namespace lookout::navigator
