#include "lab/sim/shots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

constexpr std::uint64_t kShotStream = 3;

// A diffuse surface of this reflectance, square to the beam, is seen half of the time at Effects::half_seen_range_m (dark paint and rubber near
// 905 nm are lost at 20 to 30 m, bright hulls at 100 m).
constexpr double kHalfSeenReflectance = 0.4;
// Surfaces are rough within the beam: this share of the reflectance does not depend on the angle at which they are met.
constexpr double kRoughShare = 0.3;
constexpr double kDropoutWidth = 0.06;  // of the step from seen to not seen, as a share of the range

// Light that comes through foliage is halved on the way there and on the way back.
constexpr double kBehindFoliageShare = 0.25;

// Stray returns: most are near and all are faint.
constexpr double kStrayMinRangeM = 1.0;
constexpr double kStrayMaxRangeM = 40.0;

BeamWidth BeamWidthOf(const Effects& effects) { return {effects.horizontal_divergence_mrad() / 2000.0, effects.vertical_divergence_mrad() / 2000.0}; }

SceneObject OwnHullOf(const Effects& effects, const config::BoatFacts& boat, std::uint64_t seed) {
  SceneObject hull = MakeOwnHull(boat.own_vessel_box_m, boat.lidar.p_vessel_m.z(), boat.p_vessel_antenna_m);
  AddCrewAndGear(effects, boat.own_vessel_box_m, seed, hull);
  return hull;
}

}  // namespace

Shots::Shots(const Scene& scene, const config::BoatFacts& boat, const RangeFacts& facts, std::uint64_t seed)
    : facts_(facts),
      effects_(scene.effects),
      sea_(scene.sea),
      own_motion_(scene.own_motion),
      reference_point_above_water_m_(boat.reference_point_above_water_m),
      T_vessel_lidar_(boat.T_vessel_lidar),
      own_hull_{OwnHullOf(scene.effects, boat, seed)},
      own_caster_(own_hull_, BeamWidth{}, nullptr),
      beam_width_(BeamWidthOf(effects_)),
      caster_(scene.objects, beam_width_, &scene.sea),
      clutter_(scene, boat, seed),
      random_(seed, kShotStream) {
  own_caster_.MoveTo(0.0, T_vessel_lidar_.translation().head<2>());
}

// Draws the noise of range, then, where the range can be measured, the noise of reflectivity.
Measurement Shots::ToMeasurement(double range_m, double brightness, int object_id, ReturnReason reason) {
  const double range = std::round((range_m + facts_.noise * effects_.range_sd_m() * random_.Normal()) / facts_.unit_m);
  if (range < 1.0 || range > std::numeric_limits<std::uint16_t>::max()) return {};
  const double reflectivity = 100.0 * brightness + 2.0 * random_.Normal();
  // The manual, "Calibrated reflectivities": 0 to 100 of diffuse surfaces, 101 to 255 of retro-reflectors.
  const double greatest = brightness > 1.0 ? 255.0 : 100.0;
  return {
      static_cast<std::uint16_t>(range), static_cast<std::uint8_t>(std::clamp(std::round(reflectivity), 1.0, greatest)), object_id, reason, range_m,
      brightness / (range_m * range_m)};
}

Measurement Shots::Measure(const Echo& echo) {
  const double range_m = echo.hit.range_m;
  const double brightness = echo.share * echo.material.reflectance * (kRoughShare + (1.0 - kRoughShare) * echo.hit.incidence_cosine);
  const double half_seen_m = facts_.reach * effects_.half_seen_range_m() * std::sqrt(std::min(brightness / kHalfSeenReflectance, 1.0));
  const double seen = 1.0 / (1.0 + std::exp((range_m - half_seen_m) / (kDropoutWidth * half_seen_m)));
  if (range_m < facts_.min_m || random_.Uniform() >= seen) return {};
  return ToMeasurement(range_m, brightness, echo.object_id, echo.reason);
}

Measurement Shots::Stray(double max_range_m) {
  // The square brings most of them near.
  const double share = random_.Uniform();
  const double range_m = kStrayMinRangeM + (std::min(max_range_m, kStrayMaxRangeM) - kStrayMinRangeM) * share * share;
  const double reflectivity = random_.Uniform(1.0, 8.0);
  if (range_m < kStrayMinRangeM) return {};
  return {
      static_cast<std::uint16_t>(range_m / facts_.unit_m), static_cast<std::uint8_t>(reflectivity), kNoObject, ReturnReason::kStray, range_m, 0.0};
}

// Surfaces of objects and of the own boat, as far as the sea does not hide them.
Echoes Shots::Trace(const RayPair& ray, double max_range_m) {
  auto echoes = own_caster_.Cast(ray.vessel, max_range_m, false);
  if (echoes.count > 0) return echoes;
  const bool wants_second = effects_.return_mode() != config::Scene::STRONGEST;
  echoes = beam_width_.is_ray() ? caster_.Cast(ray.map, max_range_m, wants_second) : caster_.CastBeam(ray.map, max_range_m, wants_second);
  if (sea_.is_calm() || ray.map.direction.z() >= 0.0) return echoes;
  const double crest_m = sea_.max_height_m();
  const double from_m = std::max((crest_m - ray.map.origin_m.z()) / ray.map.direction.z(), 0.0);
  while (echoes.count > 0) {
    const double range_m = echoes.echo[static_cast<std::size_t>(echoes.count - 1)].hit.range_m;
    if (range_m <= from_m || !RangeToSea(sea_, ray.map, time_s_, from_m, range_m)) break;
    --echoes.count;
  }
  return echoes;
}

