#include "tools/sim/lidar.hpp"

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
// A diffuse surface of this reflectance, square to the beam, is seen half of the time at kHalfSeenRangeM (dark paint and rubber near 905 nm are
// lost at 20 to 30 m, bright hulls at 100 m).
constexpr double kHalfSeenReflectance = 0.4;
constexpr double kHalfSeenRangeM = 100.0;
// Surfaces are rough within the beam: this share of the reflectance does not depend on the angle at which they are met.
constexpr double kRoughShare = 0.3;
constexpr double kDropoutWidth = 0.06;  // of the step from seen to not seen, as a share of the range

// Strays: glints and spray, most of them near and all of them faint.
constexpr double kStrayMinRangeM = 1.0;
constexpr double kStrayMaxRangeM = 40.0;

std::vector<RayCaster::Body> BodiesOf(const Scene& scene) {
  std::vector<RayCaster::Body> bodies;
  for (const auto& object : scene.objects) bodies.push_back({object.id, object.track, &object.parts});
  return bodies;
}

// In its own frame a body has the heading that turns x, y into east, north.
const Track kVesselFrame{{Eigen::Vector2d::Zero(), kPi / 2.0}};

int RingOfLaser(const std::array<double, format::kNumLasers>& elevations_deg, std::size_t laser) {
  return static_cast<int>(std::ranges::count_if(elevations_deg, [&](double elevation_deg) { return elevation_deg < elevations_deg[laser]; }));
}

std::uint32_t MicrosecondsPastHour(Utime time) {
  return static_cast<std::uint32_t>((time - std::chrono::floor<std::chrono::hours>(time)) / std::chrono::microseconds(1));
}

void WriteReturn(std::span<std::uint8_t> payload, int block, int sequence, std::size_t laser, std::uint16_t range_2mm, std::uint8_t reflectivity) {
  const std::size_t offset = static_cast<std::size_t>(block) * format::kBlockSizeBytes + format::kBlockReturnsOffset +
                             (static_cast<std::size_t>(sequence) * format::kNumLasers + laser) * format::kReturnSizeBytes;
  WriteU16LittleEndian(payload, offset, range_2mm);
  payload[offset + 2] = reflectivity;
}

}  // namespace

const Lidar::Beams& Lidar::BeamsOf(LidarModel model) {
  static constexpr Beams kVlp16{format::kElevationDegVlp16, format::kOriginHeightMmVlp16, format::kProductVlp16};
  static constexpr Beams kPuckHiRes{format::kElevationDegPuckHiRes, format::kOriginHeightMmPuckHiRes, format::kProductPuckHiRes};
  return model == LidarModel::kVlp16 ? kVlp16 : kPuckHiRes;
}

