// Frames of MAVLink 2, read by other code than that which writes them.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::support {

/// One frame, its payload filled up with zeros as a receiver does.
struct MavlinkFrame {
  int sequence = 0;
  int system_id = 0;
  int component_id = 0;
  std::uint32_t message_id = 0;
  std::string payload;

  template <typename Number>
  Number At(std::size_t offset) const {
    Number number{};
    EXPECT_LE(offset + sizeof number, payload.size());
    std::memcpy(&number, payload.data() + offset, sizeof number);
    return number;
  }
  /// Of OBSTACLE_DISTANCE.
  std::uint16_t distance_cm(std::size_t sector) const { return At<std::uint16_t>(8 + 2 * sector); }
  /// Of STATUSTEXT.
  std::string text() const { return payload.substr(1, 50).c_str(); }
};

inline constexpr std::uint32_t kHeartbeatId = 0, kStatusTextId = 253, kObstacleDistanceId = 330, kObstacleDistance3dId = 11037;

/// By a table, from the polynomial x^16 + x^12 + x^5 + 1 in reversed order.
inline std::uint16_t MavlinkCrc(std::string_view bytes) {
  std::uint16_t crc = 0xFFFF;
  for (const char byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ static_cast<std::uint8_t>(byte));
    for (int bit = 0; bit < 8; ++bit) crc = static_cast<std::uint16_t>((crc & 1) != 0 ? (crc >> 1) ^ 0x8408 : crc >> 1);
  }
  return crc;
}

/// What an autopilot tells of itself: MAV_AUTOPILOT (12: PX4; 8: none) as system 1, component 1, in a frame of MAVLink 2 or 1.
inline std::string AutopilotHeartbeat(bool is_second = true, char autopilot = '\x0C') {
  std::string frame = is_second ? std::string("\xFD\x09\0\0\x07\x01\x01\0\0\0", 10) : std::string("\xFE\x09\x07\x01\x01\0", 6);
  frame += std::string("\0\0\0\0\x0B", 5) + autopilot + std::string("\0\x04\x03", 3);
  const auto crc = MavlinkCrc(frame.substr(1) + '\x32');
  frame += static_cast<char>(crc & 0xFF);
  frame += static_cast<char>(crc >> 8);
  return frame;
}

/// All frames of a text that holds nothing else; a failure of the test where one is wrong.
inline std::vector<MavlinkFrame> ReadMavlink(std::string_view bytes) {
  struct Kind {
    std::size_t size;
    char crc_extra;
  };
  static const std::map<std::uint32_t, Kind> kKinds{
      {kHeartbeatId, {9, '\x32'}}, {kStatusTextId, {54, '\x53'}}, {kObstacleDistanceId, {167, '\x17'}}, {kObstacleDistance3dId, {28, '\x82'}}};
  std::vector<MavlinkFrame> frames;
  const auto byte = [&bytes](std::size_t place) { return static_cast<std::uint8_t>(bytes.at(place)); };
  while (!bytes.empty()) {
    constexpr std::size_t kHead = 10;
    if (bytes.size() < kHead + 2 || byte(0) != 0xFD || bytes.size() < kHead + byte(1) + 2U) {
      ADD_FAILURE() << "no frame";
      return frames;
    }
    const std::size_t size = byte(1);
    MavlinkFrame frame{byte(4), byte(5), byte(6), byte(7) + 256U * byte(8) + 65536U * byte(9), std::string(bytes.substr(kHead, size))};
    EXPECT_EQ(byte(2) + byte(3), 0);
    const auto kind = kKinds.find(frame.message_id);
    if (kind == kKinds.end()) {
      ADD_FAILURE() << "message " << frame.message_id;
      return frames;
    }
    EXPECT_LE(size, kind->second.size);
    EXPECT_TRUE(size == 1 || frame.payload.back() != '\0') << "a zero at the end is sent";
    EXPECT_EQ(MavlinkCrc(std::string(bytes.substr(1, kHead - 1 + size)) + kind->second.crc_extra), byte(kHead + size) + 256 * byte(kHead + size + 1));
    frame.payload.resize(kind->second.size, '\0');
    frames.push_back(std::move(frame));
    bytes.remove_prefix(kHead + size + 2);
  }
  return frames;
}

inline std::vector<MavlinkFrame> Only(std::uint32_t message_id, const std::vector<MavlinkFrame>& frames) {
  std::vector<MavlinkFrame> found;
  for (const auto& frame : frames) {
    if (frame.message_id == message_id) found.push_back(frame);
  }
  return found;
}

}  // namespace lookout::support
