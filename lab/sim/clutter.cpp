#include "lab/sim/clutter.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/foam.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kClutterStream = 6;

// Hale and Querry, "Optical constants of water in the 200-nm to 200-um wavelength region", Applied Optics 12, 1973: 1.328 at 0.9 um.
constexpr double kRefractiveIndex = 1.328;

// Share of light that comes back out of clear water near the surface: some per cent.
constexpr double kWaterReflectance = 0.03;

// Incidence for which Effects::glint_probability is said: the lowest beam, 15 deg below level.
constexpr double kGlintSine = 0.25881904510252074;

// The half-way of the beam's growth: 12.7 mm wide where it leaves the head, it has doubled after 4.2 m at 3 mrad; rounded up for its height.
// A drop farther away takes a smaller share of the light, and its echo falls with the square of the range on top, while the number of drops in the
// beam grows with its section: together about as 1 / (1 + (range / kDropRangeM)^2).
constexpr double kDropRangeM = 5.0;
constexpr double kFirstDropM = 0.5;

// Kelvin's wedge: asin(1 / 3) to either side on deep water (Lamb, "Hydrodynamics", article 256).
constexpr double kKelvinTangent = 0.35355339059327379;
// Chance of a return from the fresh patch of a wave that broke: the patch is flat, so it is seldom seen, but stays at one place for seconds.
constexpr double kPatchProbability = 0.3;
constexpr double kArmHalfWidthM = 0.35;
constexpr double kStripSpreadMps = 0.1;  // of the strip of foam behind the stern, to either side
constexpr double kMinWakeSpeedMps = 0.8;

// Drops rise where the bow falls into the water: to both sides of it, as high as the lidar of a small boat.
constexpr double kFullSprayMps = 0.5;
const Vector3d kSprayRadiiM(1.4, 0.8, 1.0);
constexpr double kSprayAheadM = 0.6;   // of the bow
constexpr double kSprayAsideM = 0.5;   // of the side
constexpr double kSprayHeightM = 0.6;  // over the water

// No wave is steeper than Stokes' highest one: 30 deg at its crest.
constexpr double kSteepestSine = 0.5;
constexpr double kSteepestCosine = 0.86602540378443865;

constexpr double kSeaStepM = 0.4;  // a seventh of the shortest waves of a scene
constexpr int kSeaHalvings = 7;    // of a step: 3 mm

}  // namespace

std::optional<double> RangeToSea(const Sea& sea, const Ray& ray, double time_s, double from_m, double to_m) {
  const auto above_m = [&](double range_m) {
    const Vector3d p_m = ray.origin_m + range_m * ray.direction;
    return p_m.z() - sea.HeightM(p_m.head<2>(), time_s);
  };
  double dry_m = from_m;
  while (dry_m < to_m) {
    const double next_m = std::min(dry_m + kSeaStepM, to_m);
    if (above_m(next_m) > 0.0) {
      dry_m = next_m;
      continue;
    }
    double wet_m = next_m;
    for (int i = 0; i < kSeaHalvings; ++i) {
      const double middle_m = (dry_m + wet_m) / 2.0;
      (above_m(middle_m) > 0.0 ? dry_m : wet_m) = middle_m;
    }
    return (dry_m + wet_m) / 2.0;
  }
  return std::nullopt;
}

double FresnelReflectance(double sine) {
  const double cosine_in = std::clamp(sine, 0.0, 1.0);
  const double sine_out = std::sqrt(1.0 - cosine_in * cosine_in) / kRefractiveIndex;
  const double cosine_out = std::sqrt(1.0 - sine_out * sine_out);
  const double across = (cosine_in - kRefractiveIndex * cosine_out) / (cosine_in + kRefractiveIndex * cosine_out);
  const double along = (kRefractiveIndex * cosine_in - cosine_out) / (kRefractiveIndex * cosine_in + cosine_out);
  return (across * across + along * along) / 2.0;
}

Clutter::Clutter(const Scene& scene, const config::BoatFacts& boat, std::uint64_t seed)
    : scene_(scene),
      effects_(scene.effects),
      reference_point_above_water_m_(boat.reference_point_above_water_m),
      own_box_m_(boat.own_vessel_box_m),
      has_water_(effects_.glint_probability() > 0.0 || effects_.wake_probability() > 0.0 || effects_.breakers_per_hectare() > 0.0 ||
                 (effects_.crest_probability() > 0.0 && !scene.sea.is_calm())),
      random_(seed, kClutterStream),
      breakers_(effects_.breakers_per_hectare(), scene.sea, seed),
      birds_(effects_.flying_birds(), seed),
      clouds_(scene, boat, seed) {
  if (effects_.wake_probability() <= 0.0) return;
  sources_.push_back({{}, true, own_box_m_.min().x(), own_box_m_.sizes().y() / 2.0});
  for (const auto& object : scene.objects) {
    if (!object.track.is_moving() || !object.is_in_water) continue;
    Eigen::AlignedBox2d plan_m;
    for (const auto& p_m : object.outline_m) plan_m.extend(p_m);
    if (!plan_m.isEmpty()) sources_.push_back({object.track, false, plan_m.min().x(), plan_m.sizes().y() / 2.0});
  }
}

