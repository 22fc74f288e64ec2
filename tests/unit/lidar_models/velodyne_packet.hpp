// Packets of Velodyne's models, made by hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/bytes.hpp"
#include "services/lidar/core/models/velodyne.hpp"

namespace lookout::lidar {

inline constexpr std::array<std::uint16_t, 4> kVelodyneBankFlags{0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};

/// A packet whose head turns by 20 / 100 deg a firing; cells hold 1 + laser + 200 x return + 1000 x firing, and the laser as reflectivity.
inline std::vector<std::uint8_t> MakeVelodynePacket(VelodyneModel model, std::uint8_t mode, int first_azimuth_cdeg = 1000) {
  const std::size_t num_banks = model == VelodyneModel::kVls128 ? 4 : 1;
  const std::size_t num_returns = mode == 0x39 ? 2 : 1;
  std::vector<std::uint8_t> payload(1206, 0);
  const std::size_t num_blocks = 12 / (num_banks * num_returns) * num_banks * num_returns;
  for (std::size_t block = 0; block < num_blocks; ++block) {
    const std::size_t firing = block / (num_banks * num_returns);
    const std::size_t return_index = block % num_returns;
    const std::size_t bank = block / num_returns % num_banks;
    const auto bytes = std::span(payload).subspan(100 * block, 100);
    WriteU16LittleEndian(bytes, 0, kVelodyneBankFlags[bank]);
    WriteU16LittleEndian(bytes, 2, static_cast<std::uint16_t>((static_cast<std::size_t>(first_azimuth_cdeg) + 20 * firing) % 36'000));
    for (std::size_t laser = 0; laser < 32; ++laser) {
      WriteU16LittleEndian(bytes, 4 + 3 * laser, static_cast<std::uint16_t>(1 + 32 * bank + laser + 200 * return_index + 1000 * firing));
      bytes[6 + 3 * laser] = static_cast<std::uint8_t>(32 * bank + laser);
    }
  }
  WriteU32LittleEndian(std::span(payload), 1200, 123'456'789);
  payload[1204] = mode;
  payload[1205] = model == VelodyneModel::kHdl32e ? 0x21 : model == VelodyneModel::kVlp32c ? 0x28 : 0xA1;
  return payload;
}

}  // namespace lookout::lidar
