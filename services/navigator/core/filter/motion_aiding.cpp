// Own motion by the lidar as an aid: a motion from scan to scan is compared with what the state has done meanwhile.
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/navigator/core/filter/aiding.hpp"
#include "services/navigator/core/filter/kalman.hpp"

namespace lookout::navigator::filter {

namespace {

// Least deviations of a motion by the lidar, of each direction and of the turn; those stated are of the fit alone.
constexpr double kMotionSdM = 0.03;
constexpr double kMotionSdShare = 0.02;  // of the way
constexpr double kMotionTurnSdRad = DegToRad(0.02);
constexpr double kMotionTurnSdShare = 0.01;  // of the turn

// What the motion says, less what the state has done since the last scan.
Innovation<3> MotionOf(const OdometryMotion& motion, const FilterParams& params, const State& state) {
  const auto now = PlanarPlaceOf(params, state);
  const auto [sin, cos] = SinCosOf(state.nominal.scan_heading_rad);
  Eigen::Matrix2d R_vessel_level;  // to forward and port at the last scan
  R_vessel_level << sin, cos, -cos, sin;
  const Eigen::Vector2d way_level_m = now.p_level_m - state.nominal.scan_p_level_m;
  Innovation<3> innovation;
  innovation.residual.head<2>() = motion.displacement_m - R_vessel_level * way_level_m;
  innovation.residual[2] = WrapToPi(motion.turn_rad - (now.heading_rad - state.nominal.scan_heading_rad));
  innovation.jacobian.topRows<2>() = R_vessel_level * now.jacobian.topRows<2>();
  innovation.jacobian.block<2, 2>(0, kScanPlace) = -R_vessel_level;
  innovation.jacobian.block<2, 1>(0, kScanRotation) = R_vessel_level * Eigen::Vector2d(way_level_m.y(), -way_level_m.x());
  innovation.jacobian.row(2) = -now.jacobian.row(2);
  innovation.jacobian(2, kScanRotation) = 1.0;
  const double way_sd_m = Hypot(kMotionSdM, kMotionSdShare * motion.displacement_m.norm());
  const double turn_sd_rad = Hypot(kMotionTurnSdRad, kMotionTurnSdShare * motion.turn_rad);
  innovation.noise = motion.covariance;
  innovation.noise.diagonal() *= kInflatedVariance;
  innovation.noise.diagonal() += Eigen::Vector3d(way_sd_m, way_sd_m, turn_sd_rad).cwiseAbs2();
  return innovation;
}

// Where the place is not known, or was begun anew since, the turn alone counts.
Innovation<1> TurnOf(const Innovation<3>& motion) {
  Innovation<1> innovation;
  innovation.residual = motion.residual.tail<1>();
  innovation.jacobian = motion.jacobian.bottomRows<1>();
  innovation.noise = motion.noise.bottomRightCorner<1, 1>();
  return innovation;
}

void ApplyMotion(const OdometryMotion& motion, const FilterParams& params, State& state, GateCounts& counts) {
  const auto innovation = MotionOf(motion, params, state);
  const bool has_position = state.aiding.scan_place.has_position && state.aiding.has_position;
  const bool is_accepted = has_position ? Correct(innovation, false, state).is_accepted : Correct(TurnOf(innovation), false, state).is_accepted;
  if (is_accepted) {
    state.aiding.odometry.Use(state.time);
    state.aiding.odometry_contradicts_since.reset();
    return;
  }
  ++counts.num_gated;
  if (!state.aiding.odometry_contradicts_since) state.aiding.odometry_contradicts_since = state.time;
}

}  // namespace

void Apply(const OdometryMotion& motion, const FilterParams& params, State& state, GateCounts& counts) {
  const auto& from = state.aiding.scan_place;
  const bool has_begin = from.time == motion.begin && from.has_heading && state.aiding.has_heading;
  if (motion.is_known && has_begin && !IsOdometryRefused(state)) ApplyMotion(motion, params, state, counts);
  SetScanPlace(params, state);
}

}  // namespace lookout::navigator::filter
