#include "services/navigator/core/filter/motion_trial.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/navigator/core/filter/state.hpp"

namespace lookout::navigator::filter {

namespace {

// Variance of the difference of two measurements with a slow error, `apart_s` apart. The part of the error that both have in common cancels.
double VarianceOfDifference(double before, double now, const ErrorModel& slow, double apart_s) {
  const double common = slow.sd * slow.sd * Exp(-apart_s / slow.time_constant_s);
  return std::max(0.0, before - common) + std::max(0.0, now - common);
}

}  // namespace

void MotionTrial::Means::Add(double new_square, double new_of_sensors, double new_of_motions) {
  constexpr double kGain = 0.1;           // the last half minute
  constexpr double kMostFactor2 = 100.0;  // bound on a single window: a greater difference has another cause
  const double square_within = std::min(new_square, new_of_sensors + kMostFactor2 * new_of_motions);
  if (!std::isfinite(square_within)) return;
  if (of_motions == 0.0) *this = {new_of_sensors + new_of_motions, new_of_sensors, new_of_motions};  // as stated, until more is known
  square += kGain * (square_within - square);
  of_sensors += kGain * (new_of_sensors - of_sensors);
  of_motions += kGain * (new_of_motions - of_motions);
}

// Takes twice the variance of the sensors and once the variance of the motions off the squares, as squares exceed their mean by so much by chance;
// the rest is due to the motions.
double MotionTrial::Means::Factor() const {
  if (of_motions <= 0.0) return 1.0;
  return std::sqrt(std::max(1.0, (square - 2.0 * of_sensors - of_motions) / of_motions));
}

MotionTrial::Begin MotionTrial::BeginAt(const FilterParams& params, const State& state, bool is_way_measured, bool is_turn_measured) {
  const auto place = PlanarPlaceOf(params, state);
  return {state.time,
          state.nominal.level ? state.nominal.level->origin : GeodeticPlace{},
          place.p_level_m,
          place.heading_rad,
          state.HorizontalVarianceM2(),
          state.covariance(kRotationUp, kRotationUp),
          is_way_measured,
          is_turn_measured};
}

void MotionTrial::Add(const OdometryMotion& motion, const Eigen::Matrix3d& noise, bool is_way_measured, bool is_turn_measured,
                      const FilterParams& params, const State& state) {
  const auto now = BeginAt(params, state, is_way_measured, is_turn_measured);
  if (begin_) {
    begin_->is_way_measured = begin_->is_way_measured && is_way_measured && begin_->origin.latitude_deg == now.origin.latitude_deg &&
                              begin_->origin.longitude_deg == now.origin.longitude_deg;
    begin_->is_turn_measured = begin_->is_turn_measured && is_turn_measured;
  }
  if (!begin_ || (!begin_->is_way_measured && !begin_->is_turn_measured)) {
    begin_ = now;
    way_level_m_.setZero();
    turn_rad_ = way_variance_m2_ = turn_variance_rad2_ = 0.0;
    return;
  }
  const auto [sin, cos] = SinCosOf(begin_->heading_rad + turn_rad_);
  const auto& way_m = motion.displacement_m;  // forward, port
  way_level_m_ += Eigen::Vector2d(sin * way_m.x() - cos * way_m.y(), cos * way_m.x() + sin * way_m.y());
  turn_rad_ += motion.turn_rad;
  way_variance_m2_ += 0.5 * (noise(0, 0) + noise(1, 1));
  turn_variance_rad2_ += noise(2, 2);
  const double apart_s = SecondsBetween(begin_->time, state.time);
  if (apart_s < kWindowS) return;
  if (begin_->is_way_measured) {
    const Eigen::Vector2d off_m = way_level_m_ - (now.p_level_m - begin_->p_level_m);
    // The direction of the way is off by the error of the heading at the begin.
    const double by_heading_m2 = begin_->heading_variance_rad2 * way_level_m_.squaredNorm();
    const double of_sensors_m2 =
        VarianceOfDifference(begin_->place_variance_m2, now.place_variance_m2, state.aiding.fix_error_model, apart_s) + 0.5 * by_heading_m2;
    way_.Add(0.5 * off_m.squaredNorm(), of_sensors_m2, way_variance_m2_);
  }
  if (begin_->is_turn_measured) {
    const double off_rad = WrapToPi(turn_rad_ - (now.heading_rad - begin_->heading_rad));
    const double of_sensors_rad2 =
        VarianceOfDifference(begin_->heading_variance_rad2, now.heading_variance_rad2, state.aiding.heading_error_model, apart_s);
    turn_.Add(off_rad * off_rad, of_sensors_rad2, turn_variance_rad2_);
  }
  begin_.reset();
  Add(motion, noise, is_way_measured, is_turn_measured, params, state);
}

}  // namespace lookout::navigator::filter
