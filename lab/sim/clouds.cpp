#include "lab/sim/clouds.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/foam.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kCloudShotStream = 23;
constexpr std::uint64_t kPlumeStream = 24;

constexpr double kNearestM = 0.5;

// Churn: a hull that displaces its water quietly throws up nothing; above, the amount grows up to the speed of planing.
constexpr double kQuietMps = 1.2;
constexpr double kFullMps = 5.0;
constexpr double kChurnPeriodS = 1.1;  // puffs, as waves come

// Plumes: born by the second.
constexpr double kGreatestPlumeS = 1.8;

}  // namespace

Clouds::Clouds(const Scene& scene, const config::BoatFacts& boat, std::uint64_t seed)
    : scene_(scene),
      effects_(scene.effects),
      own_box_m_(boat.own_vessel_box_m),
      reference_point_above_water_m_(boat.reference_point_above_water_m),
      seed_(seed),
      random_(seed, kCloudShotStream),
      is_off_(effects_.churn_probability_per_m() <= 0.0 && effects_.plumes_per_minute() <= 0.0 && effects_.fog_probability() <= 0.0) {}

// A heap of foam that begins at the stern, and a sheet of drops at each side of the bow; the own bow has Effects::spray_probability and plumes.
void Clouds::AddChurn(const Mover& boat) {
  if (boat.speed_mps < kQuietMps) return;
  const double puff = 0.6 + 0.4 * std::sin(kTwoPi * time_s_ / kChurnPeriodS + boat.phase_rad);
  const double share = std::min((boat.speed_mps - kQuietMps) / (kFullMps - kQuietMps), 1.0);
  const double density_per_m = effects_.churn_probability_per_m() * (0.3 + 0.7 * share) * puff;
  const Vector2d ahead(std::sin(boat.placement.heading_rad), std::cos(boat.placement.heading_rad));
  const auto add = [&](double x_m, double y_m, const Vector3d& radii_m, ReturnReason reason) {
    const Vector2d p_m = boat.placement.ToMap({x_m, y_m});
    on_map_.push_back({{p_m.x(), p_m.y(), scene_.sea.HeightM(p_m, time_s_)}, radii_m, ahead, density_per_m, reason});
  };
  const double heap_m = 0.4 + 2.2 * share;
  add(boat.stern_m - 0.8 * heap_m, 0.0, {heap_m, 0.8 * boat.half_width_m + 0.2, 0.1 + 0.45 * share * puff}, ReturnReason::kWake);
  if (boat.is_own) return;
  const double sheet_m = 0.25 * (boat.bow_m - boat.stern_m);
  for (const double side : {-1.0, 1.0}) {
    const double y_m = side * (0.75 * boat.half_width_m + 0.25);
    add(boat.bow_m - 0.9 * sheet_m, y_m, {sheet_m, 0.2 + 0.5 * share, 0.1 + 0.5 * share * puff}, ReturnReason::kSpray);
  }
}

// Thrown up beside the bow, blown aft over the boat while it grows thin.
void Clouds::AddPlumes() {
  const double per_s = effects_.plumes_per_minute() / 60.0;
  const auto now = static_cast<std::int64_t>(std::floor(time_s_));
  const auto back = static_cast<std::int64_t>(kGreatestPlumeS) + 1;
  for (std::int64_t second = now - back; second <= now; ++second) {
    Random random(seed_, kPlumeStream << 48 | (static_cast<std::uint64_t>(second) & 0xFFFFFFFF));
    const int count = static_cast<int>(per_s + random.Uniform());
    for (int i = 0; i < count; ++i) {
      const double age_s = time_s_ - (static_cast<double>(second) + random.Uniform());
      const double life_s = random.Uniform(0.7, kGreatestPlumeS);
      const double side = random.Uniform(-1.0, 1.0);
      const double top_m = random.Uniform(0.5, 2.5);
      const double drift_mps = random.Uniform(0.5, 4.0);
      const double size_m = random.Uniform(0.3, 1.2);
      const double density_per_m = random.Uniform(0.05, 0.9);
      if (age_s < 0.0 || age_s > life_s) continue;
      const double share = age_s / life_s;
      const double grown_m = size_m * (0.4 + 0.8 * share);
      const Vector3d center_m(own_box_m_.max().x() + 0.5 - drift_mps * age_s, side * (own_box_m_.max().y() + 0.5),
                              -reference_point_above_water_m_ + 4.0 * top_m * share * (1.0 - share));
      on_vessel_.push_back({center_m, {1.3 * grown_m, grown_m, grown_m}, Vector2d::UnitX(), density_per_m * (1.0 - share), ReturnReason::kSpray});
    }
  }
}

