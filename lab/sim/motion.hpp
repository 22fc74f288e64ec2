// How boats move. Time is in seconds since the start of the simulation; map is east, north, up at the datum of the simulation, up from the
// calm water.
#pragma once

#include <Eigen/Geometry>
#include <GeographicLib/LocalCartesian.hpp>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/angles.hpp"

namespace lookout::sim {

/// Datum where boat.txtpb holds none: a lake in New Hampshire; west of Greenwich, so that a wrong sign shows.
inline constexpr GeodeticPlace kLakeDatum{43.6300, -72.1500, 201.0};

inline GeographicLib::LocalCartesian MapFrame(const config::BoatFacts& boat) {
  const auto datum = boat.datum.value_or(kLakeDatum);
  return {datum.latitude_deg, datum.longitude_deg, datum.ellipsoid_height_m};
}

/// Place and heading of an object whose frame (x forward, y port, z up) has its origin on the water.
struct Placement {
  Eigen::Vector2d position_map_m = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;

  Eigen::Vector2d ToMap(const Eigen::Vector2d& p_object_m) const;
};

/// A part of a route: a straight line or an arc, begun at a time.
struct Leg {
  double from_s = 0.0;
  Placement start;
  double turn_rate_radps = 0.0;  // clockwise
};

/// The way of another object, bow first at constant speed: a straight line, a circle, or a route of legs.
struct Track {
  Placement start;
  double speed_mps = 0.0;
  double turn_rate_radps = 0.0;  // clockwise
  std::vector<Leg> legs{};       // of a route, by time from 0 on; the turn rate above then has no meaning
  double route_s = 0.0;          // time of the legs; then a closed route begins anew, and the object stops at the end of an open one
  bool is_closed = false;

  bool is_moving() const { return speed_mps != 0.0 || turn_rate_radps != 0.0; }
  Placement At(double time_s) const;
};

/// Sharper corners have no arc: the path would turn back on the spot.
inline constexpr double kMaxRouteTurnRad = DegToRad(170.0);

/// Path through waypoints with rounded corners. An open route begins at the first and stops at the last; a closed one goes on to the first and
/// round again.
///
/// @param waypoints_map_m  two at least, no two neighbours at one place, no turn of more than kMaxRouteTurnRad
/// @param turn_radius_m    of the corners; less where half of a leg is too short for it
Track MakeRoute(const std::vector<Eigen::Vector2d>& waypoints_map_m, double speed_mps, double turn_radius_m, bool is_closed);

/// A part of a motion: amplitude x sin(2 pi time / period + phase).
struct Wave {
  double amplitude;
  double period_s;
  double phase_rad;
};

/// Motion of the own boat: round an ellipse or along a track, bow along the course but for the leeway, with the waves' motion on top.
struct OwnMotion {
  Eigen::Vector2d center_map_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d semi_axes_m = Eigen::Vector2d::Zero();  // east, north; both 0 = along `track`
  double period_s = 1.0;                                  // time of one round, counter-clockwise
  double start_rad = 0.0;                                 // where on the round: 0 = east, pi / 2 = north
  std::vector<Wave> leeway_rad{};                         // heading minus course
  std::vector<Wave> roll_rad{};
  std::vector<Wave> pitch_rad{};
  std::vector<Wave> heave_m{};
  Track track{};  // in place of the ellipse: a straight line or a circle
};

/// State of the vessel frame. Signs as in POSE: heading clockwise from north, pitch positive bow up, roll positive starboard down.
struct OwnState {
  Eigen::Vector3d position_map_m;  // of the reference point
  Eigen::Vector2d velocity_map_mps;
  double heading_rad;
  double pitch_rad;
  double roll_rad;
  double heave_m;

  Eigen::Isometry3d T_map_vessel() const;
};

/// @param reference_point_above_water_m  at rest
OwnState StateAt(const OwnMotion& motion, double reference_point_above_water_m, double time_s);

}  // namespace lookout::sim
