#include "lab/sim/birds.hpp"

#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/random.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kBirdStream = 22;

double Wrap(double offset_m, double reach_m) { return offset_m - 2.0 * reach_m * std::floor((offset_m + reach_m) / (2.0 * reach_m)); }

}  // namespace

// From terns to geese: 0.25 to 0.9 m long, wings of 0.6 to 1.6 m, 6 to 16 m/s, most of them below a few metres.
Birds::Birds(double mean_count, std::uint64_t seed) {
  Random random(seed, kBirdStream);
  const int count = static_cast<int>(mean_count + random.Uniform());
  for (int i = 0; i < count; ++i) {
    Bird bird{};
    bird.start_m.x() = random.Uniform(-kReachM, kReachM);
    bird.start_m.y() = random.Uniform(-kReachM, kReachM);
    bird.radius_m = random.Uniform() < 0.4 ? random.Uniform(4.0, 25.0) : 0.0;
    bird.heading_rad = random.Uniform(0.0, kTwoPi);
    bird.speed_mps = random.Uniform(6.0, 16.0);
    const double height = random.Uniform();
    bird.height_m = 0.3 + 6.0 * height * height;
    bird.half_length_m = random.Uniform(0.12, 0.45);
    bird.half_span_m = bird.half_length_m * random.Uniform(1.5, 2.4);
    bird.beats_hz = random.Uniform(2.0, 6.0);
    bird.reflectance = random.Uniform(0.05, 0.7);
    birds_.push_back(bird);
  }
}

void Birds::MoveTo(double time_s, const Vector2d& eye_m) {
  for (Bird& bird : birds_) {
    const double way_m = bird.speed_mps * time_s;
    const double heading_rad = bird.radius_m > 0.0 ? bird.heading_rad + way_m / bird.radius_m : bird.heading_rad;
    bird.ahead = {std::cos(heading_rad), std::sin(heading_rad)};
    Vector2d middle_m = bird.start_m;
    if (bird.radius_m == 0.0) middle_m += way_m * bird.ahead;
    middle_m = eye_m + Vector2d(Wrap(middle_m.x() - eye_m.x(), kReachM), Wrap(middle_m.y() - eye_m.y(), kReachM));
    const Vector2d p_m = middle_m + bird.radius_m * Vector2d(bird.ahead.y(), -bird.ahead.x());
    bird.p_map_m = {p_m.x(), p_m.y(), bird.height_m};
    bird.wing_height_m = 0.5 * bird.half_span_m * std::sin(kTwoPi * bird.beats_hz * time_s + bird.heading_rad);
  }
}

std::optional<Echo> Birds::FirstEcho(const Ray& ray, double max_range_m) const {
  std::optional<Echo> echo;
  for (const Bird& bird : birds_) {
    const Vector3d to_m = bird.p_map_m - ray.origin_m;
    const double range_m = to_m.dot(ray.direction);
    const double reach_m = bird.half_span_m + bird.half_length_m;
    if (range_m <= 0.0 || range_m > max_range_m + reach_m || (to_m - range_m * ray.direction).squaredNorm() > reach_m * reach_m) continue;
    const auto turn = [&bird](const Vector3d& v) {
      return Vector3d(bird.ahead.x() * v.x() + bird.ahead.y() * v.y(), bird.ahead.x() * v.y() - bird.ahead.y() * v.x(), v.z());
    };
    const Ray own{-turn(to_m), turn(ray.direction)};
    const auto consider = [&](const std::optional<Hit>& hit) {
      if (!hit || hit->range_m >= (echo ? echo->hit.range_m : max_range_m)) return;
      echo = Echo{*hit, kNoObject, {bird.reflectance}, ReturnReason::kBird};
    };
    const double thick_m = 0.3 * bird.half_length_m;
    consider(Intersect(Ellipsoid{Vector3d::Zero(), {bird.half_length_m, thick_m, thick_m}}, own));
    const double chord_m = 0.35 * bird.half_length_m;
    for (const double side : {-1.0, 1.0}) {
      const Vector3d tip_m(-chord_m, side * bird.half_span_m, bird.wing_height_m);
      consider(Intersect(Triangle{{chord_m, 0.0, 0.0}, {-chord_m, 0.0, 0.0}, tip_m}, own));
    }
  }
  return echo;
}

}  // namespace lookout::sim
