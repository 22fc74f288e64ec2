#include "lab/data/scan_message.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace lookout::data {

namespace {

template <typename T>
std::int32_t Count(const std::vector<T>& values) {
  return static_cast<std::int32_t>(values.size());
}

lidar_scan_t HeadOf(const segmenter::Scan& scan, const std::string& model) {
  lidar_scan_t message{};
  message.utime_us = ToUtimeUs(scan.head.time);
  message.seq = scan.head.seq;
  message.raw_seq = scan.head.raw_seq;
  message.end_utime_us = ToUtimeUs(scan.head.end_time);
  message.flags = scan.head.flags;
  message.time_source = lidar_scan_t::TIME_HOST;
  message.model = model;
  message.range_unit_m = scan.head.range_unit_m;
  for (const auto& ring : scan.head.rings) {
    message.elevation_rad.push_back(ring.elevation_rad);
    message.azimuth_offset_rad.push_back(ring.azimuth_offset_rad);
    message.time_offset_ns.push_back(ring.time_offset_ns);
    message.origin_height_m.push_back(ring.origin_height_m);
  }
  message.num_rings = Count(message.elevation_rad);
  message.return_kind.assign(static_cast<std::size_t>(scan.head.num_returns), lidar_scan_t::RETURN_STRONGEST);
  message.num_returns = Count(message.return_kind);
  message.num_turn_columns = scan.columns.size();
  return message;
}

}  // namespace

std::vector<lidar_scan_t> ToScanMessages(const segmenter::Scan& scan, const std::string& model, int max_message_bytes) {
  const auto head = HeadOf(scan, model);
  const int cells_per_column = head.num_rings * head.num_returns;
  const int column_bytes =
      static_cast<int>(sizeof(float) + sizeof(std::int32_t)) + cells_per_column * static_cast<int>(sizeof(std::int16_t) + sizeof(std::uint8_t));
  const int num_columns = scan.columns.size();
  const int max_columns = std::max(1, (max_message_bytes - head.getEncodedSize()) / column_bytes);
  const int num_parts = std::max(1, (num_columns + max_columns - 1) / max_columns);
  std::vector<lidar_scan_t> messages;
  for (int part = 0; part < num_parts; ++part) {
    auto& message = messages.emplace_back(head);
    message.part_index = part;
    message.num_parts = num_parts;
    // 65 536 columns times 65 536 parts would not fit into 32 bits.
    const auto column_at = [&](std::int64_t of_part) { return static_cast<int>(of_part * num_columns / num_parts); };
    message.first_column = column_at(part);
    const int end_column = column_at(part + 1);
    message.azimuth_rad.assign(scan.columns.azimuth_rad.begin() + message.first_column, scan.columns.azimuth_rad.begin() + end_column);
    message.time_ns.assign(scan.columns.time_ns.begin() + message.first_column, scan.columns.time_ns.begin() + end_column);
    message.num_columns = Count(message.azimuth_rad);
    const auto first_cell = static_cast<std::ptrdiff_t>(message.first_column) * cells_per_column;
    const auto end_cell = static_cast<std::ptrdiff_t>(end_column) * cells_per_column;
    message.range.resize(static_cast<std::size_t>(end_cell - first_cell));
    std::transform(scan.columns.range.begin() + first_cell, scan.columns.range.begin() + end_cell, message.range.begin(),
                   [](std::uint16_t count) { return std::bit_cast<std::int16_t>(count); });
    message.reflectivity.assign(scan.columns.reflectivity.begin() + first_cell, scan.columns.reflectivity.begin() + end_cell);
    message.num_cells = Count(message.range);
  }
  return messages;
}

}  // namespace lookout::data