void Clouds::MoveTo(double time_s) {
  if (is_off_) return;
  constexpr double kStepS = 0.1;
  time_s_ = time_s;
  on_map_.clear();
  on_vessel_.clear();
  if (effects_.plumes_per_minute() > 0.0) AddPlumes();
  if (effects_.churn_probability_per_m() <= 0.0) return;
  const OwnState own = StateAt(scene_.own_motion, reference_point_above_water_m_, time_s);
  AddChurn({{own.position_map_m.head<2>(), own.heading_rad},
            own.velocity_map_mps.norm(),
            own_box_m_.min().x(),
            own_box_m_.max().x(),
            own_box_m_.sizes().y() / 2.0,
            true,
            0.0});
  for (const auto& object : scene_.objects) {
    if (!object.track.is_moving() || !object.is_afloat()) continue;
    const Placement placement = object.track.At(time_s);
    const double speed_mps = (placement.position_map_m - object.track.At(time_s - kStepS).position_map_m).norm() / kStepS;
    const Vector2d half_m = object.waterline_m / 2.0;
    AddChurn({placement, speed_mps, -half_m.x(), half_m.x(), half_m.y(), false, static_cast<double>(object.id)});
  }
}

std::optional<double> Clouds::RangeInto(const Cloud& cloud, const Ray& ray, double max_range_m) {
  const auto scaled = [&cloud](const Vector3d& v) {
    return Vector3d(cloud.ahead.x() * v.x() + cloud.ahead.y() * v.y(), cloud.ahead.x() * v.y() - cloud.ahead.y() * v.x(), v.z())
        .cwiseQuotient(cloud.radii_m)
        .eval();
  };
  const Vector3d direction = scaled(ray.direction);
  const Vector3d from = scaled(ray.origin_m - cloud.center_m);
  const double a = direction.squaredNorm();
  const double b = direction.dot(from);
  const double discriminant = b * b - a * (from.squaredNorm() - 1.0);
  if (discriminant <= 0.0) return std::nullopt;
  const double root = std::sqrt(discriminant);
  const double leave_m = std::min((-b + root) / a, max_range_m);
  const double enter_m = std::max((-b - root) / a, kNearestM);
  if (enter_m >= leave_m) return std::nullopt;
  // The way to the first drop is distributed exponentially.
  const double range_m = enter_m - std::log1p(-random_.Uniform()) / cloud.density_per_m;
  if (range_m >= leave_m) return std::nullopt;
  return range_m;
}

// Banks that drift: the chance swings with bearing, height of the beam and time. Ranges are distributed as a sum of three exponential ways: few at
// the lens, most at about two thirds of the mean, with a tail to three times the mean.
std::optional<double> Clouds::FogRange(const Ray& ray_map, double max_range_m) {
  const double draw = random_.Uniform();
  if (draw >= effects_.fog_probability()) return std::nullopt;
  const double bearing_rad = std::atan2(ray_map.direction.y(), ray_map.direction.x());
  const double thickness = 0.55 + 0.25 * std::sin(2.0 * bearing_rad + 0.3 * time_s_) + 0.2 * std::sin(5.0 * bearing_rad - 0.5 * time_s_ + 1.0) -
                           1.5 * ray_map.direction.z();
  const double ways[] = {random_.Uniform(), random_.Uniform(), random_.Uniform()};
  if (draw >= effects_.fog_probability() * thickness) return std::nullopt;
  double range_m = kNearestM;
  for (const double way : ways) range_m -= std::log1p(-way) * (effects_.fog_range_m() - kNearestM) / 3.0;
  if (range_m >= max_range_m) return std::nullopt;
  return range_m;
}

std::optional<Echo> Clouds::FirstEcho(const Ray& ray_map, const Ray& ray_vessel, double max_range_m) {
  if (is_off_) return std::nullopt;
  std::optional<Echo> echo;
  const auto consider = [&](std::optional<double> range_m, double reflectance, ReturnReason reason) {
    if (!range_m || (echo && *range_m >= echo->hit.range_m)) return;
    echo = Echo{{*range_m, 1.0}, kNoObject, {reflectance}, reason};
  };
  for (const Cloud& cloud : on_map_) consider(RangeInto(cloud, ray_map, max_range_m), kFoamReflectance, cloud.reason);
  for (const Cloud& cloud : on_vessel_) consider(RangeInto(cloud, ray_vessel, max_range_m), kDropReflectance, cloud.reason);
  if (effects_.fog_probability() > 0.0) consider(FogRange(ray_map, max_range_m), kDropReflectance, ReturnReason::kFog);
  return echo;
}

}  // namespace lookout::sim
