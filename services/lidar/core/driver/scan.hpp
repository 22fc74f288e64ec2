// One scan of the head: columns (firings of all beams) x rings (lowest beam first) x returns of a shot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/core/utime.hpp"
#include "services/lidar/core/driver/clock_reading.hpp"
#include "services/lidar/core/models/packet_reader.hpp"

namespace lookout::lidar {

/// Data packets since the start.
struct PacketCounts {
  std::int64_t num_packets = 0;  // whole packets of a known model, also packets dropped as duplicates or late
  std::int64_t num_lost = 0;
  std::int64_t num_duplicates = 0;
  std::int64_t num_reordered = 0;
};

struct Scan {
  std::int64_t number = 0;        // since the start
  Utime time;                     // of the first column, rounded down
  Utime end_time;                 // of the last shot, rounded down
  const Head* head = nullptr;     // never null in a scan that is passed on; stands as long as the decoder
  bool is_partial_start = false;  // does not begin at the cut
  bool is_partial_end = false;    // does not end at the cut
  bool has_hole = false;          // packets were lost inside
  int num_lost_packets = 0;       // lost packets that had columns in this scan
  double rate_radps = 0.0;        // mean rate of rotation of the head
  double range_unit_m = 0.0;      // metres per count of `range`: the head's, or a multiple where the farthest return needs it
  ClockReading clock;             // at the first column
  PacketCounts counts;            // at the packet that ended the scan

  std::vector<float> azimuth_rad;          // [columns] of a beam without offset, in [0, 2 pi)
  std::vector<std::int32_t> time_ns;       // [columns] since `time`
  std::vector<std::uint16_t> range;        // [columns x rings x returns] in range_unit_m; 0 = no return
  std::vector<std::uint8_t> reflectivity;  // [columns x rings x returns]; 0 where there is no return

  int num_columns() const { return static_cast<int>(azimuth_rad.size()); }
  int num_returns() const { return head == nullptr ? 1 : static_cast<int>(head->returns.size()); }
};

using ScanHandler = std::function<void(const Scan&)>;

}  // namespace lookout::lidar
