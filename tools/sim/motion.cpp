#include "tools/sim/motion.hpp"

#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"

namespace lookout::sim {
namespace {

double SumAt(const std::vector<Wave>& waves, double time_s) {
  double sum = 0.0;
  for (const auto& wave : waves) sum += wave.amplitude * std::sin(kTwoPi * time_s / wave.period_s + wave.phase_rad);
  return sum;
}

}  // namespace

Eigen::Vector2d Placement::ToMap(const Eigen::Vector2d& p_object_m) const {
  const double sine = std::sin(heading_rad);
  const double cosine = std::cos(heading_rad);
  return position_map_m + Eigen::Vector2d(sine * p_object_m.x() - cosine * p_object_m.y(), cosine * p_object_m.x() + sine * p_object_m.y());
}

Placement Track::At(double time_s) const {
  if (!is_moving()) return start;
  const double from_rad = start.heading_rad;
  if (turn_rate_radps == 0.0) {
    return {start.position_map_m + speed_mps * time_s * Eigen::Vector2d(std::sin(from_rad), std::cos(from_rad)), from_rad};
  }
  const double to_rad = from_rad + turn_rate_radps * time_s;
  const Eigen::Vector2d way_m =
      speed_mps / turn_rate_radps * Eigen::Vector2d(std::cos(from_rad) - std::cos(to_rad), std::sin(to_rad) - std::sin(from_rad));
  return {start.position_map_m + way_m, WrapTo2Pi(to_rad)};
}

Eigen::Isometry3d OwnState::T_map_vessel() const {
  Eigen::Isometry3d T_map_vessel = Eigen::Isometry3d::Identity();
  T_map_vessel.linear() = RotationMapVessel(heading_rad, pitch_rad, roll_rad);
  T_map_vessel.translation() = position_map_m;
  return T_map_vessel;
}

OwnState StateAt(const OwnMotion& motion, double reference_point_above_water_m, double time_s) {
  OwnState state{};
  const double rate_radps = kTwoPi / motion.period_s;
  const double angle_rad = motion.start_rad + rate_radps * time_s;
  const double sine = std::sin(angle_rad);
  const double cosine = std::cos(angle_rad);
  const Eigen::Vector2d position_m = motion.center_map_m + motion.semi_axes_m.cwiseProduct(Eigen::Vector2d(cosine, sine));
  state.velocity_map_mps = rate_radps * motion.semi_axes_m.cwiseProduct(Eigen::Vector2d(-sine, cosine));
  const bool is_still = motion.semi_axes_m.isZero();
  const double course_rad = is_still ? motion.still_heading_rad : std::atan2(state.velocity_map_mps.x(), state.velocity_map_mps.y());
  state.heading_rad = WrapTo2Pi(course_rad + SumAt(motion.leeway_rad, time_s));
  state.roll_rad = SumAt(motion.roll_rad, time_s);
  state.pitch_rad = SumAt(motion.pitch_rad, time_s);
  state.heave_m = SumAt(motion.heave_m, time_s);
  state.position_map_m = {position_m.x(), position_m.y(), reference_point_above_water_m + state.heave_m};
  return state;
}

}  // namespace lookout::sim