Lidar::Lidar(const Scene& scene, const config::BoatFacts& boat, const LidarParams& params, Utime start, std::uint64_t seed)
    : params_(params),
      beams_(BeamsOf(params.model)),
      own_motion_(scene.own_motion),
      reference_point_above_water_m_(boat.reference_point_above_water_m),
      T_vessel_lidar_(boat.T_vessel_lidar),
      own_hull_(MakeOwnHull(boat.own_vessel_box_m, boat.lidar.p_vessel_m.z(), boat.p_vessel_antenna_m)),
      own_caster_({{kOwnVessel, kVesselFrame, &own_hull_}}),
      caster_(BodiesOf(scene)),
      random_(seed, kShotStream),
      start_(start) {
  Random random(seed, kRotorStream);
  rotor_phase_rad_ = random.Uniform(0.0, kTwoPi);
  // Captures of real sensors show 601 to 607 rpm where 600 were asked for, and some hundredths of a degree of wander within a turn.
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

Lidar::Measurement Lidar::Measure(const Echo& echo) {
  const double range_m = echo.hit.range_m;
  const double strength = echo.material.reflectance * (kRoughShare + (1.0 - kRoughShare) * echo.hit.incidence_cosine) / kHalfSeenReflectance;
  const double half_seen_m = kHalfSeenRangeM * std::sqrt(std::min(strength, 1.0));
  const double seen = 1.0 / (1.0 + std::exp((range_m - half_seen_m) / (kDropoutWidth * half_seen_m)));
  if (range_m < kMinRangeM || random_.Uniform() >= seen) return {};
  const double measured_m = range_m + params_.range_sd_m * random_.Normal();
  const double range_2mm = std::round(measured_m / format::kRangeUnitM);
  if (range_2mm < 1.0 || range_2mm > std::numeric_limits<std::uint16_t>::max()) return {};
  const double reflectivity =
      100.0 * echo.material.reflectance * (kRoughShare + (1.0 - kRoughShare) * echo.hit.incidence_cosine) + 2.0 * random_.Normal();
  return {static_cast<std::uint16_t>(range_2mm), static_cast<std::uint8_t>(std::clamp(std::round(reflectivity), 1.0, 100.0)), echo.object_id};
}

Lidar::Measurement Lidar::Stray(double max_range_m) {
  // The square brings most of them near.
  const double share = random_.Uniform();
  const double range_m = kStrayMinRangeM + (std::min(max_range_m, kStrayMaxRangeM) - kStrayMinRangeM) * share * share;
  const double reflectivity = random_.Uniform(1.0, 8.0);
  if (range_m < kStrayMinRangeM) return {};
  return {static_cast<std::uint16_t>(range_m / format::kRangeUnitM), static_cast<std::uint8_t>(reflectivity), kNoObject};
}

Lidar::Shot Lidar::Fire(std::size_t laser, double azimuth_rad, const Eigen::Isometry3d& T_map_vessel) {
  const double origin_height_m = params_.use_vertical_origin_offsets ? beams_.origin_height_mm[laser] / 1000.0 : 0.0;
  const Ray ray_vessel{T_vessel_lidar_ * Eigen::Vector3d(0.0, 0.0, origin_height_m),
                       T_vessel_lidar_.linear() * BeamDirection(azimuth_rad, DegToRad(beams_.elevation_deg[laser]))};
  const Ray ray{T_map_vessel * ray_vessel.origin_m, T_map_vessel.linear() * ray_vessel.direction};
  // Calm water gives nothing back.
  const double to_water_m = ray.direction.z() < 0.0 ? -ray.origin_m.z() / ray.direction.z() : kMaxRangeM;
  const double max_range_m = std::clamp(to_water_m, 0.0, kMaxRangeM);
  auto echoes = own_caster_.Cast(ray_vessel, max_range_m, false);
  if (echoes.count == 0) echoes = caster_.Cast(ray, max_range_m, params_.mode != ReturnMode::kStrongest);

  Shot shot;
  if (echoes.count > 0) {
    shot.strongest = Measure(echoes.echo[0]);
    shot.last = shot.strongest;
    // Half of the shots into foliage give a second return behind it; the first is the stronger one.
    if (echoes.count > 1 && random_.Uniform() < 0.5) {
      const Measurement second = Measure(echoes.echo[1]);
      if (second.range_2mm != 0) shot.last = second;
      if (shot.strongest.range_2mm == 0) shot.strongest = shot.last;
    }
  }
  // Only where nothing was met: a stray takes no return from an object.
  if (echoes.count == 0 && random_.Uniform() < params_.stray_probability) shot.last = shot.strongest = Stray(max_range_m);
  return shot;
}

// Whether a block that begins with this sequence lies in the field of view as a whole, first shot to last.
bool Lidar::FiresFrom(std::int64_t sequence) const {
  const auto begin = sequence * format::kSequencePeriod;
  return params_.field_of_view.Contains(AzimuthAt(ToSeconds(begin))) &&
         params_.field_of_view.Contains(AzimuthAt(ToSeconds(begin + format::kBlockPeriod - format::kRechargeTime - format::kLaserPeriod)));
}

LidarPacket Lidar::Next() {
  using std::chrono::nanoseconds;
  const bool is_dual = params_.mode == ReturnMode::kDual;
  LidarPacket packet;
  const std::span<std::uint8_t> payload(packet.payload);
  const auto skip_to_field_of_view = [this] {
    while (!FiresFrom(next_sequence_)) ++next_sequence_;
  };
  skip_to_field_of_view();
  const nanoseconds first = next_sequence_ * format::kSequencePeriod;
  const Utime stamp = start_ + std::chrono::floor<std::chrono::microseconds>(first);
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

    if (sequence == 0) {
      const auto azimuth_cdeg = static_cast<std::uint16_t>(std::lround(RadToDeg(WrapTo2Pi(AzimuthAt(time_s))) * 100.0) % format::kAzimuthsPerTurn);
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
      const Shot shot = Fire(laser, azimuth_rad + rate_radps * ToSeconds(laser_time), T_map_vessel);
      // Time as a reader of the packet finds it: the stamp holds whole microseconds.
      const Utime time = stamp + std::chrono::round<std::chrono::microseconds>(sequence_time - first + laser_time);
      const auto write = [&](int written_block, const Measurement& measurement, int return_index) {
        WriteReturn(payload, written_block, sequence, laser, measurement.range_2mm, measurement.reflectivity);
        if (measurement.range_2mm == 0) return;
        packet.returns.push_back({time, RingOfLaser(beams_.elevation_deg, laser), return_index, measurement.object_id});
      };
      if (is_dual) {
        write(block, shot.last, 0);
        write(block + 1, shot.strongest, 1);
      } else {
        write(block, params_.mode == ReturnMode::kLast ? shot.last : shot.strongest, 0);
      }
      packet.end_time = start_ + std::chrono::ceil<std::chrono::microseconds>(sequence_time + laser_time);
    }
  }
  WriteU32LittleEndian(payload, format::kStampOffset, MicrosecondsPastHour(stamp));
  payload[format::kReturnModeOffset] = is_dual ? format::kModeDual : params_.mode == ReturnMode::kLast ? format::kModeLast : format::kModeStrongest;
  payload[format::kProductOffset] = beams_.product;
  return packet;
}

}  // namespace lookout::sim
