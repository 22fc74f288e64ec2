// What all fuzz targets of packet readers do: read payload after payload, and check that what comes out is sound.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "services/lidar/core/models/packet_reader.hpp"

namespace lookout::lidar::fuzz {

// The optimiser makes one abort() of all, so that a stack trace does not tell which.
inline void Expect(bool is_true, int line = __builtin_LINE()) {
  if (is_true) return;
  std::fprintf(stderr, "line %d does not hold\n", line);
  std::abort();
}

inline void CheckHead(const Head& head) {
  Expect(!head.model.empty() && head.range_unit_m > 0.0 && head.range_unit_m <= 0.008);
  Expect(!head.beams.empty() && head.beams.size() <= 128 && !head.returns.empty() && head.returns.size() <= 2);
  Expect(std::ranges::is_sorted(head.beams, {}, &Beam::elevation_rad));
}

inline void CheckPacket(const Packet& packet, const Head& head) {
  using namespace std::chrono_literals;
  CheckHead(head);
  Expect(packet.stamp >= 0ns && packet.duration > 0ns && packet.duration < 60s);
  Expect(!packet.number || packet.number->number < packet.number->modulus);
  Expect(packet.range.size() == packet.columns.size() * head.num_cells_of_column() && packet.reflectivity.size() == packet.range.size());
  for (std::size_t i = 0; i < packet.columns.size(); ++i) {
    Expect(packet.columns[i].azimuth_rad >= 0.0 && packet.columns[i].azimuth_rad < 2.0 * std::numbers::pi);
    Expect(i == 0 || packet.columns[i].time > packet.columns[i - 1].time);
    Expect(packet.columns[i].time - packet.columns[0].time < packet.duration);
  }
  for (std::size_t cell = 0; cell < packet.range.size(); ++cell) {
    Expect(packet.range[cell] <= 0xFFFF);
    Expect(packet.range[cell] != 0 || packet.reflectivity[cell] == 0);
  }
}

/// Each payload follows a control byte: the lowest bit says which of the reader's sizes it has, the highest that it lacks some bytes.
inline void ReadAll(PacketReader& reader, Bytes script) {
  constexpr std::size_t kMaxPayloadBytes = 1500;
  std::vector<std::size_t> sizes;
  for (std::size_t size = 0; size < kMaxPayloadBytes; ++size) {
    if (reader.MayBe(size)) sizes.push_back(size);
  }
  Packet packet;
  int head_number = reader.head_number();
  while (!script.empty()) {
    const std::uint8_t control = script[0];
    script = script.subspan(1);
    std::size_t size = sizes[control % 2 % sizes.size()];
    if ((control & 0x80U) != 0) size -= control >> 1 & 0x3FU;
    const Bytes payload = script.first(std::min(script.size(), size));
    script = script.subspan(payload.size());
    const auto fault = reader.Read(payload, packet);
    if (fault == PacketFault::kNone) {
      Expect(reader.MayBe(payload.size()));
      CheckPacket(packet, reader.head());
    } else {
      Expect(!reader.reason().empty() && reader.head_number() == head_number);
    }
    Expect(reader.head_number() - head_number <= 1);
    head_number = reader.head_number();
  }
}

}  // namespace lookout::lidar::fuzz
