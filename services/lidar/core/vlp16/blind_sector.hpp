// The part of the circle in which a head with a limited field of view does not fire: returns missing there were never sent.
#pragma once

#include <bitset>
#include <optional>

#include "services/lidar/core/vlp16/data_packet.hpp"

namespace lookout::vlp16 {

/// Learns the sector from the packets: a jump of azimuth inside of a packet cannot be a loss, so one is enough; a jump between packets is taken for
/// a loss until the same has been seen in kNumSightings scans. A shot inside of the sector ends it.
class BlindSector {
 public:
  /// A packet at its place in the stream: where it was looked at, and where it jumped.
  /// @return packets that were counted as lost and were not
  int OnPacket(const DataPacket& packet, const Steps& steps);

  /// A gap between packets in which `num_lost` were missed.
  /// @return packets that were counted as lost, these included, and were not
  int OnLoss(const Gap& gap, int num_lost, int step_cdeg);

  /// @return 0 while there is none
  int WidthCdeg() const { return sector_ ? sector_->width_cdeg() : 0; }

  /// @return the part of the gap in the sector, 0 when the sector does not hold all of it
  int HiddenCdeg(const Gap& gap, int step_cdeg) const;

 private:
  static constexpr int kNumSightings = 3;
  static constexpr int kBinCdeg = 50;
  struct Candidate {
    Gap gap;
    int num_sightings = 0;
    int num_lost = 0;
  };

  bool WasSeenInside(const Gap& gap, int step_cdeg) const;

  std::optional<Gap> sector_;
  std::optional<Candidate> candidate_;
  std::bitset<format::kAzimuthsPerRevolution / kBinCdeg> seen_;  // by azimuth, since the start
};

}  // namespace lookout::vlp16