Clutter::Wake Clutter::WakeOf(const Source& source, double time_s) const {
  constexpr double kWakeStepS = 0.1;
  if (source.is_own) {
    const OwnState state = StateAt(scene_.own_motion, reference_point_above_water_m_, time_s);
    const double speed_mps = state.velocity_map_mps.norm();
    const Vector2d ahead = speed_mps > 0.0 ? Vector2d(state.velocity_map_mps / speed_mps) : Vector2d::UnitX();
    return {state.position_map_m.head<2>() + source.stern_m * ahead, ahead, speed_mps, source.half_width_m};
  }
  // By its places: a track may turn, and end.
  const Placement placement = source.track.At(time_s);
  const Vector2d way_m = placement.position_map_m - source.track.At(time_s - kWakeStepS).position_map_m;
  const Vector2d ahead(std::sin(placement.heading_rad), std::cos(placement.heading_rad));
  return {placement.position_map_m + source.stern_m * ahead, ahead, way_m.norm() / kWakeStepS, source.half_width_m};
}

void Clutter::MoveTo(double time_s) {
  time_s_ = time_s;
  if (std::abs(time_s - moved_at_s_) < kPeriodS) return;
  moved_at_s_ = time_s;
  const Vector2d own_m = StateAt(scene_.own_motion, reference_point_above_water_m_, time_s).position_map_m.head<2>();
  breakers_.MoveTo(time_s, own_m);
  birds_.MoveTo(time_s, own_m);
  clouds_.MoveTo(time_s);
  wakes_.clear();
  for (const auto& source : sources_) {
    const Wake wake = WakeOf(source, time_s);
    if (wake.speed_mps >= kMinWakeSpeedMps) wakes_.push_back(wake);
  }
  if (effects_.spray_probability() > 0.0) {
    const auto bow_height_m = [this](double at_s) {
      const OwnState state = StateAt(scene_.own_motion, reference_point_above_water_m_, at_s);
      return state.position_map_m.z() + own_box_m_.max().x() * std::sin(state.pitch_rad);
    };
    const double fall_mps = (bow_height_m(time_s - kPeriodS) - bow_height_m(time_s)) / kPeriodS;
    spray_ = std::clamp(fall_mps / kFullSprayMps, 0.0, 1.0);
  }
}

// Share of fresh foam at a place, 0 to 1: a strip behind the stern, and the two arms of a wedge.
double Clutter::FoamAt(const Vector2d& p_map_m) const {
  double most = 0.0;
  for (const Wake& wake : wakes_) {
    const Vector2d from_stern_m = p_map_m - wake.stern_map_m;
    const double behind_m = -from_stern_m.dot(wake.ahead);
    const double age_s = behind_m / wake.speed_mps;
    if (age_s < 0.0 || age_s > kFoamEndsS) continue;
    const double aside_m = std::abs(from_stern_m.x() * wake.ahead.y() - from_stern_m.y() * wake.ahead.x());
    const bool is_on_strip = aside_m < wake.half_width_m + kStripSpreadMps * age_s;
    const bool is_on_arm = std::abs(aside_m - wake.half_width_m - kKelvinTangent * behind_m) < kArmHalfWidthM;
    if (is_on_strip || is_on_arm) most = std::max(most, std::exp(-age_s / kFoamFadesS));
  }
  return most;
}

