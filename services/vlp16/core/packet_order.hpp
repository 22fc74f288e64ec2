// The place of each data packet in sensor time: what is next, what was lost, what came twice or late.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "services/vlp16/core/data_packet.hpp"

namespace lookout::vlp16 {

/// Sensor time that goes on over the hour: its microseconds past the hour plus any number of whole hours.
using SensorTime = std::chrono::microseconds;

enum class PacketKind {
  kFirst,  // after a start
  kNext,
  kDuplicate,    // same sensor time as the last: to be dropped
  kReordered,    // up to eight packets earlier than the last: to be dropped
  kOverlapping,  // less than half a period after the last, which no sensor of this kind sends: to be dropped
  kJump,         // the sensor's clock went elsewhere (restart, set by PPS, long pause)
};

struct PacketPlace {
  PacketKind kind = PacketKind::kFirst;
  SensorTime time{0};  // of the packet's first shot; only when it is not to be dropped
  int num_lost = 0;    // packets missing before this one; kNext only
};

class PacketOrder {
 public:
  /// @param duration  of this packet, as measured by MeasureSteps
  PacketPlace Place(const DataPacket& packet, std::chrono::nanoseconds duration);

  /// Sensor time of another stamp (of a position packet) near the last data packet; nullopt before the first.
  std::optional<SensorTime> TimeOfStamp(std::uint32_t stamp_us) const;

 private:
  struct Last {
    SensorTime time;
    std::chrono::nanoseconds period;
    std::chrono::nanoseconds duration;
  };
  std::optional<Last> last_;
};

}  // namespace lookout::vlp16
