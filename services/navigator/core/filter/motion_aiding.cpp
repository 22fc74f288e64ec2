// Own motion by the lidar as an aid: a motion from scan to scan is compared with what the state has done meanwhile.
#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/navigator/core/filter/aiding.hpp"
#include "services/navigator/core/filter/kalman.hpp"

namespace lookout::navigator::filter {

namespace {

// Beside kMotionSdM.
constexpr double kMotionSdShare = 0.02;  // of the way
constexpr double kMotionTurnSdRad = DegToRad(0.02);
constexpr double kMotionTurnSdShare = 0.01;  // of the turn

// The motion's way and turn, less the way and turn of the state since the last scan.
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

// With the deviations by which motions have erred lately.
Innovation<3> AsTried(Innovation<3> innovation, const MotionTrial& trial) {
  const Eigen::Vector3d factors(trial.way_factor(), trial.way_factor(), trial.turn_factor());
  innovation.noise = factors.asDiagonal() * innovation.noise * factors.asDiagonal();
  return innovation;
}

template <int kRows>
Innovation<kRows> FirstOf(const Innovation<3>& motion) {
  Innovation<kRows> innovation;
  innovation.residual = motion.residual.head<kRows>();
  innovation.jacobian = motion.jacobian.topRows<kRows>();
  innovation.noise = motion.noise.topLeftCorner<kRows, kRows>();
  return innovation;
}

Innovation<1> TurnOf(const Innovation<3>& motion) {
  Innovation<1> innovation;
  innovation.residual = motion.residual.tail<1>();
  innovation.jacobian = motion.jacobian.bottomRows<1>();
  innovation.noise = motion.noise.bottomRightCorner<1, 1>();
  return innovation;
}

// A measurement that is late by half an interval counts as missing: without an IMU a turn is known for less than a second.
bool GoesOn(const UseTimes& input, Utime time) {
  constexpr double kLeastS = 0.3;
  return input.last && SecondsBetween(*input.last, time) <= std::max(kLeastS, 1.5 * input.interval_s);
}

// The lidar replaces what is not measured, and helps what is measured to centimetres and a fraction of a degree. Nothing else: a large ship that
// gathers way looks like a shore, and would draw the state away from a receiver or a compass whose slow error is not known, however often these
// measure.
// @param stated  as the motion says itself: the gate is of this
bool ApplyNeeded(const Innovation<3>& stated, bool may_use_way, State& state) {
  const auto& aiding = state.aiding;
  const bool uses_way = may_use_way && (!GoesOn(aiding.fix, state.time) || aiding.fix_error_model.kind == ErrorKind::kRtk);
  // Where the course stands in for a heading, leeway and turning make it wrong by far more than the lidar is.
  const bool is_poor = aiding.heading_source == HeadingSource::kCourse;
  const bool uses_turn = is_poor || !GoesOn(aiding.heading(), state.time) || aiding.heading_error_model.kind == ErrorKind::kTwoAntennas;
  const auto agrees = [&state](const auto& part) {
    State corrected = state;
    return Correct(part, false, corrected).is_accepted;
  };
  // All of it must agree, also what is not used.
  if (!(may_use_way ? agrees(stated) : agrees(TurnOf(stated)))) return false;
  const auto motion = AsTried(stated, aiding.motion_trial);
  if (uses_way) state.aiding.lidar_led_way = state.time;
  if (uses_turn) state.aiding.lidar_led_turn = state.time;
  if (uses_way && uses_turn) {
    Correct(motion, true, state);
  } else if (uses_way && agrees(FirstOf<2>(stated))) {
    Correct(FirstOf<2>(motion), true, state);
  } else if (uses_turn && agrees(TurnOf(stated))) {
    Correct(TurnOf(motion), true, state);
  }
  return true;
}

// A compass that drifts takes the state with it, too slowly for any gate. While it measures the lidar's turn is not used, so the state has turned by
// the compass since the last scan.
void NoteTurn(double turned_more_rad, State& state) {
  auto& aiding = state.aiding;
  if (aiding.heading_error_model.kind == ErrorKind::kCompass && GoesOn(aiding.heading(), state.time)) aiding.heading_apart_rad += turned_more_rad;
}

void ApplyMotion(const OdometryMotion& motion, const FilterParams& params, State& state, GateCounts& counts) {
  // Where the place is not known, or was begun anew since, the turn alone counts.
  const bool may_use_way = state.aiding.scan_place.has_position && state.aiding.has_position;
  const auto innovation = MotionOf(motion, params, state);
  NoteTurn(innovation.residual[2], state);
  auto& aiding = state.aiding;
  if (IsOdometryRefused(state)) {
    aiding.motion_trial.Break();
    return;
  }
  const bool is_way_measured = may_use_way && GoesOn(aiding.fix, state.time) && !aiding.fix_refusals.since;
  const bool is_turn_measured =
      aiding.heading_source != HeadingSource::kCourse && GoesOn(aiding.heading(), state.time) && !aiding.heading_refusals.since;
  auto trial = aiding.motion_trial;
  trial.Add(motion, innovation.noise, is_way_measured, is_turn_measured, params, state);
  if (ApplyNeeded(innovation, may_use_way, state)) {
    aiding.motion_trial = trial;
    state.aiding.odometry.Use(state.time);
    state.aiding.odometry_contradicts_since.reset();
    return;
  }
  aiding.motion_trial.Break();
  ++counts.num_gated;
  if (!state.aiding.odometry_contradicts_since) state.aiding.odometry_contradicts_since = state.time;
}

}  // namespace

void Apply(const OdometryMotion& motion, const FilterParams& params, State& state, GateCounts& counts) {
  const auto& from = state.aiding.scan_place;
  const bool has_begin = from.time == motion.begin && from.has_heading && state.aiding.has_heading;
  if (!motion.is_known) state.aiding.odometry_contradicts_since.reset();
  if (motion.is_known && has_begin) {
    ApplyMotion(motion, params, state, counts);
  } else {
    state.aiding.motion_trial.Break();
  }
  SetScanPlace(params, state);
}

}  // namespace lookout::navigator::filter