std::optional<Echo> Clutter::FromWater(const Ray& ray, double max_range_m) {
  if (!has_water_ || ray.direction.z() >= 0.0) return std::nullopt;
  const double draw = random_.Uniform();
  const bool is_calm = scene_.sea.is_calm();
  const double sine_calm = -ray.direction.z();
  const auto glint = [this](double sine) { return std::min(effects_.glint_probability() * sine * sine / (kGlintSine * kGlintSine), 1.0); };
  // Most shots give nothing whatever they meet: the sea need not be looked for.
  const double most_of_foam = (wakes_.empty() ? 0.0 : effects_.wake_probability()) + (is_calm ? 0.0 : effects_.crest_probability()) +
                              (breakers_.is_off() ? 0.0 : kPatchProbability);
  const double sine_on_steepest = sine_calm * kSteepestCosine + std::sqrt(std::max(0.0, 1.0 - sine_calm * sine_calm)) * kSteepestSine;
  const double most_of_glint = glint(is_calm ? sine_calm : sine_on_steepest);
  if (draw >= most_of_foam + most_of_glint) return std::nullopt;

  std::optional<double> range_m;
  if (is_calm) {
    range_m = -ray.origin_m.z() / ray.direction.z();
    if (*range_m > max_range_m || *range_m <= 0.0) return std::nullopt;
  } else {
    const double crest_m = scene_.sea.max_height_m();
    const double from_m = std::max((crest_m - ray.origin_m.z()) / ray.direction.z(), 0.0);
    const double to_m = std::min((-crest_m - ray.origin_m.z()) / ray.direction.z(), max_range_m);
    range_m = RangeToSea(scene_.sea, ray, time_s_, from_m, to_m);
    if (!range_m) return std::nullopt;
  }
  const Vector3d p_m = ray.origin_m + *range_m * ray.direction;
  double sine = sine_calm;
  double height_m = 0.0;
  if (!is_calm) {
    const Vector2d slope = scene_.sea.Slope(p_m.head<2>(), time_s_);
    sine = std::max(-ray.direction.dot(Vector3d(-slope.x(), -slope.y(), 1.0).normalized()), 0.0);
    height_m = p_m.z();
  }
  double sum = effects_.wake_probability() * FoamAt(p_m.head<2>());
  if (draw < sum) return Echo{{*range_m, sine}, kNoObject, {kFoamReflectance}, ReturnReason::kWake};
  if (height_m > 0.0) sum += effects_.crest_probability() * sine;
  if (!breakers_.is_off()) sum += kPatchProbability * breakers_.FoamAt(p_m.head<2>());
  if (draw < sum) return Echo{{*range_m, sine}, kNoObject, {kFoamReflectance}, ReturnReason::kCrest};
  sum += glint(sine);
  if (draw < sum) return Echo{{*range_m, sine}, kNoObject, {kWaterReflectance}, ReturnReason::kGlint};
  return std::nullopt;
}

std::optional<Echo> Clutter::FromBreakersAndBirds(const Ray& ray, double max_range_m) {
  const auto bird = birds_.FirstEcho(ray, max_range_m);
  const auto breaker = breakers_.FirstEcho(ray, bird ? bird->hit.range_m : max_range_m);
  return breaker ? breaker : bird;
}

// Range of the first drop: the way to it is distributed exponentially in the drops that are met on the way.
std::optional<double> Clutter::RainRange(double max_range_m) {
  const double per_m = effects_.rain_probability_per_m();
  if (per_m <= 0.0) return std::nullopt;
  const double draw = random_.Uniform();
  const double first = std::atan(kFirstDropM / kDropRangeM);
  const double drops_at_most = per_m * kDropRangeM * (kPi / 2.0 - first);
  if (draw >= drops_at_most) return std::nullopt;  // 1 - exp(-x) is less than x
  const double way = -std::log1p(-draw) / (per_m * kDropRangeM) + first;
  if (way >= kPi / 2.0) return std::nullopt;
  const double range_m = kDropRangeM * std::tan(way);
  if (range_m >= max_range_m) return std::nullopt;
  return range_m;
}

// Somewhere on the ray's way through one of the two clouds.
std::optional<double> Clutter::SprayRange(const Ray& ray_vessel, double max_range_m) {
  const double probability = effects_.spray_probability() * spray_;
  if (probability <= 0.0) return std::nullopt;
  const double draw = random_.Uniform();
  if (draw >= probability) return std::nullopt;
  const double place = random_.Uniform();
  const double height_m = kSprayHeightM - reference_point_above_water_m_;
  for (const double side : {1.0, -1.0}) {
    const Vector3d center_m(own_box_m_.max().x() + kSprayAheadM, side * (own_box_m_.sizes().y() / 2.0 + kSprayAsideM), height_m);
    const Vector3d direction = ray_vessel.direction.cwiseQuotient(kSprayRadiiM);
    const Vector3d from = (ray_vessel.origin_m - center_m).cwiseQuotient(kSprayRadiiM);
    const double a = direction.squaredNorm();
    const double b = direction.dot(from);
    const double discriminant = b * b - a * (from.squaredNorm() - 1.0);
    if (discriminant <= 0.0) continue;
    const double enter_m = std::max((-b - std::sqrt(discriminant)) / a, kFirstDropM);
    const double leave_m = (-b + std::sqrt(discriminant)) / a;
    const double range_m = enter_m + place * (leave_m - enter_m);
    if (leave_m > enter_m && range_m < max_range_m) return range_m;
  }
  return std::nullopt;
}

std::optional<Echo> Clutter::FromDrops(const Ray& ray_vessel, double max_range_m) {
  const auto spray_m = SprayRange(ray_vessel, max_range_m);
  const auto rain_m = RainRange(spray_m.value_or(max_range_m));
  if (rain_m) return Echo{{*rain_m, 1.0}, kNoObject, {kDropReflectance}, ReturnReason::kRain};
  if (spray_m) return Echo{{*spray_m, 1.0}, kNoObject, {kDropReflectance}, ReturnReason::kSpray};
  return std::nullopt;
}

}  // namespace lookout::sim
