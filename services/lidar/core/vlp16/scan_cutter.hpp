// Makes scans of data packets: computes azimuth and time of each column and cuts at the configured azimuth, inside packets.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "services/lidar/core/driver/scan.hpp"
#include "services/lidar/core/vlp16/data_packet.hpp"
#include "services/lidar/core/vlp16/packet_sequencer.hpp"

namespace lookout::vlp16 {

using lidar::ClockReading;
using lidar::PacketCounts;
using lidar::Scan;

class ScanCutter {
 public:
  /// @param cut_azimuth_rad  a scan begins with the first column at or after it; resolution 0.005 deg, as of columns
  /// @param use_vertical_origin_offsets  of the heads of the scans
  /// @param on_scan          called with each scan that has a column; the scan is the cutter's and changes after the call
  ScanCutter(double cut_azimuth_rad, bool use_vertical_origin_offsets, std::function<void(const Scan&)> on_scan);

  /// Cost: proportional to the returns; no trigonometry.
  ///
  /// @param placed  is later than the packet before
  /// @param clock   for a scan that begins in this packet
  void Add(const PlacedPacket& placed, const ClockReading& clock, const PacketCounts& counts);

  /// Later packets do not continue the earlier ones: ends the scan, if there is one.
  void End(const PacketCounts& counts);

  /// Clock of the scan that began last; nullopt before the first.
  const std::optional<ClockReading>& clock() const { return clock_; }

  /// Scans ended for being larger than any scan of this sensor (it stands still, or packets lie).
  std::int64_t num_capped() const { return num_capped_; }

 private:
  void Begin(const PlacedPacket& placed, const ClockReading& clock, int azimuth_half_cdeg, int advance_half_cdeg, std::chrono::nanoseconds time);
  void Finish(const PacketCounts& counts);
  void AddColumn(const DataPacket& packet, int step, int sequence, int azimuth_half_cdeg, int gap_cdeg, std::chrono::nanoseconds time);
  void AddLoss(const PlacedPacket& placed, int azimuth_half_cdeg, const PacketCounts& counts);
  bool CrossesCut(int azimuth_half_cdeg, std::chrono::nanoseconds time) const;
  void Resize(int num_columns);

  int cut_half_cdeg_;
  bool use_vertical_origin_offsets_;
  std::function<void(const Scan&)> on_scan_;
  std::int64_t num_scans_ = 0;
  std::int64_t num_capped_ = 0;
  int last_gap_cdeg_ = 0;  // rotation of the head per step in the last packet

  std::optional<ClockReading> clock_;
  Model model_ = Model::kVlp16;  // of the scan that is being made
  ReturnMode mode_ = ReturnMode::kStrongest;
  const Beams* beams_ = &BeamsOf(Model::kVlp16);  // of the scan that is being made
  Scan scan_;                                     // while the scan is being made its arrays have room for more than num_columns_
  int num_columns_ = 0;                           // 0 = no scan has begun
  int capacity_columns_ = 0;
  bool is_after_cut_ = false;          // the next scan begins at the cut
  int num_lost_before_scan_ = 0;       // packets lost that had columns in the scan that is to begin
  int reach_half_cdeg_ = 0;            // greatest azimuth so far: by noise of the encoder a column may lie a little before it
  int advance_half_cdeg_ = 0;          // of the last column to the next
  std::int64_t sum_gap_cdeg_ = 0;      // of the columns of this scan
  std::chrono::nanoseconds start_{0};  // sensor time of scan_.time
  std::chrono::nanoseconds last_column_{0};
};

}  // namespace lookout::vlp16
