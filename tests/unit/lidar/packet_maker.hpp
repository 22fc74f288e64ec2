// Packets of a VLP-16 for tests, written by the constants of the manual.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::vlp16::test {

using Payload = std::vector<std::uint8_t>;

struct ReturnValue {
  std::uint16_t range = 0;
  std::uint8_t reflectivity = 0;
};

/// A packet whose blocks have the given azimuths and whose returns are all `value`.
inline Payload MakeDataPacket(const std::array<int, format::kNumBlocks>& azimuth_cdeg, std::uint32_t stamp_us,
                              std::uint8_t mode = format::kModeStrongest, std::uint8_t product = format::kProductVlp16,
                              ReturnValue value = {500, 10}) {
  Payload payload(format::kDataPacketSizeBytes);
  for (std::size_t block = 0; block < format::kNumBlocks; ++block) {
    const std::size_t offset = block * format::kBlockSizeBytes;
    WriteU16LittleEndian(payload, offset + format::kBlockFlagOffset, format::kBlockFlag);
    WriteU16LittleEndian(payload, offset + format::kBlockAzimuthOffset, static_cast<std::uint16_t>(azimuth_cdeg[block]));
    for (std::size_t i = 0; i < format::kSequencesPerBlock * format::kNumLasers; ++i) {
      const std::size_t place = offset + format::kBlockReturnsOffset + i * format::kReturnSizeBytes;
      WriteU16LittleEndian(payload, place, value.range);
      payload[place + 2] = value.reflectivity;
    }
  }
  WriteU32LittleEndian(payload, format::kStampOffset, stamp_us);
  payload[format::kReturnModeOffset] = mode;
  payload[format::kProductOffset] = product;
  return payload;
}

inline void SetReturn(Payload& payload, int block, int sequence, int laser, ReturnValue value) {
  const std::size_t place = static_cast<std::size_t>(block) * format::kBlockSizeBytes + format::kBlockReturnsOffset +
                            static_cast<std::size_t>(sequence * format::kNumLasers + laser) * format::kReturnSizeBytes;
  WriteU16LittleEndian(payload, place, value.range);
  payload[place + 2] = value.reflectivity;
}

/// Azimuths of blocks from `first_cdeg`, `gap_cdeg` apart; in dual return in pairs.
inline std::array<int, format::kNumBlocks> Azimuths(int first_cdeg, int gap_cdeg, bool is_dual = false) {
  std::array<int, format::kNumBlocks> azimuth_cdeg{};
  for (int block = 0; block < format::kNumBlocks; ++block) {
    azimuth_cdeg[static_cast<std::size_t>(block)] = (first_cdeg + (is_dual ? block / 2 : block) * gap_cdeg) % format::kAzimuthsPerRevolution;
  }
  return azimuth_cdeg;
}

/// A sensor that rotates evenly: one packet after the other. Azimuth and stamp are rounded down, as the sensor's counters do.
class SpinningSensor {
 public:
  /// What the laser sees: (azimuth in deg, laser, return index as transmitted) to a return.
  using Scene = std::function<ReturnValue(double azimuth_deg, int laser, int return_index)>;

  double azimuth_deg = 0.0;
  double rpm = 600.0;
  std::int64_t time_ns = 0;  // since the hour
  std::uint8_t mode = format::kModeStrongest;
  std::uint8_t product = format::kProductVlp16;
  Scene scene = [](double, int, int) { return ReturnValue{500, 10}; };

  bool is_dual() const { return mode == format::kModeDual; }
  std::chrono::nanoseconds period() const { return is_dual() ? format::kPacketPeriodDual : format::kPacketPeriodSingle; }
  std::uint32_t stamp_us() const { return static_cast<std::uint32_t>(time_ns / 1000 % format::kMicrosecondsPerHour); }

  Payload Next() {
    const double deg_per_ns = rpm * 360.0 / 60e9;
    const int blocks_per_step = is_dual() ? 2 : 1;
    std::array<int, format::kNumBlocks> azimuth_cdeg{};
    for (int block = 0; block < format::kNumBlocks; ++block) {
      const double at_ns = static_cast<double>(block / blocks_per_step * format::kBlockPeriod.count());
      azimuth_cdeg[static_cast<std::size_t>(block)] = static_cast<int>(std::fmod(azimuth_deg + at_ns * deg_per_ns, 360.0) * 100.0);
    }
    Payload payload = MakeDataPacket(azimuth_cdeg, stamp_us(), mode, product, {});
    for (int block = 0; block < format::kNumBlocks; ++block) {
      for (int sequence = 0; sequence < format::kSequencesPerBlock; ++sequence) {
        for (int laser = 0; laser < format::kNumLasers; ++laser) {
          const auto at = block / blocks_per_step * format::kBlockPeriod + sequence * format::kSequencePeriod + laser * format::kLaserPeriod;
          const double at_deg = std::fmod(azimuth_deg + static_cast<double>(at.count()) * deg_per_ns, 360.0);
          SetReturn(payload, block, sequence, laser, scene(at_deg, laser, block % blocks_per_step));
        }
      }
    }
    Skip(1);
    return payload;
  }

  /// Packets that nobody sees.
  void Skip(int num_packets) {
    const std::int64_t skipped_ns = num_packets * period().count();
    azimuth_deg = std::fmod(azimuth_deg + static_cast<double>(skipped_ns) * rpm * 360.0 / 60e9, 360.0);
    time_ns += skipped_ns;
  }
};

inline Payload MakePositionPacket(std::uint32_t stamp_us, std::uint8_t pps, std::string_view sentence, std::string_view end = "\r\n") {
  Payload payload(format::kPositionPacketSizeBytes);
  WriteU32LittleEndian(payload, format::kPositionStampOffset, stamp_us);
  payload[format::kPpsOffset] = pps;
  std::size_t place = format::kSentenceOffset;
  for (const char character : sentence) payload[place++] = static_cast<std::uint8_t>(character);
  for (const char character : end) payload[place++] = static_cast<std::uint8_t>(character);
  return payload;
}

/// Its checksum is right.
inline constexpr std::string_view kValidRmc = "$GPRMC,081802.00,A,3649.7478558,N,00224.4542928,W,0.034,212.5,210116,0.0,E,A*2E";

}  // namespace lookout::vlp16::test
