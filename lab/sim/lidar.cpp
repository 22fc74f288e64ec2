#include "lab/sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "common/core/angles.hpp"
#include "common/core/bytes.hpp"
#include "common/core/frames.hpp"

namespace lookout::sim {
namespace {

namespace format = vlp16::format;

constexpr std::uint64_t kRotorStream = 2;
constexpr std::uint64_t kShotStream = 3;

// VLP-16 data sheet 63-9229: range up to 100 m; nothing is given nearer than about 0.4 m.
constexpr double kMinRangeM = 0.4;
constexpr double kMaxRangeM = 110.0;
// A diffuse surface of this reflectance, square to the beam, is seen half of the time at Effects::half_seen_range_m (dark paint and rubber near
// 905 nm are lost at 20 to 30 m, bright hulls at 100 m).
constexpr double kHalfSeenReflectance = 0.4;
// Surfaces are rough within the beam: this share of the reflectance does not depend on the angle at which they are met.
constexpr double kRoughShare = 0.3;
constexpr double kDropoutWidth = 0.06;  // of the step from seen to not seen, as a share of the range

// What comes through foliage has been shaded twice by its half.
constexpr double kBehindFoliageShare = 0.25;

// Strays: most of them near and all of them faint.
constexpr double kStrayMinRangeM = 1.0;
constexpr double kStrayMaxRangeM = 40.0;

BeamWidth BeamWidthOf(const Effects& effects) { return {effects.horizontal_divergence_mrad() / 2000.0, effects.vertical_divergence_mrad() / 2000.0}; }

std::uint32_t MicrosecondsPastHour(Utime time) {
  return static_cast<std::uint32_t>((time - std::chrono::floor<std::chrono::hours>(time)) / std::chrono::microseconds(1));
}

SceneObject OwnHullOf(const Effects& effects, const config::BoatFacts& boat, std::uint64_t seed) {
  SceneObject hull = MakeOwnHull(boat.own_vessel_box_m, boat.lidar.p_vessel_m.z(), boat.p_vessel_antenna_m);
  AddCrewAndGear(effects, boat.own_vessel_box_m, seed, hull);
  return hull;
}

void WriteReturn(std::span<std::uint8_t> payload, int block, int sequence, std::size_t laser, std::uint16_t range_2mm, std::uint8_t reflectivity) {
  const std::size_t offset = static_cast<std::size_t>(block) * format::kBlockSizeBytes + format::kBlockReturnsOffset +
                             (static_cast<std::size_t>(sequence) * format::kNumLasers + laser) * format::kReturnSizeBytes;
  WriteU16LittleEndian(payload, offset, range_2mm);
  payload[offset + 2] = reflectivity;
}

}  // namespace

Lidar::Lidar(const Scene& scene, const config::BoatFacts& boat, const LidarParams& params, Utime start, std::uint64_t seed)
    : params_(params),
      effects_(scene.effects),
      sea_(scene.sea),
      beams_(vlp16::BeamsOf(params.model)),
      own_motion_(scene.own_motion),
      reference_point_above_water_m_(boat.reference_point_above_water_m),
      T_vessel_lidar_(boat.T_vessel_lidar),
      own_hull_{OwnHullOf(scene.effects, boat, seed)},
      own_caster_(own_hull_, BeamWidth{}, nullptr),
      beam_width_(BeamWidthOf(effects_)),
      caster_(scene.objects, beam_width_, &scene.sea),
      clutter_(scene, boat, seed),
      random_(seed, kShotStream),
      start_(start) {
  Random random(seed, kRotorStream);
  rotor_phase_rad_ = random.Uniform(0.0, kTwoPi);
  // Captures of real sensors show 601 to 607 rpm where 600 were asked for, and some hundredths of a degree of wander within a revolution.
  rotor_rate_radps_ = params.rotation_rpm / 60.0 * kTwoPi * (1.0 + 0.001 * random.Normal());
  for (const double amplitude_deg : {0.10, 0.04, 0.02}) {
    const double period_s = random.Uniform(0.3, 1.0) * amplitude_deg * 10.0;
    rotor_rad_.push_back({DegToRad(amplitude_deg), period_s, random.Uniform(0.0, kTwoPi)});
  }
  own_caster_.MoveTo(0.0, T_vessel_lidar_.translation().head<2>());
}

double Lidar::AzimuthAt(double time_s) const {
  double azimuth_rad = rotor_phase_rad_ + rotor_rate_radps_ * time_s;
  for (const auto& wave : rotor_rad_) azimuth_rad += wave.amplitude * std::sin(kTwoPi * time_s / wave.period_s + wave.phase_rad);
  return azimuth_rad;
}

// Draws the noise of range, then, where the range can be measured, that of reflectivity.
Lidar::Measurement Lidar::ToMeasurement(double range_m, double brightness, int object_id, ReturnReason reason) {
  const double range_2mm = std::round((range_m + effects_.range_sd_m() * random_.Normal()) / format::kRangeUnitM);
  if (range_2mm < 1.0 || range_2mm > std::numeric_limits<std::uint16_t>::max()) return {};
  const double reflectivity = 100.0 * brightness + 2.0 * random_.Normal();
  // The manual, "Calibrated reflectivities": 0 to 100 of diffuse surfaces, 101 to 255 of retro-reflectors.
  const double greatest = brightness > 1.0 ? 255.0 : 100.0;
  return {static_cast<std::uint16_t>(range_2mm),
          static_cast<std::uint8_t>(std::clamp(std::round(reflectivity), 1.0, greatest)),
          object_id,
          reason,
          range_m,
          brightness / (range_m * range_m)};
}

Lidar::Measurement Lidar::Measure(const Echo& echo) {
  const double range_m = echo.hit.range_m;
  const double brightness = echo.share * echo.material.reflectance * (kRoughShare + (1.0 - kRoughShare) * echo.hit.incidence_cosine);
  const double half_seen_m = effects_.half_seen_range_m() * std::sqrt(std::min(brightness / kHalfSeenReflectance, 1.0));
  const double seen = 1.0 / (1.0 + std::exp((range_m - half_seen_m) / (kDropoutWidth * half_seen_m)));
  if (range_m < kMinRangeM || random_.Uniform() >= seen) return {};
  return ToMeasurement(range_m, brightness, echo.object_id, echo.reason);
}

Lidar::Measurement Lidar::Stray(double max_range_m) {
  // The square brings most of them near.
  const double share = random_.Uniform();
  const double range_m = kStrayMinRangeM + (std::min(max_range_m, kStrayMaxRangeM) - kStrayMinRangeM) * share * share;
  const double reflectivity = random_.Uniform(1.0, 8.0);
  if (range_m < kStrayMinRangeM) return {};
  return {static_cast<std::uint16_t>(range_m / format::kRangeUnitM),
          static_cast<std::uint8_t>(reflectivity),
          kNoObject,
          ReturnReason::kStray,
          range_m,
          0.0};
}

Lidar::RayPair Lidar::RayOf(double origin_height_m, double azimuth_rad, double elevation_rad, const Eigen::Isometry3d& T_map_vessel) const {
  const Ray vessel{T_vessel_lidar_ * Eigen::Vector3d(0.0, 0.0, origin_height_m),
                   T_vessel_lidar_.linear() * BeamDirection(azimuth_rad, elevation_rad)};
  return {vessel, {T_map_vessel * vessel.origin_m, T_map_vessel.linear() * vessel.direction}};
}

// Surfaces of objects and of the own boat, as far as the sea does not hide them.
Echoes Lidar::Trace(const RayPair& ray, double max_range_m, double time_s) {
  auto echoes = own_caster_.Cast(ray.vessel, max_range_m, false);
  if (echoes.count > 0) return echoes;
  const bool wants_second = effects_.return_mode() != config::Scene::STRONGEST;
  echoes = beam_width_.is_ray() ? caster_.Cast(ray.map, max_range_m, wants_second) : caster_.CastBeam(ray.map, max_range_m, wants_second);
  if (sea_.is_calm() || ray.map.direction.z() >= 0.0) return echoes;
  const double crest_m = sea_.max_height_m();
  const double from_m = std::max((crest_m - ray.map.origin_m.z()) / ray.map.direction.z(), 0.0);
  while (echoes.count > 0) {
    const double range_m = echoes.echo[static_cast<std::size_t>(echoes.count - 1)].hit.range_m;
    if (range_m <= from_m || !RangeToSea(sea_, ray.map, time_s, from_m, range_m)) break;
    --echoes.count;
  }
  return echoes;
}

// A shot that meets nothing on its way into the water.
void Lidar::TraceWater(const Ray& ray, double max_range_m, Seen& seen) {
  if (const auto echo = clutter_.FromWater(ray, max_range_m)) seen.Add(Measure(*echo));
  if (effects_.mirror_strength() > 0.0 && sea_.is_calm() && ray.direction.z() < 0.0) {
    // Mirrored at the water, the ray comes from the eye's image below it: its range is that of the whole way.
    const Ray image{{ray.origin_m.x(), ray.origin_m.y(), -ray.origin_m.z()}, {ray.direction.x(), ray.direction.y(), -ray.direction.z()}};
    auto echoes = caster_.Cast(image, kMaxRangeM, false);
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
Lidar::Shot Lidar::Choose(const Seen& seen) const {
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

Lidar::Shot Lidar::Fire(const RayPair& ray, double time_s) {
  // Beyond the deepest trough there is only water; calm water gives nothing back by itself.
  const double down = ray.map.direction.z();
  const double to_water_m = down < 0.0 ? -(ray.map.origin_m.z() + sea_.max_height_m()) / down : kMaxRangeM;
  const double max_range_m = std::clamp(to_water_m, 0.0, kMaxRangeM);
  Echoes echoes = Trace(ray, max_range_m, time_s);
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
    if (measured.range_2mm == 0) random_.Normal();  // of its reflectivity: each drop draws both, so that the seed gives the same data at any range
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

// Whether a block that begins with this sequence lies in the field of view as a whole, first shot to last.
bool Lidar::FiresFrom(std::int64_t sequence) const {
  const auto begin = sequence * format::kSequencePeriod;
  return params_.field_of_view.Contains(AzimuthAt(ToSeconds(begin))) &&
         params_.field_of_view.Contains(AzimuthAt(ToSeconds(begin + format::kBlockPeriod - format::kRechargeTime - format::kLaserPeriod)));
}

LidarPacket Lidar::Next() {
  using std::chrono::nanoseconds;
  const bool is_dual = effects_.return_mode() == config::Scene::DUAL;
  LidarPacket packet;
  const std::span<std::uint8_t> payload(packet.payload);
  const auto skip_to_field_of_view = [this] {
    while (!FiresFrom(next_sequence_)) ++next_sequence_;
  };
  skip_to_field_of_view();
  const nanoseconds first = next_sequence_ * format::kSequencePeriod;
  const Utime stamp = start_ + std::chrono::floor<std::chrono::microseconds>(first);
  packet.stamp = stamp;
  const int num_sequences = is_dual ? format::kSequencesPerPacketDual : format::kSequencesPerPacketSingle;

  for (int k = 0; k < num_sequences; ++k, ++next_sequence_) {
    const int block = is_dual ? k / format::kSequencesPerBlock * 2 : k / format::kSequencesPerBlock;
    const int sequence = k % format::kSequencesPerBlock;
    if (sequence == 0) skip_to_field_of_view();
    const nanoseconds sequence_time = next_sequence_ * format::kSequencePeriod;
    // One pose for the 37 us of a sequence: the boat moves by 0.1 mm in it.
    const double time_s = ToSeconds(sequence_time);
    const auto T_map_vessel = StateAt(own_motion_, reference_point_above_water_m_, time_s).T_map_vessel();
    caster_.MoveTo(time_s, (T_map_vessel * T_vessel_lidar_.translation()).head<2>());
    clutter_.MoveTo(time_s);

    if (sequence == 0) {
      const auto azimuth_cdeg =
          static_cast<std::uint16_t>(std::lround(RadToDeg(WrapTo2Pi(AzimuthAt(time_s))) * 100.0) % format::kAzimuthsPerRevolution);
      for (int i = 0; i < (is_dual ? 2 : 1); ++i) {
        const std::size_t offset = static_cast<std::size_t>(block + i) * format::kBlockSizeBytes;
        WriteU16LittleEndian(payload, offset + format::kBlockFlagOffset, format::kBlockFlag);
        WriteU16LittleEndian(payload, offset + format::kBlockAzimuthOffset, azimuth_cdeg);
      }
    }
    const double azimuth_rad = AzimuthAt(time_s);
    const double rate_radps = (AzimuthAt(time_s + ToSeconds(format::kSequencePeriod)) - azimuth_rad) / ToSeconds(format::kSequencePeriod);
    for (std::size_t laser = 0; laser < format::kNumLasers; ++laser) {
      const nanoseconds laser_time = static_cast<std::int64_t>(laser) * format::kLaserPeriod;
      const double laser_azimuth_rad = azimuth_rad + rate_radps * ToSeconds(laser_time);
      const auto ring = static_cast<std::size_t>(beams_.ring_of_laser[laser]);
      const double elevation_rad = beams_.elevation_rad[ring];
      const double origin_height_m = params_.use_vertical_origin_offsets ? beams_.origin_height_m[ring] : 0.0;
      const Shot shot = Fire(RayOf(origin_height_m, laser_azimuth_rad, elevation_rad, T_map_vessel), time_s);
      // Time as a reader of the packet finds it: the stamp holds whole microseconds.
      const Utime time = stamp + std::chrono::round<std::chrono::microseconds>(sequence_time - first + laser_time);
      const auto write = [&](int written_block, const Measurement& measurement, int return_index) {
        WriteReturn(payload, written_block, sequence, laser, measurement.range_2mm, measurement.reflectivity);
        if (measurement.range_2mm == 0) return;
        const int slot = (written_block * format::kSequencesPerBlock + sequence) * format::kNumLasers + static_cast<int>(laser);
        packet.returns.push_back(
            {time, beams_.ring_of_laser[laser], return_index, measurement.object_id, measurement.reason, slot,
             Eigen::Vector3d(0.0, 0.0, origin_height_m) + measurement.true_range_m * BeamDirection(laser_azimuth_rad, elevation_rad)});
      };
      if (is_dual) {
        write(block, shot.last, 0);
        write(block + 1, shot.strongest, 1);
      } else {
        write(block, effects_.return_mode() == config::Scene::LAST ? shot.last : shot.strongest, 0);
      }
      packet.end_time = start_ + std::chrono::ceil<std::chrono::microseconds>(sequence_time + laser_time);
    }
  }
  WriteU32LittleEndian(payload, format::kStampOffset, MicrosecondsPastHour(stamp));
  payload[format::kReturnModeOffset] = is_dual                                         ? format::kModeDual
                                       : effects_.return_mode() == config::Scene::LAST ? format::kModeLast
                                                                                       : format::kModeStrongest;
  payload[format::kProductOffset] = params_.model == vlp16::Model::kVlp16 ? format::kProductVlp16 : format::kProductPuckHiRes;
  return packet;
}

}  // namespace lookout::sim
