#include "lab/sim/lidar.hpp"

#include <cmath>
#include <span>

#include "common/core/angles.hpp"
#include "common/core/bytes.hpp"
#include "common/core/frames.hpp"

namespace lookout::sim {
namespace {

namespace format = vlp16::format;

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

Lidar::Lidar(const Scene& scene, const config::BoatFacts& boat, const LidarParams& params, Utime start, std::uint64_t seed)
    : params_(params),
      effects_(scene.effects),
      beams_(vlp16::BeamsOf(params.model)),
      rotor_(params.rotation_rpm, seed),
      shots_(scene, boat, RangeFacts{.unit_m = format::kRangeUnitM}, seed),
      start_(start) {}

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
    shots_.MoveTo(time_s);

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
      const Eigen::Vector3d origin_m(0.0, 0.0, origin_height_m);
      const Eigen::Vector3d direction = BeamDirection(laser_azimuth_rad, elevation_rad);
      const Shot shot = shots_.Fire(origin_m, direction);
      // Time as a reader of the packet finds it: the stamp holds whole microseconds.
      const Utime time = stamp + std::chrono::round<std::chrono::microseconds>(sequence_time - first + laser_time);
      const auto write = [&](int written_block, const Measurement& measurement, int return_index) {
        WriteReturn(payload, written_block, sequence, laser, measurement.range, measurement.reflectivity);
        if (measurement.range == 0) return;
        const int slot = (written_block * format::kSequencesPerBlock + sequence) * format::kNumLasers + static_cast<int>(laser);
        packet.returns.push_back({time, beams_.ring_of_laser[laser], return_index, measurement.object_id, measurement.reason, slot,
                                  origin_m + measurement.true_range_m * direction});
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