// A shot that meets nothing on its way into the water.
void Shots::TraceWater(const Ray& ray, double max_range_m, Seen& seen) {
  if (const auto echo = clutter_.FromWater(ray, max_range_m)) seen.Add(Measure(*echo));
  if (effects_.mirror_strength() > 0.0 && sea_.is_calm() && ray.direction.z() < 0.0) {
    // Mirrored at the water, the ray comes from the eye's image below it: its range is the length of the whole way.
    const Ray image{{ray.origin_m.x(), ray.origin_m.y(), -ray.origin_m.z()}, {ray.direction.x(), ray.direction.y(), -ray.direction.z()}};
    auto echoes = caster_.Cast(image, facts_.max_m, false);
    if (echoes.count == 0 || echoes.echo[0].hit.range_m <= -ray.origin_m.z() / ray.direction.z()) return;
    Echo& echo = echoes.echo[0];
    const double mirrored = effects_.mirror_strength() * FresnelReflectance(-ray.direction.z());
    echo.share = mirrored * mirrored;  // there and back
    echo.object_id = kNoObject;
    echo.reason = ReturnReason::kMirror;
    seen.Add(Measure(echo));
  }
}

// The manual, "Return modes": where the strongest return is also the last, dual return gives the second strongest beside it.
Shot Shots::Choose(const Seen& seen) const {
  if (seen.count == 0) return {};
  const Measurement* const begin = seen.measurement.data();
  const Measurement* const end = begin + seen.count;
  const Measurement* last = std::max_element(begin, end, [](const auto& a, const auto& b) { return a.true_range_m < b.true_range_m; });
  const Measurement* strongest = std::max_element(begin, end, [](const auto& a, const auto& b) { return a.power < b.power; });
  if (effects_.return_mode() == config::Scene::DUAL && strongest == last && seen.count > 1) {
    strongest = nullptr;
    for (const Measurement* other = begin; other != end; ++other) {
      if (other != last && (strongest == nullptr || other->power > strongest->power)) strongest = other;
    }
  }
  return {*strongest, *last};
}

void Shots::MoveTo(double time_s) {
  time_s_ = time_s;
  T_map_vessel_ = StateAt(own_motion_, reference_point_above_water_m_, time_s).T_map_vessel();
  caster_.MoveTo(time_s, (T_map_vessel_ * T_vessel_lidar_.translation()).head<2>());
  clutter_.MoveTo(time_s);
}

Shot Shots::Fire(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction) {
  const Ray vessel{T_vessel_lidar_ * origin_m, T_vessel_lidar_.linear() * direction};
  const RayPair ray{vessel, {T_map_vessel_ * vessel.origin_m, T_map_vessel_.linear() * vessel.direction}};
  // Beyond the deepest trough there is only water; calm water gives nothing back by itself.
  const double down = ray.map.direction.z();
  const double to_water_m = down < 0.0 ? -(ray.map.origin_m.z() + sea_.max_height_m()) / down : facts_.max_m;
  const double max_range_m = std::clamp(to_water_m, 0.0, facts_.max_m);
  Echoes echoes = Trace(ray, max_range_m);
  Seen seen;
  const bool meets_own = echoes.count > 0 && echoes.echo[0].reason == ReturnReason::kOwnVessel;
  if (!meets_own) {
    if (const auto before = clutter_.FromBreakersAndBirds(ray.map, echoes.count > 0 ? echoes.echo[0].hit.range_m : max_range_m)) {
      echoes.count = 1;
      echoes.echo[0] = *before;
    }
  }
  for (int i = 0; i < echoes.count; ++i) {
    const Echo& echo = echoes.echo[static_cast<std::size_t>(i)];
    // Half of the shots into foliage give a second return behind it.
    if (echo.is_behind_foliage && random_.Uniform() >= 0.5) continue;
    Measurement measured = Measure(echo);
    if (echo.is_behind_foliage)
      measured.power = std::min(measured.power * kBehindFoliageShare, seen.count > 0 ? seen.measurement[0].power : 1.0) / 2.0;
    seen.Add(measured);
  }
  if (echoes.count == 0) TraceWater(ray.map, max_range_m, seen);
  if (const auto drop = clutter_.FromDrops(ray.vessel, echoes.count > 0 ? echoes.echo[0].hit.range_m : max_range_m)) {
    // A drop is either large and near enough or not: no range at which it is seen half of the time.
    const Measurement measured = ToMeasurement(drop->hit.range_m, drop->material.reflectance, kNoObject, drop->reason);
    if (measured.range == 0) random_.Normal();  // noise of reflectivity: each drop draws both noises, so that a seed gives equal data at any range
    seen.Add(measured);
  }
  if (const auto drop = clutter_.FromClouds(ray.map, ray.vessel, echoes.count > 0 ? echoes.echo[0].hit.range_m : max_range_m)) {
    seen.Add(ToMeasurement(drop->hit.range_m, drop->material.reflectance, kNoObject, drop->reason));
  }
  // Only where nothing was met: a stray takes no return from an object.
  if (echoes.count == 0 && seen.count == 0 && random_.Uniform() < effects_.stray_probability()) {
    const Measurement stray = Stray(max_range_m);
    return {stray, stray};
  }
  return Choose(seen);
}

}  // namespace lookout::sim
