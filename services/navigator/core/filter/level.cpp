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
  const GeodeticPlace boat = state.nominal.level->frame.Reverse(state.nominal.p_level_m);
  const Level next({boat.latitude_deg, boat.longitude_deg, state.nominal.level->origin.ellipsoid_height_m});
  const Eigen::Isometry3d T_next_level = next.frame.TransformFrom(state.nominal.level->frame);
  const Eigen::Matrix3d& R = T_next_level.linear();

  // The water is as far below the boat as it was. A height that was not measured stays 0.
  const double above_water_m = state.nominal.p_level_m.z() - state.nominal.water_level_m;
  const double old_up_m = state.nominal.p_level_m.z();
  state.nominal.p_level_m = T_next_level * state.nominal.p_level_m;
  if (!state.aiding.has_height) state.nominal.p_level_m.z() = old_up_m;
  state.nominal.water_level_m = state.nominal.p_level_m.z() - above_water_m;
  const auto& scan_p_m = state.nominal.scan_p_level_m;
  state.nominal.scan_p_level_m = (T_next_level * Eigen::Vector3d(scan_p_m.x(), scan_p_m.y(), old_up_m)).head<2>();
  state.nominal.scan_heading_rad -= Atan2(R(1, 0), R(0, 0));
  state.nominal.velocity_level_mps = (R * state.nominal.velocity_level_mps).eval();
  state.nominal.q_level_vessel = (Eigen::Quaterniond(R) * state.nominal.q_level_vessel).normalized();
  state.nominal.fix_error_m = (R * state.nominal.fix_error_m).eval();
  state.aiding.fix_refusals.first_residual = (R * state.aiding.fix_refusals.first_residual).eval();
  if (!state.aiding.is_strapdown) state.nominal.acceleration = (R * state.nominal.acceleration).eval();

  ErrorCovariance turn = ErrorCovariance::Identity();
  for (const int part : {kPosition, kVelocity, kRotation, kFixError}) {
    turn.block<3, 3>(part, part) = R;
  }
  if (!state.aiding.is_strapdown) turn.block<3, 3>(kAcceleration, kAcceleration) = R;
  turn.block<2, 2>(kScanPlace, kScanPlace) = R.topLeftCorner<2, 2>();
  turn.block<1, 3>(kWaterLevel, kPosition) = R.row(2);
  turn(kWaterLevel, kPositionUp) -= 1.0;
  state.covariance = (turn * state.covariance * turn.transpose()).eval();
  state.covariance = (0.5 * (state.covariance + state.covariance.transpose())).eval();
  state.nominal.level = next;
}

}  // namespace

Earth EarthAt(const GeodeticPlace& place) {
  const auto [sin_latitude, cos_latitude] = SinCosOfDegrees(place.latitude_deg);
  return {NormalGravityMps2(place.latitude_deg, place.ellipsoid_height_m), kEarthRateRadps * Eigen::Vector3d(0.0, cos_latitude, sin_latitude)};
}

Here HereOf(const State& state) {
  Here here;
  if (!state.nominal.level) return here;
  const bool is_at_origin = !state.aiding.has_position || state.nominal.p_level_m.head<2>().isZero(0.0);
  const GeodeticPlace place = is_at_origin ? state.nominal.level->origin : state.nominal.level->frame.Reverse(state.nominal.p_level_m);
  const auto [sin_latitude, cos_latitude] = SinCosOfDegrees(place.latitude_deg);
  here.heading_per_east_radpm = sin_latitude / (std::max(cos_latitude, kMinCosine) * kEarthRadiusM);
  if (!is_at_origin) here.R_here_level = LocalFrame(place).TransformFrom(state.nominal.level->frame).linear();
  return here;
}

Earth EarthOf(const State& state) { return state.nominal.level ? state.nominal.level->earth : Earth{}; }

void FollowBoat(State& state) {
  if (state.nominal.level && state.aiding.has_position && state.nominal.p_level_m.head<2>().squaredNorm() > kMaxLevelM * kMaxLevelM)
    MoveToBoat(state);
}

void ForgetPlace(State& state) {
  if (state.nominal.level && state.aiding.has_position) MoveToBoat(state);
  state.aiding.has_position = state.aiding.has_height = state.aiding.scan_place.has_position = false;
}

void BeginLevel(const GeodeticPlace& place, const Eigen::Vector2d& from_place_m, State& state) {
  state.nominal.level = Level(place);
  state.nominal.p_level_m.head<2>().setZero();
  if (from_place_m.isZero(0.0)) return;
  const GeodeticPlace boat = state.nominal.level->frame.Reverse({from_place_m.x(), from_place_m.y(), 0.0});
  state.nominal.level = Level({boat.latitude_deg, boat.longitude_deg, place.ellipsoid_height_m});
}

}  // namespace lookout::navigator::filter
