// Messages of MAVLink 2 as bytes, not signed, and the heartbeats of an autopilot among those that come back. Source: MAVLink guide, "Serialization";
// message set common.xml.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "services/plotter/core/sectors.hpp"

namespace lookout::plotter {

/// Numbers of MAV_STATE.
enum class MavState : std::uint8_t { kActive = 4, kCritical = 5 };
/// Numbers of MAV_SEVERITY.
enum class MavSeverity : std::uint8_t { kCritical = 2, kWarning = 4, kNotice = 5, kInfo = 6 };

/// OBSTACLE_DISTANCE: sector i is centred on 5 i deg from the bow clockwise, frame MAV_FRAME_BODY_FRD.
struct MavSectors {
  static constexpr std::uint16_t kUnknown = 0xFFFF;

  std::uint64_t time_us = 0;
  std::uint16_t min_distance_cm = 1;
  std::uint16_t max_distance_cm = 0;
  std::array<std::uint16_t, kNumSectors> distance_cm{};  // max_distance_cm + 1: nothing within max_distance_cm
};

/// OBSTACLE_DISTANCE_3D, frame MAV_FRAME_BODY_FRD: x ahead, y to starboard, z down.
struct MavPoint {
  std::uint32_t time_ms = 0;  // equal in all points of one look
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double min_distance_m = 0.0;
  double max_distance_m = 0.0;
};

/// Makes whole frames and counts them: one for each link.
class MavlinkWriter {
 public:
  /// @param system_id, component_id  1 to 255
  MavlinkWriter(int system_id, int component_id)
      : system_id_(static_cast<std::uint8_t>(system_id)), component_id_(static_cast<std::uint8_t>(component_id)) {}

  /// HEARTBEAT of a computer on board without an autopilot.
  std::string Heartbeat(MavState state);
  std::string ObstacleDistance(const MavSectors& sectors);
  std::string ObstacleDistance3d(const MavPoint& point);
  /// STATUSTEXT: one frame; a text of more than 50 bytes goes out in several frames, which a receiver puts together.
  std::vector<std::string> StatusText(MavSeverity severity, std::string_view text);

  static constexpr std::size_t kPointFrameBytes = 40;  // at most

 private:
  struct Message {
    std::uint32_t id;
    std::uint8_t crc_extra;  // of the layout of the fields
  };
  static constexpr Message kHeartbeat{0, 50};
  static constexpr Message kStatusText{253, 83};
  static constexpr Message kObstacleDistance{330, 23};
  static constexpr Message kObstacleDistance3d{11037, 130};

  std::string Frame(Message message, std::string payload);

  std::uint8_t system_id_;
  std::uint8_t component_id_;
  std::uint8_t sequence_ = 0;
  std::uint16_t text_id_ = 0;
};

/// Finds HEARTBEAT (MAVLink 1 and 2) in the bytes that a link receives, at any place and cut anywhere. All other bytes are skipped.
class MavlinkReader {
 public:
  /// @return number of heartbeats that end in `bytes`, have a right checksum, and come from an autopilot: not from a ground station or another
  ///         computer on board
  int CountHeartbeats(std::string_view bytes);

 private:
  std::string rest_;  // the beginning of a heartbeat: 33 bytes at most
};

}  // namespace lookout::plotter
