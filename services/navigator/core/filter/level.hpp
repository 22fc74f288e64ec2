// The level frame in which the filter lives: east, north and up at a place near the boat.
#pragma once

#include <Eigen/Core>

#include "common/core/geodesy.hpp"

namespace lookout::navigator::filter {

struct State;

/// Gravity and turn of the earth at a place, in the level frame there.
struct Earth {
  double gravity_mps2 = 9.80665;
  Eigen::Vector3d rate_level_radps = Eigen::Vector3d::Zero();
};

/// WGS84's normal gravity and the rate of the earth.
Earth EarthAt(const GeodeticPlace& place);

/// Fixed to the earth. The boat is no farther than kMaxLevelM from the origin: there gravity leans by 16 microradians (0.15 mm/s2, a third of a
/// hundredth of the assumed bias of accelerometers), and the surface lies 0.8 mm below the plane.
struct Level {
  explicit Level(const GeodeticPlace& place) : origin(place), frame(place), earth(EarthAt(place)) {}

  GeodeticPlace origin;
  LocalFrame frame;
  Earth earth;
};

inline constexpr double kMaxLevelM = 100.0;

/// East, north and up where the boat is: what sensors of heading, course and tilt measure against.
struct Here {
  Eigen::Matrix3d R_here_level = Eigen::Matrix3d::Identity();
  /// How much a bow that keeps its direction gains in heading when the boat is moved to the east: meridians converge.
  double heading_per_east_radpm = 0.0;
};

/// Source: directions by LocalFrame at the boat's place, exact; the convergence of meridians is that on a sphere, bounded at 6 m from a pole.
Here HereOf(const State& state);

/// Gravity and rotation of the level frame; where no place is known yet, standard gravity and no rate.
Earth EarthOf(const State& state);

/// Moves the origin to the boat when that is farther than kMaxLevelM from it. Nominal state and covariance are turned exactly; the height of the
/// origin stays.
void FollowBoat(State& state);

/// The place of the boat is given up: attitude and velocity stay as they are against east, north and up where it was.
void ForgetPlace(State& state);

/// The position becomes known anew: the level frame begins there, the boat in its origin. Attitude and velocity stay as they are
/// against east, north and up.
///
/// @param from_place_m  the boat from the place, east and north
void BeginLevel(const GeodeticPlace& place, const Eigen::Vector2d& from_place_m, State& state);

}  // namespace lookout::navigator::filter
