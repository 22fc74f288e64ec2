// The place of each data packet in sensor time: restores their order, drops copies and packets that are too late, counts missing ones.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "common/core/utime.hpp"
#include "services/lidar/core/driver/clock_reading.hpp"
#include "services/lidar/core/driver/sequence.hpp"
#include "services/lidar/core/vlp16/blind_sector.hpp"
#include "services/lidar/core/vlp16/data_packet.hpp"
#include "services/lidar/core/vlp16/model.hpp"

namespace lookout::vlp16 {

using lidar::SensorTime;

struct PlacedPacket {
  DataPacket packet;  // its payload is valid during the call that passes the packet on
  Steps steps;
  Model model = Model::kVlp16;
  Utime host_time;            // arrival of the packet
  SensorTime time{0};         // of the packet's first shot
  int num_lost = 0;           // packets that are missing before this packet
  bool is_restart = true;     // the packet does not continue earlier ones: it is the first, or the sensor started anew, or paused
  bool is_elsewhere = false;  // time goes on, but the azimuths do not continue those of the packet before

  int last_gap_cdeg() const { return steps.gap_cdeg[static_cast<std::size_t>(packet.num_steps) - 1]; }
};

using lidar::PacketVerdict;
using lidar::SequenceCounts;

/// A packet is next when it follows the last by that one's duration. Behind a gap packets are held until the missing ones come, or eight later ones
/// have. Missing packets are known from sensor time (their period) and checked by the azimuth that was passed over. When azimuth says that nothing is
/// missing, and the host's clock, that no such time passed, sensor time was set.
class PacketSequencer {
 public:
  using Handler = std::function<void(const PlacedPacket&)>;

  static constexpr std::size_t kMaxHeld = 8;

  explicit PacketSequencer(Handler on_packet) : on_packet_(std::move(on_packet)) {}

  /// Passes packets, in their order, to the handler: this one, or those that waited for it, or none.
  PacketVerdict Add(Utime host_time, const DataPacket& packet, Model model);

  /// End of input: passes on the held packets.
  void Flush();

  /// Sensor time of the stamp of a position packet; nullopt when no data packet came within a second of it by the host's clock.
  std::optional<SensorTime> TimeOfStamp(Utime host_time, std::uint32_t stamp_us) const;

  const SequenceCounts& counts() const { return counts_; }

 private:
  struct Held {
    Utime host_time;
    DataPacket packet;  // `packet.payload` refers to `payload`
    Model model = Model::kVlp16;
    std::array<std::uint8_t, format::kDataPacketSizeBytes> payload{};
  };
  struct Known {
    std::uint32_t stamp_us = 0;
    int azimuth_cdeg = -1;  // none
  };
  enum class Kind { kNext, kMissing, kLate, kOverlapping, kStep, kRestart };
  struct Place {
    Kind kind = Kind::kNext;
    SensorTime time{0};
    int num_lost = 0;
    bool is_disagreeing = false;
  };

  Place PlaceOf(Utime host_time, const DataPacket& packet) const;
  Place PlaceBehindGap(Utime host_time, const DataPacket& packet, Place place, double num_missing) const;
  bool IsClockSet(Utime host_time, const DataPacket& packet, std::chrono::microseconds difference) const;
  void MeasureRate(const DataPacket& packet, const PlacedPacket& placed);
  double SweepCdeg() const;
  bool IsAt(const DataPacket& packet, double azimuth_cdeg) const;
  bool IsContinuing(const DataPacket& packet) const;
  bool IsKnown(const DataPacket& packet) const;
  void Hold(Utime host_time, const DataPacket& packet, Model model);
  void ReleaseFirst();
  void ReleaseWhatIsNext();
  void Give(Utime host_time, const DataPacket& packet, Model model, const Place& place);

  Handler on_packet_;
  std::optional<PlacedPacket> last_;  // without its payload
  double rate_cdeg_ = 0.0;            // rotation of the head per format::kBlockPeriod, smoothed; 0 = not known, or the head stands
  std::vector<Held> held_;            // by time
  std::array<Known, 512> known_{};    // the last packets that were passed on: more than a revolution
  std::size_t next_known_ = 0;
  std::size_t num_late_in_a_row_ = 0;
  BlindSector blind_sector_;
  SequenceCounts counts_;
};

}  // namespace lookout::vlp16
