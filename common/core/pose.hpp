// The pose of the vessel at a time, and the poses of the last minutes.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <deque>
#include <limits>
#include <optional>

#include "common/core/elementary.hpp"
#include "common/core/geodesy.hpp"
#include "common/core/utime.hpp"

namespace lookout {

/// Geodetic origin of the map frame, WGS84. NaN = not known.
struct Datum {
  double latitude_deg = kNan;
  double longitude_deg = kNan;
  double ellipsoid_height_m = kNan;

  /// A frame of its own, not on the earth: latitude and longitude are NaN, the height is its number: when it began, ms since 1970.
  bool IsRelative() const { return std::isnan(latitude_deg) && std::isnan(longitude_deg) && std::isfinite(ellipsoid_height_m); }

  /// Not of a relative frame. The map frame; an unknown height counts as 0, which moves no position by more than 1 mm per 60 m of it and kilometre of
  /// distance.
  LocalFrame Map() const;
  /// Whether both are the same map frame, bit for bit. An unknown datum equals none.
  bool IsSameAs(const Datum& other) const;
};

/// The part of a pose that places a point: the vessel frame in the map frame.
struct Place {
  bool is_placed = false;  // position and heading are known; else position_map_m and heading_rad are not to be used
  Eigen::Vector3d position_map_m = Eigen::Vector3d::Zero();
  /// East, north and up where the boat is, along the axes of the map: heading is from north there, roll and pitch from up there. Away from the datum
  /// they differ from the axes of the map: up by 1 deg in 111 km, north by more near the poles. PoseHistory::Add sets it.
  Eigen::Matrix3d R_map_here = Eigen::Matrix3d::Identity();
  double heading_rad = 0.0;  // from true north, clockwise, 0 to 2 pi
  double pitch_rad = 0.0;    // positive bow up; 0 where not known
  double roll_rad = 0.0;     // positive starboard down; 0 where not known
};

struct Pose : Place {
  Utime time;
  Datum datum;           // of the map frame
  double heave_m = 0.0;  // reference point above its place on calm water; 0 where not known
  Eigen::Vector2d velocity_map_mps = Eigen::Vector2d::Constant(kNan);
  // Of east, north (m), roll, pitch, heading (rad), in this order. NaN = not known; not to be used unless placed.
  Eigen::Matrix<double, 5, 5> covariance = Eigen::Matrix<double, 5, 5>::Zero();
};

class PoseHistory {
 public:
  /// Poses older than this against the newest are forgotten: 6000 of them, 3 MB. A scan is placed within seconds of its end.
  static constexpr std::chrono::seconds kLength{120};
  /// Between poses farther apart nothing is known. The grid is 20 ms; the bracket is 5 of it.
  static constexpr std::chrono::milliseconds kMaxBracket{100};

  /// Sets its R_map_here by its place.
  ///
  /// Precondition: pose.time > newest()->time. Call Clear() before a pose that goes back in time.
  void Add(const Pose& pose);
  void Clear() { poses_.clear(); }

  const Pose* newest() const { return poses_.empty() ? nullptr : &poses_.back(); }

  /// The pose at `time`: the grid's where there is one, else between its two neighbours, linear, heading the short way round.
  ///
  /// @return nullopt when `time` is not between two poses at most kMaxBracket apart. It is placed when both neighbours are, in one datum.
  /// Cost: constant on an even grid; logarithmic in the length of the history where poses are missing.
  std::optional<Pose> At(Utime time) const;

  /// The place at `time` in the map frame of `datum`: is_placed is false if the poses are in another map frame. Costs a third of At.
  std::optional<Place> PlaceAt(Utime time, const Datum& datum) const;

  /// @return the datum in force at `time`: of the latest pose at or before it; unknown when there is none
  Datum DatumAt(Utime time) const;

 private:
  // Index of the first pose at or after `time`; the number of poses when there is none.
  std::size_t FirstNotBefore(Utime time) const;
  // The neighbours of a time and its share of the way between them; both are one at a time of the grid.
  struct Bracket {
    const Pose& before;
    const Pose& after;
    double share;

    bool IsOnePose() const { return &before == &after; }
  };
  static Place PlaceIn(const Bracket& bracket);
  std::optional<Bracket> BracketAt(Utime time) const;

  std::deque<Pose> poses_;  // increasing in time
};

}  // namespace lookout
