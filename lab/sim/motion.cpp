#include "lab/sim/motion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;

double SumAt(const std::vector<Wave>& waves, double time_s) {
  double sum = 0.0;
  for (const auto& wave : waves) sum += wave.amplitude * std::sin(kTwoPi * time_s / wave.period_s + wave.phase_rad);
  return sum;
}

Placement Along(const Placement& start, double speed_mps, double turn_rate_radps, double time_s) {
  const double from_rad = start.heading_rad;
  if (turn_rate_radps == 0.0) {
    return {start.position_map_m + speed_mps * time_s * Vector2d(std::sin(from_rad), std::cos(from_rad)), from_rad};
  }
  const double to_rad = from_rad + turn_rate_radps * time_s;
  const Vector2d way_m = speed_mps / turn_rate_radps * Vector2d(std::cos(from_rad) - std::cos(to_rad), std::sin(to_rad) - std::sin(from_rad));
  return {start.position_map_m + way_m, WrapTo2Pi(to_rad)};
}

}  // namespace

Eigen::Vector2d Placement::ToMap(const Eigen::Vector2d& p_object_m) const {
  const double sine = std::sin(heading_rad);
  const double cosine = std::cos(heading_rad);
  return position_map_m + Vector2d(sine * p_object_m.x() - cosine * p_object_m.y(), cosine * p_object_m.x() + sine * p_object_m.y());
}

Placement Track::At(double time_s) const {
  if (!is_moving()) return start;
  if (legs.empty()) return Along(start, speed_mps, turn_rate_radps, time_s);
  double on_route_s = time_s;
  if (is_closed) {
    on_route_s = std::fmod(time_s, route_s);
    if (on_route_s < 0.0) on_route_s += route_s;
  }
  on_route_s = std::clamp(on_route_s, 0.0, route_s);
  const auto next = std::ranges::upper_bound(legs, on_route_s, {}, &Leg::from_s);
  const Leg& leg = next == legs.begin() ? *next : *std::prev(next);
  return Along(leg.start, speed_mps, leg.turn_rate_radps, on_route_s - leg.from_s);
}

Track MakeRoute(const std::vector<Vector2d>& waypoints_map_m, double speed_mps, double turn_radius_m, bool is_closed) {
  const std::size_t num_points = waypoints_map_m.size();
  const std::size_t num_edges = is_closed ? num_points : num_points - 1;
  const auto point = [&](std::size_t i) -> const Vector2d& { return waypoints_map_m[i % num_points]; };
  const auto heading_of_edge = [&](std::size_t i) {
    const Vector2d edge_m = point(i + 1) - point(i);
    return std::atan2(edge_m.x(), edge_m.y());
  };
  // The corner at the end of an edge: an arc that touches both edges, `cut_m` before and behind the waypoint.
  struct Corner {
    double cut_m = 0.0;
    double turn_rad = 0.0;
    double radius_m = 0.0;
  };
  std::vector<Corner> corners(num_edges);
  for (std::size_t i = 0; i < num_edges; ++i) {
    if (!is_closed && i + 1 == num_edges) continue;
    const std::size_t next = (i + 1) % num_edges;
    Corner& corner = corners[i];
    corner.turn_rad = WrapToPi(heading_of_edge(next) - heading_of_edge(i));
    const double tangent = std::tan(std::abs(corner.turn_rad) / 2.0);
    const double room_m = std::min((point(i + 1) - point(i)).norm(), (point(next + 1) - point(next)).norm()) / 2.0;
    corner.cut_m = std::min(turn_radius_m * tangent, room_m);
    if (tangent > 0.0) corner.radius_m = corner.cut_m / tangent;
  }

  Track track;
  track.speed_mps = speed_mps;
  track.is_closed = is_closed;
  for (std::size_t i = 0; i < num_edges; ++i) {
    const double heading_rad = WrapTo2Pi(heading_of_edge(i));
    const Vector2d direction(std::sin(heading_rad), std::cos(heading_rad));
    const double length_m = (point(i + 1) - point(i)).norm();
    const double begin_m = is_closed || i > 0 ? corners[(i + num_edges - 1) % num_edges].cut_m : 0.0;
    const double end_m = length_m - corners[i].cut_m;
    track.legs.push_back({track.route_s, {point(i) + begin_m * direction, heading_rad}, 0.0});
    track.route_s += (end_m - begin_m) / speed_mps;
    if (corners[i].turn_rad != 0.0) {
      const double turn_s = corners[i].radius_m * std::abs(corners[i].turn_rad) / speed_mps;
      track.legs.push_back({track.route_s, {point(i) + end_m * direction, heading_rad}, corners[i].turn_rad / turn_s});
      track.route_s += turn_s;
    }
  }
  track.start = track.legs.front().start;
  return track;
}

Eigen::Isometry3d OwnState::T_map_vessel() const {
  Eigen::Isometry3d T_map_vessel = Eigen::Isometry3d::Identity();
  T_map_vessel.linear() = RotationMapVessel(heading_rad, pitch_rad, roll_rad);
  T_map_vessel.translation() = position_map_m;
  return T_map_vessel;
}

OwnState StateAt(const OwnMotion& motion, double reference_point_above_water_m, double time_s) {
  OwnState state{};
  Vector2d position_m;
  double course_rad = 0.0;
  if (motion.semi_axes_m.isZero()) {
    const Placement placement = motion.track.At(time_s);
    position_m = placement.position_map_m;
    course_rad = placement.heading_rad;
    state.velocity_map_mps = motion.track.speed_mps * Vector2d(std::sin(course_rad), std::cos(course_rad));
  } else {
    const double rate_radps = kTwoPi / motion.period_s;
    const double angle_rad = motion.start_rad + rate_radps * time_s;
    const double sine = std::sin(angle_rad);
    const double cosine = std::cos(angle_rad);
    position_m = motion.center_map_m + motion.semi_axes_m.cwiseProduct(Vector2d(cosine, sine));
    state.velocity_map_mps = rate_radps * motion.semi_axes_m.cwiseProduct(Vector2d(-sine, cosine));
    course_rad = std::atan2(state.velocity_map_mps.x(), state.velocity_map_mps.y());
  }
  state.heading_rad = WrapTo2Pi(course_rad + SumAt(motion.leeway_rad, time_s));
  state.roll_rad = SumAt(motion.roll_rad, time_s);
  state.pitch_rad = SumAt(motion.pitch_rad, time_s);
  state.heave_m = SumAt(motion.heave_m, time_s);
  state.position_map_m = {position_m.x(), position_m.y(), reference_point_above_water_m + state.heave_m};
  return state;
}

}  // namespace lookout::sim
