// Packets of a made-up lidar of three rings, as a PacketReader gives them.
#pragma once

#include <chrono>
#include <cstdint>

#include "common/core/angles.hpp"
#include "services/lidar/core/models/packet_reader.hpp"

namespace lookout::lidar::test {

/// 10 Hz, 360 columns, 10 columns a packet: a degree takes 277.8 us.
class ColumnSensor {
 public:
  static constexpr int kColumnsPerPacket = 10;
  static constexpr std::chrono::nanoseconds kColumnPeriod{277'778};

  explicit ColumnSensor(StampKind stamp = StampKind::kAbsolute, std::chrono::nanoseconds begin = std::chrono::seconds(1'700'000'000))
      : begin_(begin) {
    head.model = "made up";
    head.range_unit_m = 0.001;
    head.returns = {ReturnKind::kStrongest};
    head.stamp = stamp;
    for (int ring = 0; ring < 3; ++ring) head.beams.push_back({.elevation_rad = DegToRad(ring - 1.0), .channel = ring});
  }

  Packet Make(std::int64_t index) const {
    constexpr std::int64_t kColumnsPerRevolution = 360;
    Packet packet;
    packet.stamp = begin_ + index * kColumnsPerPacket * kColumnPeriod;
    if (head.stamp == StampKind::kPastHour) packet.stamp %= std::chrono::hours(1);
    packet.duration = kColumnsPerPacket * kColumnPeriod;
    if (has_numbers) packet.number = PacketNumber{static_cast<std::uint64_t>(index % 1000), 1000};
    for (int column = 0; column < kColumnsPerPacket; ++column) {
      const auto degree = (index * kColumnsPerPacket + column) % kColumnsPerRevolution;
      packet.columns.push_back({DegToRad(static_cast<double>(degree)), column * kColumnPeriod});
      for (std::uint32_t ring = 0; ring < 3; ++ring) {
        packet.range.push_back(range_mm + ring);
        packet.reflectivity.push_back(7);
      }
    }
    return packet;
  }

  Head head;
  bool has_numbers = false;
  std::uint32_t range_mm = 10'000;

 private:
  std::chrono::nanoseconds begin_;
};

}  // namespace lookout::lidar::test
