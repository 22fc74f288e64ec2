// LIDAR_SCAN messages of test scans.
#pragma once

#include <algorithm>
#include <bit>
#include <vector>

#include "lookout/lidar_scan_t.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter::test {

inline std::vector<lidar_scan_t> ScanMessages(const Scan& scan, std::int64_t seq, int num_parts) {
  std::vector<lidar_scan_t> messages;
  const int cells_per_column = scan.head.num_rings() * scan.head.num_returns;
  const int num_columns = scan.columns.size();
  for (int part = 0; part < num_parts; ++part) {
    auto& message = messages.emplace_back();
    message = {};
    message.utime_us = ToUtimeUs(scan.head.time);
    message.end_utime_us = ToUtimeUs(scan.head.end_time);
    message.seq = seq;
    message.raw_seq = seq + 5;
    message.flags = lidar_scan_t::FLAG_HOLE;
    message.part_index = part;
    message.num_parts = num_parts;
    message.time_source = lidar_scan_t::TIME_SENSOR;
    message.model = "VLP-16";
    message.range_unit_m = scan.head.range_unit_m;
    message.num_rings = scan.head.num_rings();
    for (const auto& ring : scan.head.rings) {
      message.elevation_rad.push_back(ring.elevation_rad);
      message.azimuth_offset_rad.push_back(ring.azimuth_offset_rad);
      message.time_offset_ns.push_back(ring.time_offset_ns);
      message.origin_height_m.push_back(ring.origin_height_m);
    }
    message.num_returns = scan.head.num_returns;
    message.return_kind.assign(static_cast<std::size_t>(message.num_returns), lidar_scan_t::RETURN_STRONGEST);
    message.num_turn_columns = num_columns;
    message.first_column = num_columns * part / num_parts;
    const int end_column = num_columns * (part + 1) / num_parts;
    message.num_columns = end_column - message.first_column;
    message.azimuth_rad.assign(scan.columns.azimuth_rad.begin() + message.first_column, scan.columns.azimuth_rad.begin() + end_column);
    message.time_ns.assign(scan.columns.time_ns.begin() + message.first_column, scan.columns.time_ns.begin() + end_column);
    const int first_cell = message.first_column * cells_per_column;
    const int end_cell = end_column * cells_per_column;
    message.num_cells = end_cell - first_cell;
    message.range.resize(static_cast<std::size_t>(message.num_cells));
    std::transform(scan.columns.range.begin() + first_cell, scan.columns.range.begin() + end_cell, message.range.begin(),
                   [](std::uint16_t count) { return std::bit_cast<std::int16_t>(count); });
    message.reflectivity.assign(scan.columns.reflectivity.begin() + first_cell, scan.columns.reflectivity.begin() + end_cell);
  }
  return messages;
}

}  // namespace lookout::segmenter::test
