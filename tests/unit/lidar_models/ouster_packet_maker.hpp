// Packets of Ouster sensors, made by hand: what the reader must find in them is what was put in.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "services/lidar/core/models/ouster_metadata.hpp"

namespace lookout::lidar::ouster_maker {

constexpr std::uint64_t kSerial = 122'246'000'293;

/// Metadata of a head with beams from the top down, as makers count them.
inline OusterMetadata MakeMetadata(OusterProfile profile, int num_rings, int columns_per_packet = 16, int num_columns = 1024) {
  OusterMetadata metadata;
  metadata.product = "OS-1-" + std::to_string(num_rings);
  metadata.serial_number = kSerial;
  metadata.init_id = 77;
  metadata.columns_per_frame = num_columns;
  metadata.frames_per_s = 10;
  metadata.profile = profile;
  metadata.pixels_per_column = num_rings;
  metadata.columns_per_packet = columns_per_packet;
  metadata.first_column = 0;
  metadata.last_column = num_columns - 1;
  for (int channel = 0; channel < num_rings; ++channel) {
    metadata.elevation_rad.push_back(0.3 - 0.005 * channel);
    metadata.azimuth_offset_rad.push_back(0.01 * (channel % 4));
  }
  metadata.beam_origin_m = 0.015;
  return metadata;
}

struct Echo {
  std::uint32_t range = 0;
  std::uint8_t reflectivity = 0;
};

/// What a packet says; every member may be changed before it is made.
struct PacketText {
  int type = 1;
  std::uint32_t frame = 5;
  std::uint32_t init_id = 77;
  std::uint64_t serial = kSerial;
  int first_id = 0;
  std::uint64_t stamp_ns = 1'000'000'000;
  std::uint64_t column_ns = 97'656;
  std::function<bool(int)> is_good = [](int /*column*/) { return true; };
  std::function<Echo(int, int, int)> echo = [](int column, int channel, int i) {
    return Echo{.range = static_cast<std::uint32_t>(1000 + 100 * column + channel + 10'000 * i),
                .reflectivity = static_cast<std::uint8_t>(channel + i + 1)};
  };
  bool has_checksum = true;
};

inline void Append(std::vector<std::uint8_t>& bytes, std::uint64_t value, int num_bytes) {
  for (int i = 0; i < num_bytes; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// CRC-64/XZ, bit by bit.
inline std::uint64_t Checksum(const std::vector<std::uint8_t>& bytes) {
  std::uint64_t crc = ~std::uint64_t{0};
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? (crc >> 1) ^ 0xC96C5795D7870F42U : crc >> 1;
  }
  return ~crc;
}

inline std::vector<std::uint8_t> MakePacket(const OusterMetadata& metadata, const PacketText& text) {
  const bool is_legacy = metadata.profile == OusterProfile::kLegacy;
  const bool is_fusa = metadata.profile == OusterProfile::kFusaDual;
  std::vector<std::uint8_t> bytes;
  if (is_fusa) {
    Append(bytes, static_cast<std::uint64_t>(text.type), 4);
    Append(bytes, text.frame, 4);
    Append(bytes, text.init_id, 3);
    Append(bytes, text.serial, 5);
    bytes.resize(32);
  } else if (!is_legacy) {
    Append(bytes, static_cast<std::uint64_t>(text.type), 2);
    Append(bytes, text.frame, 2);
    Append(bytes, text.init_id, 3);
    Append(bytes, text.serial, 5);
    bytes.resize(32);
  }
  for (int column = 0; column < metadata.columns_per_packet; ++column) {
    const bool is_good = text.is_good(column);
    Append(bytes, text.stamp_ns + text.column_ns * static_cast<std::uint64_t>(column), 8);
    Append(bytes, static_cast<std::uint64_t>(text.first_id + column), 2);
    if (is_legacy) {
      Append(bytes, text.frame, 2);
      Append(bytes, 0, 4);
    } else {
      Append(bytes, is_good ? 0xFF01 : 0xFF00, 2);  // other bits mean other things
    }
    for (int channel = 0; channel < metadata.pixels_per_column; ++channel) {
      const auto first = text.echo(column, channel, 0);
      const auto second = text.echo(column, channel, 1);
      // Bits that belong to neither are ones.
      switch (metadata.profile) {
        case OusterProfile::kLegacy:
          Append(bytes, first.range | 0xFFF0'0000U, 4);
          Append(bytes, first.reflectivity | 0xFF00U, 2);
          Append(bytes, 0xFFFF'FFFF'FFFFU, 6);
          break;
        case OusterProfile::kSingle:
          Append(bytes, first.range | 0xFFF8'0000U, 4);
          Append(bytes, first.reflectivity | 0xFF00U, 2);
          Append(bytes, 0xFFFF'FFFF'FFFFU, 6);
          break;
        case OusterProfile::kDual:
          Append(bytes, first.range | 0x00F8'0000U | std::uint64_t{first.reflectivity} << 24, 4);
          Append(bytes, second.range | 0x00F8'0000U | std::uint64_t{second.reflectivity} << 24, 4);
          Append(bytes, ~std::uint64_t{0}, 8);
          break;
        case OusterProfile::kLowBandwidth:
          Append(bytes, first.range | 0xFF00'8000U | std::uint64_t{first.reflectivity} << 16, 4);
          break;
        case OusterProfile::kFusaDual:
          Append(bytes, first.range | 0xFF00'8000U | std::uint64_t{first.reflectivity} << 16, 4);
          Append(bytes, second.range | 0xFF00'8000U | std::uint64_t{second.reflectivity} << 16, 4);
          break;
      }
    }
    if (is_legacy) Append(bytes, is_good ? 0xFFFF'FFFFU : 0U, 4);
  }
  if (!is_legacy) {
    bytes.resize(bytes.size() + 24);
    Append(bytes, text.has_checksum ? Checksum(bytes) : 0xDEAD'BEEFU, 8);
  }
  return bytes;
}

}  // namespace lookout::lidar::ouster_maker
