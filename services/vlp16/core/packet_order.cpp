#include "services/vlp16/core/packet_order.hpp"

#include <algorithm>

namespace lookout::vlp16 {

namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

constexpr microseconds kHour(format::kMicrosecondsPerHour);
// A network puts packets out of order over some places; what is earlier than that is another clock.
constexpr int kMaxReorderedPackets = 8;
// A longer gap is not a loss that could be counted: the sensor may have been off.
constexpr microseconds kMaxGap = std::chrono::seconds(1);

// The way from the last time to a stamp, within half an hour to either side.
microseconds Difference(std::uint32_t stamp_us, SensorTime last) {
  microseconds difference = (microseconds(stamp_us) - last) % kHour;
  if (difference >= kHour / 2) difference -= kHour;
  if (difference < -kHour / 2) difference += kHour;
  return difference;
}

}  // namespace

PacketPlace PacketOrder::Place(const DataPacket& packet, nanoseconds duration) {
  PacketPlace place;
  if (!last_) {
    place.time = SensorTime(packet.stamp_us);
    last_ = Last{place.time, packet.period(), duration};
    return place;
  }
  const microseconds difference = Difference(packet.stamp_us, last_->time);
  if (difference == microseconds(0)) {
    place.kind = PacketKind::kDuplicate;
  } else if (difference < microseconds(0) && difference >= -kMaxReorderedPackets * last_->period) {
    place.kind = PacketKind::kReordered;
  } else if (difference < microseconds(0) || difference > kMaxGap) {
    place.kind = PacketKind::kJump;
    place.time = SensorTime(packet.stamp_us);
  } else if (difference < last_->period / 2) {
    place.kind = PacketKind::kOverlapping;
  } else {
    place.kind = PacketKind::kNext;
    place.time = last_->time + difference;
    const nanoseconds missing = difference - last_->duration;
    if (missing > nanoseconds(0)) place.num_lost = static_cast<int>((missing + last_->period / 2) / last_->period);
  }
  if (place.kind == PacketKind::kNext || place.kind == PacketKind::kJump) last_ = Last{place.time, packet.period(), duration};
  return place;
}

std::optional<SensorTime> PacketOrder::TimeOfStamp(std::uint32_t stamp_us) const {
  if (!last_) return std::nullopt;
  return last_->time + Difference(stamp_us, last_->time);
}

}  // namespace lookout::vlp16
