// The place of each data packet in sensor time, for any model: restores the order of packets, drops copies and packets that are too late, counts
// missing ones.
#pragma once

#include <array>
#include <bitset>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/core/driver/clock_reading.hpp"
#include "services/lidar/core/driver/sequence.hpp"
#include "services/lidar/core/models/packet_reader.hpp"

namespace lookout::lidar {

/// A packet with its place. `packet` stands during the call that passes it on.
struct PlacedColumns {
  const Packet* packet = nullptr;
  const Head* head = nullptr;
  Utime host_time;                   // arrival of the packet
  std::chrono::nanoseconds time{0};  // SensorTime of the packet's stamp
  int num_lost = 0;                  // packets that are missing before this packet
  bool is_restart = true;            // the packet does not continue earlier packets
};

/// A packet is next when its number follows the last, or, of a sensor without numbers, when its stamp follows the last by that packet's duration.
/// Behind a gap packets are held until the missing ones come, or eight later ones have. A clock that was set while the head went on is told from lost
/// packets by numbers, else by azimuth, and by the host's clock.
class PacketOrder {
 public:
  using Handler = std::function<void(const PlacedColumns&)>;

  static constexpr std::size_t kMaxHeld = 8;

  explicit PacketOrder(Handler on_packet) : on_packet_(std::move(on_packet)) {}

  /// @param head  stands as long as this object
  PacketVerdict Add(Utime host_time, const Packet& packet, const Head& head);

  /// End of input: passes on the held packets.
  void Flush();

  /// Sensor time of a stamp past the hour; nullopt when no data packet came within a second of it by the host's clock.
  std::optional<SensorTime> TimeOfStamp(Utime host_time, std::chrono::microseconds stamp) const;

  const SequenceCounts& counts() const { return counts_; }

 private:
  enum class Kind { kNext, kMissing, kLate, kDuplicate, kOverlapping, kStep, kRestart };
  struct Place {
    Kind kind = Kind::kNext;
    std::chrono::nanoseconds time{0};
    int num_lost = 0;
  };
  // A packet without its returns.
  struct Mark {
    std::chrono::nanoseconds stamp{0};
    std::chrono::nanoseconds duration{0};
    std::optional<PacketNumber> number;
    bool has_columns = false;
    double first_azimuth_rad = 0.0;
    double last_azimuth_rad = 0.0;
    std::chrono::nanoseconds last_column{0};  // since the stamp
    StampKind stamp_kind = StampKind::kAbsolute;
  };
  struct Last {
    Mark mark;
    Utime host_time;
    std::chrono::nanoseconds time{0};
  };
  struct Held {
    Utime host_time;
    Packet packet;
    const Head* head = nullptr;
  };
  struct Known {
    std::chrono::nanoseconds stamp{-1};
    double first_azimuth_rad = -1.0;
  };
  // Where a head of a limited field of view fires nothing: known by three gaps at the same place, where no shot of the run ever was.
  struct DarkSector {
    double from_rad = 0.0;
    double to_rad = 0.0;
    int num_seen = 0;
    int num_counted = 0;  // as lost, before the sector was known
  };

  static Mark MarkOf(const Packet& packet, const Head& head);
  Place PlaceOf(Utime host_time, const Mark& mark) const;
  std::optional<Place> PlaceByNumber(Utime host_time, const Mark& mark, std::chrono::nanoseconds difference) const;
  bool IsClockSet(Utime host_time, std::chrono::nanoseconds expected, std::chrono::nanoseconds difference) const;
  bool IsContinuing(const Mark& mark) const;
  double EndAzimuth() const;
  bool IsKnown(const Mark& mark) const;
  void PassEmpty(Utime host_time, const Packet& packet);
  void SkipEmpty();
  int NumEmptyBefore(const PacketNumber& number);
  void Hold(Utime host_time, const Packet& packet, const Head& head);
  void ReleaseFirst();
  void ReleaseWhatIsNext();
  void Give(Utime host_time, const Packet& packet, const Head& head, const Place& place);
  int LostOfGap(const Mark& mark, int num_missing);
  bool HasFiredInside(double from_rad, double to_rad) const;
  void NoteFired(const Packet& packet);

  Handler on_packet_;
  std::optional<Last> last_;
  double rate_radps_ = 0.0;  // of the head, smoothed; 0 = not known
  std::vector<Held> held_;   // by time
  std::array<Known, 512> known_{};
  std::size_t next_known_ = 0;
  std::size_t num_late_in_a_row_ = 0;
  std::vector<DarkSector> dark_;
  static constexpr double kBinRad = kTwoPi / 3600.0;
  std::bitset<3600> fired_;                 // by azimuth, since the last restart
  std::vector<std::uint64_t> empty_ahead_;  // numbers of packets without a good column that came ahead of their turn; by arrival
  SequenceCounts counts_;
};

}  // namespace lookout::lidar
