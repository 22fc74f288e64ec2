// What becomes of packets that come out of order, twice, late or never.
#pragma once

#include <cstdint>

namespace lookout::lidar {

enum class PacketVerdict {
  kTaken,  // passed on, or held until it is known whether the packet before comes
  kDuplicate,
  kLate,         // packets behind it were passed on already
  kOverlapping,  // less than half a period after the last packet and elsewhere in azimuth: one sensor alone does not send so
};

struct SequenceCounts {
  std::int64_t num_lost = 0;
  std::int64_t num_duplicates = 0;
  std::int64_t num_reordered = 0;  // came after a later packet: put into order, or dropped as late
  std::int64_t num_late = 0;
  std::int64_t num_overlapping = 0;
  std::int64_t num_restarts = 0;       // after the first packet
  std::int64_t num_clock_steps = 0;    // the sensor's clock was set while the head went on
  std::int64_t num_disagreements = 0;  // azimuth and sensor time tell of different losses; time was believed
};

inline SequenceCounts& operator+=(SequenceCounts& sum, const SequenceCounts& counts) {
  sum.num_lost += counts.num_lost;
  sum.num_duplicates += counts.num_duplicates;
  sum.num_reordered += counts.num_reordered;
  sum.num_late += counts.num_late;
  sum.num_overlapping += counts.num_overlapping;
  sum.num_restarts += counts.num_restarts;
  sum.num_clock_steps += counts.num_clock_steps;
  sum.num_disagreements += counts.num_disagreements;
  return sum;
}

}  // namespace lookout::lidar
