// Makes scans of columns of any model: cuts at the configured azimuth, inside packets.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "services/lidar/core/driver/packet_order.hpp"
#include "services/lidar/core/driver/scan.hpp"

namespace lookout::lidar {

class ColumnCutter {
 public:
  /// @param cut_azimuth_rad  a scan begins with the first column at or after it
  /// @param on_scan          called with each scan that has a column; the scan is the cutter's and changes after the call
  ColumnCutter(double cut_azimuth_rad, ScanHandler on_scan);

  /// Cost: proportional to the returns.
  ///
  /// @param placed  has columns; is later than the packet before
  /// @param clock   for a scan that begins in this packet
  void Add(const PlacedColumns& placed, const ClockReading& clock, const PacketCounts& counts);

  /// Later packets do not continue the earlier ones: ends the scan, if there is one.
  void End(const PacketCounts& counts);

  /// Clock of the scan that began last; nullopt before the first.
  const std::optional<ClockReading>& clock() const { return clock_; }

  /// Scans ended for being larger than LIDAR_SCAN holds (the head stands still, or packets lie).
  std::int64_t num_capped() const { return num_capped_; }

  /// Returns that were left out since their range does not fit into 16 bits of the greatest unit.
  std::int64_t num_too_far() const { return num_too_far_; }

 private:
  void Begin(const PlacedColumns& placed, const ClockReading& clock, double azimuth_rad, std::chrono::nanoseconds time);
  void Finish(const PacketCounts& counts);
  void AddLoss(const PlacedColumns& placed, double azimuth_rad, const PacketCounts& counts);
  bool CrossesCut(double azimuth_rad, std::chrono::nanoseconds time) const;
  bool IsFull(std::chrono::nanoseconds time) const;
  void FillRanges();

  double cut_azimuth_rad_;
  ScanHandler on_scan_;
  std::int64_t num_scans_ = 0;
  std::int64_t num_capped_ = 0;
  std::int64_t num_too_far_ = 0;

  std::optional<ClockReading> clock_;
  Scan scan_;  // its ranges are filled in when the scan ends
  std::vector<std::uint32_t> range_;
  bool is_after_cut_ = false;          // the next scan begins at the cut
  int num_lost_before_scan_ = 0;       // packets lost that had columns in the scan that is to begin
  double reach_rad_ = 0.0;             // greatest azimuth so far: by noise of the encoder a column may lie a little before it
  double swept_rad_ = 0.0;             // since the first column
  double advance_rad_ = 0.0;           // from one column to the next, as last seen
  std::chrono::nanoseconds start_{0};  // sensor time of scan_.time
  std::chrono::nanoseconds first_column_{0};
  std::chrono::nanoseconds last_column_{0};
};

}  // namespace lookout::lidar
