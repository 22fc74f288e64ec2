#include "services/navigator/core/filter/level.hpp"

#include <algorithm>

#include "common/core/elementary.hpp"
#include "services/navigator/core/filter/state.hpp"

namespace lookout::navigator::filter {

namespace {

constexpr double kEarthRadiusM = 6371008.8;  // mean radius of WGS84's ellipsoid (NIMA TR8350.2, table 3.3)
// Beside a pole north turns as fast as the boat goes past it; at the pole itself there is none.
constexpr double kMinCosine = 1e-6;

void MoveToBoat(State& state) {
  const GeodeticPlace boat = state.level->frame.Reverse(state.p_level_m);
  const Level next({boat.latitude_deg, boat.longitude_deg, state.level->origin.ellipsoid_height_m});
  const Eigen::Isometry3d T_next_level = next.frame.TransformFrom(state.level->frame);
  const Eigen::Matrix3d& R = T_next_level.linear();

  // The water is as far below the boat as it was. A height that nobody measures stays 0.
  const double above_water_m = state.p_level_m.z() - state.water_level_m;
  const double old_up_m = state.p_level_m.z();
  state.p_level_m = T_next_level * state.p_level_m;
  if (!state.has_height) state.p_level_m.z() = old_up_m;
  state.water_level_m = state.p_level_m.z() - above_water_m;
  state.velocity_level_mps = (R * state.velocity_level_mps).eval();
  state.q_level_vessel = (Eigen::Quaterniond(R) * state.q_level_vessel).normalized();
  state.fix_error_m = (R * state.fix_error_m).eval();
  state.fix_refusals.first_residual = (R * state.fix_refusals.first_residual).eval();
  if (!state.is_strapdown) state.acceleration = (R * state.acceleration).eval();

  ErrorCovariance turn = ErrorCovariance::Identity();
  for (const int part : {static_cast<int>(kPosition), static_cast<int>(kVelocity), static_cast<int>(kRotation), static_cast<int>(kFixError)}) {
    turn.block<3, 3>(part, part) = R;
  }
  if (!state.is_strapdown) turn.block<3, 3>(kAcceleration, kAcceleration) = R;
  turn.block<1, 3>(kWaterLevel, kPosition) = R.row(2);
  turn(kWaterLevel, kPosition + 2) -= 1.0;
  state.covariance = (turn * state.covariance * turn.transpose()).eval();
  state.covariance = (0.5 * (state.covariance + state.covariance.transpose())).eval();
  state.level = next;
}

}  // namespace

Earth EarthAt(const GeodeticPlace& place) {
  const auto [sin_latitude, cos_latitude] = SinCosOfDegrees(place.latitude_deg);
  return {NormalGravityMps2(place.latitude_deg, place.ellipsoid_height_m), kEarthRateRadps * Eigen::Vector3d(0.0, cos_latitude, sin_latitude)};
}

Here HereOf(const State& state) {
  Here here;
  if (!state.level) return here;
  const bool is_at_origin = !state.has_position || state.p_level_m.head<2>().isZero(0.0);
  const GeodeticPlace place = is_at_origin ? state.level->origin : state.level->frame.Reverse(state.p_level_m);
  const auto [sin_latitude, cos_latitude] = SinCosOfDegrees(place.latitude_deg);
  here.heading_per_east_radpm = sin_latitude / (std::max(cos_latitude, kMinCosine) * kEarthRadiusM);
  if (!is_at_origin) here.R_here_level = LocalFrame(place).TransformFrom(state.level->frame).linear();
  return here;
}

Earth EarthOf(const State& state) { return state.level ? state.level->earth : Earth{}; }

void FollowBoat(State& state) {
  if (state.level && state.has_position && state.p_level_m.head<2>().squaredNorm() > kMaxLevelM * kMaxLevelM) MoveToBoat(state);
}

void ForgetPlace(State& state) {
  if (state.level && state.has_position) MoveToBoat(state);
  state.has_position = state.has_height = false;
}

void BeginLevel(const GeodeticPlace& place, const Eigen::Vector2d& from_place_m, State& state) {
  state.level = Level(place);
  state.p_level_m.head<2>().setZero();
  if (from_place_m.isZero(0.0)) return;
  const GeodeticPlace boat = state.level->frame.Reverse({from_place_m.x(), from_place_m.y(), 0.0});
  state.level = Level({boat.latitude_deg, boat.longitude_deg, place.ellipsoid_height_m});
}

}  // namespace lookout::navigator::filter
