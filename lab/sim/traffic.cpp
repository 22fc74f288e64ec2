#include "lab/sim/traffic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;

constexpr double kStepS = 0.2;

// M. Jeong, A. Quattrini Li, IROS 2021: Catabot, 2.4 m x 1.4 m.
constexpr double kOwnHalfLengthM = 1.2;
constexpr double kOwnHalfWidthM = 0.7;
constexpr double kHeadroomM = 2.5;  // a man who stands on the deck, and a little more

double RadiusOf(const Outline& outline_m) {
  double radius_m = 0.0;
  for (const auto& p_m : outline_m) radius_m = std::max(radius_m, p_m.norm());
  return radius_m;
}

Outline At(const Placement& placement, const Outline& outline_m) {
  Outline moved_m;
  moved_m.reserve(outline_m.size());
  for (const auto& p_m : outline_m) moved_m.push_back(placement.ToMap(p_m));
  return moved_m;
}

}  // namespace

Traffic::Traffic(double checked_s) : num_samples_(static_cast<int>(checked_s / kStepS) + 1) {}

void Traffic::SetOwnBoat(const OwnMotion& own_motion) { own_boat_ = ToMover(own_motion); }

Traffic::Mover Traffic::ToMover(const OwnMotion& own_motion) const {
  return Sampled("own boat", Rectangle(-kOwnHalfLengthM, kOwnHalfLengthM, -kOwnHalfWidthM, kOwnHalfWidthM), num_samples_, [&](double time_s) {
    const OwnState state = StateAt(own_motion, 0.0, time_s);
    return Placement{state.position_map_m.head<2>(), state.heading_rad};
  });
}

Traffic::Mover Traffic::ToMover(const SceneObject& object) const {
  Mover mover =
      Sampled(object.name, object.outline_m, object.track.is_moving() ? num_samples_ : 1, [&](double time_s) { return object.track.At(time_s); });
  mover.is_in_water = object.is_in_water;
  return mover;
}

// Between two samples it goes straight from the one to the other.
Traffic::Mover Traffic::Sampled(const std::string& name, const Outline& outline_m, int num_samples, const std::function<Placement(double)>& at) {
  Mover mover{name, {}, 0.0};
  const double radius_m = RadiusOf(outline_m);
  double last_heading_rad = 0.0;
  for (int i = 0; i < num_samples; ++i) {
    const Placement placement = at(i * kStepS);
    if (i > 0) {
      const double way_m =
          (placement.position_map_m - mover.shapes.back().center_m).norm() + radius_m * std::abs(WrapToPi(placement.heading_rad - last_heading_rad));
      mover.speed_mps = std::max(mover.speed_mps, way_m / kStepS);
    }
    last_heading_rad = placement.heading_rad;
    mover.shapes.push_back({At(placement, outline_m), placement.position_map_m, radius_m});
  }
  return mover;
}

double Traffic::NearestM(const Mover& a, const Mover& b, double limit_m) const {
  const std::size_t num_samples = std::max(a.shapes.size(), b.shapes.size());
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < num_samples;) {
    const Shape& of_a = a.shapes[std::min(i, a.shapes.size() - 1)];
    const Shape& of_b = b.shapes[std::min(i, b.shapes.size() - 1)];
    double distance_m = (of_a.center_m - of_b.center_m).norm() - of_a.radius_m - of_b.radius_m;
    if (distance_m < limit_m) distance_m = GapBetween(of_a.outline_m, of_b.outline_m);
    nearest_m = std::min(nearest_m, distance_m);
    if (nearest_m <= 0.0) return 0.0;
    // They cannot come within the limit before they have gone the rest of the way.
    const double rest_steps = (distance_m - limit_m) / (std::max(a.speed_mps + b.speed_mps, 1e-6) * kStepS);
    i += static_cast<std::size_t>(std::clamp(rest_steps, 1.0, static_cast<double>(num_samples_)));
  }
  return nearest_m;
}

void Traffic::Add(const SceneObject& object, bool is_passed_under) {
  others_.push_back(ToMover(object));
  if (!is_passed_under) return obstacles_.push_back(others_.back());
  for (const auto& part : object.parts) {
    const Bounds bounds = BoundsOf(part.solid);
    if (bounds.low_m >= kHeadroomM) continue;
    Vector2d min_m = bounds.points_m.front();
    Vector2d max_m = min_m;
    for (const auto& p_m : bounds.points_m) {
      min_m = min_m.cwiseMin(p_m);
      max_m = max_m.cwiseMax(p_m);
    }
    SceneObject low = object;
    low.outline_m = Rectangle(min_m.x() - bounds.radius_m, max_m.x() + bounds.radius_m, min_m.y() - bounds.radius_m, max_m.y() + bounds.radius_m);
    obstacles_.push_back(ToMover(low));
  }
}

std::optional<Approach> Traffic::ToOwnBoat(const SceneObject& object, double limit_m) const {
  if (!own_boat_) return std::nullopt;
  const double distance_m = NearestM(ToMover(object), *own_boat_, limit_m);
  if (distance_m >= limit_m) return std::nullopt;
  return Approach{distance_m, own_boat_->name, limit_m};
}

std::optional<Approach> Traffic::ToOthers(const SceneObject& object, double limit_m, std::size_t num_first,
                                          std::optional<std::size_t> skipped) const {
  const Mover mover = ToMover(object);
  for (std::size_t i = 0; i < std::min(num_first, others_.size()); ++i) {
    if (i == skipped) continue;
    const double distance_m = NearestM(mover, others_[i], limit_m);
    if (distance_m < limit_m) return Approach{distance_m, others_[i].name, limit_m};
  }
  return std::nullopt;
}

std::optional<Approach> Traffic::ToOne(const SceneObject& object, double limit_m, std::size_t other) const {
  const double distance_m = NearestM(ToMover(object), others_[other], limit_m);
  if (distance_m >= limit_m) return std::nullopt;
  return Approach{distance_m, others_[other].name, limit_m};
}

std::optional<Approach> Traffic::OfOwnBoat(const OwnMotion& own_motion, double limit_m) const {
  const Mover own_boat = ToMover(own_motion);
  for (const auto& other : obstacles_) {
    const double distance_m = NearestM(own_boat, other, limit_m);
    if (distance_m < limit_m) return Approach{distance_m, other.name, limit_m};
  }
  return std::nullopt;
}

std::optional<Approach> Traffic::Overlapping(const SceneObject& object) const {
  if (!object.is_in_water) return std::nullopt;
  const Mover mover = ToMover(object);
  for (const auto& other : others_) {
    if (other.is_in_water && NearestM(mover, other, 0.0) <= 0.0) return Approach{0.0, other.name};
  }
  return std::nullopt;
}

}  // namespace lookout::sim
