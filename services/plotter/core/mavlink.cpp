#include "services/plotter/core/mavlink.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "common/core/append_bytes.hpp"
#include "common/core/mavlink.hpp"

namespace lookout::plotter {

namespace {

constexpr std::uint8_t kMagic = 0xFD;                // MAVLink 2
constexpr std::uint8_t kTypeOnboardController = 18;  // MAV_TYPE
constexpr std::uint8_t kAutopilotInvalid = 8;        // MAV_AUTOPILOT: none
constexpr std::uint8_t kMavlinkVersion = 3;
constexpr std::uint8_t kSensorLaser = 0;    // MAV_DISTANCE_SENSOR
constexpr std::uint8_t kFrameBodyFrd = 12;  // MAV_FRAME
constexpr std::uint16_t kUnknownObstacle = 0xFFFF;
constexpr std::size_t kTextBytes = 50;

}  // namespace

int MavlinkReader::CountHeartbeats(std::string_view bytes) {
  static constexpr std::array kKinds{MavlinkKind{.id = 0, .crc_extra = 50, .num_bytes = 9, .max_payload_bytes = 9}};
  constexpr std::size_t kAutopilotAt = 5;
  rest_ += bytes;
  const auto found = FindMavlink(rest_, kKinds);
  int num_heartbeats = 0;
  for (const auto& frame : found.frames) {
    // Zeros at the end of the payload are not sent.
    const auto autopilot = frame.payload.size() > kAutopilotAt ? static_cast<std::uint8_t>(frame.payload[kAutopilotAt]) : 0;
    if (autopilot != kAutopilotInvalid) ++num_heartbeats;
  }
  rest_.erase(0, found.num_used);
  return num_heartbeats;
}

std::string MavlinkWriter::Frame(Message message, std::string payload) {
  // Zeros at the end are not sent, but for the first byte.
  const auto last = payload.find_last_not_of('\0');
  payload.resize(last == std::string::npos ? 1 : last + 1);
  std::string frame;
  AppendLittleEndian(kMagic, 1, frame);
  AppendLittleEndian(payload.size(), 1, frame);
  AppendLittleEndian(0, 2, frame);  // flags: none, so no signature
  AppendLittleEndian(sequence_++, 1, frame);
  AppendLittleEndian(system_id_, 1, frame);
  AppendLittleEndian(component_id_, 1, frame);
  AppendLittleEndian(message.id, 3, frame);
  frame += payload;
  AppendLittleEndian(MavlinkCrc(std::string_view(frame).substr(1), message.crc_extra), 2, frame);
  return frame;
}

// Fields stand in the order of their sizes, the greatest first, then extension fields in the order in which they were added.
std::string MavlinkWriter::Heartbeat(MavState state) {
  std::string payload;
  AppendLittleEndian(0, 4, payload);  // mode: of autopilots
  AppendLittleEndian(kTypeOnboardController, 1, payload);
  AppendLittleEndian(kAutopilotInvalid, 1, payload);
  AppendLittleEndian(0, 1, payload);
  AppendLittleEndian(static_cast<std::uint8_t>(state), 1, payload);
  AppendLittleEndian(kMavlinkVersion, 1, payload);
  return Frame(kHeartbeat, std::move(payload));
}

std::string MavlinkWriter::ObstacleDistance(const MavSectors& sectors) {
  std::string payload;
  AppendLittleEndian(sectors.time_us, 8, payload);
  for (const auto distance_cm : sectors.distance_cm) AppendLittleEndian(distance_cm, 2, payload);
  AppendLittleEndian(sectors.min_distance_cm, 2, payload);
  AppendLittleEndian(sectors.max_distance_cm, 2, payload);
  AppendLittleEndian(kSensorLaser, 1, payload);
  AppendLittleEndian(kSectorDeg, 1, payload);
  AppendFloat(kSectorDeg, payload);
  AppendFloat(0.0, payload);  // angle_offset: of the middle of the first sector
  AppendLittleEndian(kFrameBodyFrd, 1, payload);
  return Frame(kObstacleDistance, std::move(payload));
}

std::string MavlinkWriter::ObstacleDistance3d(const MavPoint& point) {
  std::string payload;
  AppendLittleEndian(point.time_ms, 4, payload);
  for (const double value_m : {point.x_m, point.y_m, point.z_m, point.min_distance_m, point.max_distance_m}) AppendFloat(value_m, payload);
  AppendLittleEndian(kUnknownObstacle, 2, payload);
  AppendLittleEndian(kSensorLaser, 1, payload);
  AppendLittleEndian(kFrameBodyFrd, 1, payload);
  return Frame(kObstacleDistance3d, std::move(payload));
}

std::vector<std::string> MavlinkWriter::StatusText(MavSeverity severity, std::string_view text) {
  constexpr std::size_t kMostChunks = 256;
  text = text.substr(0, kTextBytes * kMostChunks - 1);
  const bool is_long = text.size() > kTextBytes;
  // 0 is of a text that comes whole.
  if (is_long) text_id_ = text_id_ == 0xFFFF ? 1 : static_cast<std::uint16_t>(text_id_ + 1);
  std::vector<std::string> frames;
  for (std::size_t chunk = 0;; ++chunk) {
    const auto part = text.substr(std::min(text.size(), chunk * kTextBytes), kTextBytes);
    std::string payload;
    AppendLittleEndian(static_cast<std::uint8_t>(severity), 1, payload);
    payload += part;
    payload.resize(1 + kTextBytes, '\0');
    AppendLittleEndian(is_long ? text_id_ : 0, 2, payload);
    AppendLittleEndian(chunk, 1, payload);
    frames.push_back(Frame(kStatusText, std::move(payload)));
    // Only the last of several chunks is not full, so that a receiver knows it.
    if (!is_long || part.size() < kTextBytes) return frames;
  }
}

}  // namespace lookout::plotter
