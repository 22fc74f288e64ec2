#include "services/lidar/wire.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "common/core/angles.hpp"
#include "common/core/utime.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::microseconds;

constexpr int kMaxUdpPort = 65535;

template <typename T>
std::int32_t Count(const std::vector<T>& values) {
  return static_cast<std::int32_t>(values.size());
}

std::int32_t ToWire(TimeSource source, std::int32_t host, std::int32_t sensor) { return source == TimeSource::kHost ? host : sensor; }

// In the order of the wire.
std::int32_t ToWire(ClockState state) { return static_cast<std::int32_t>(state); }
static_assert(static_cast<int>(ClockState::kUnknown) == lidar_clock_t::STATE_UNKNOWN &&
              static_cast<int>(ClockState::kNoPps) == lidar_clock_t::STATE_NO_PPS &&
              static_cast<int>(ClockState::kAcquiring) == lidar_clock_t::STATE_ACQUIRING &&
              static_cast<int>(ClockState::kLockedWithoutTime) == lidar_clock_t::STATE_LOCKED_WITHOUT_TIME &&
              static_cast<int>(ClockState::kLocked) == lidar_clock_t::STATE_LOCKED &&
              static_cast<int>(ClockState::kFreeRunning) == lidar_clock_t::STATE_FREE_RUNNING &&
              static_cast<int>(ClockState::kError) == lidar_clock_t::STATE_ERROR);

std::int32_t ToWire(ReturnKind kind) { return static_cast<std::int32_t>(kind) + 1; }
static_assert(static_cast<int>(ReturnKind::kStrongest) + 1 == lidar_scan_t::RETURN_STRONGEST &&
              static_cast<int>(ReturnKind::kLast) + 1 == lidar_scan_t::RETURN_LAST &&
              static_cast<int>(ReturnKind::kFirst) + 1 == lidar_scan_t::RETURN_FIRST &&
              static_cast<int>(ReturnKind::kSecond) + 1 == lidar_scan_t::RETURN_SECOND);

// All of a scan but its columns.
lidar_scan_t ScanHead(const Scan& scan, std::int64_t raw_seq) {
  lidar_scan_t message{};
  message.utime_us = ToUtimeUs(scan.time);
  message.seq = scan.number;
  message.raw_seq = raw_seq;
  message.end_utime_us = ToUtimeUs(scan.end_time);
  message.flags = (scan.is_partial_start ? lidar_scan_t::FLAG_PARTIAL_START : 0) | (scan.is_partial_end ? lidar_scan_t::FLAG_PARTIAL_END : 0) |
                  (scan.has_hole ? lidar_scan_t::FLAG_HOLE : 0);
  message.num_lost_packets = scan.num_lost_packets;
  message.time_source = ToWire(scan.clock.source, lidar_scan_t::TIME_HOST, lidar_scan_t::TIME_SENSOR);
  const Head& head = *scan.head;
  message.model = head.model;
  message.range_unit_m = scan.range_unit_m;
  for (const auto& beam : head.beams) {
    message.elevation_rad.push_back(static_cast<float>(beam.elevation_rad));
    message.azimuth_offset_rad.push_back(static_cast<float>(beam.azimuth_offset_rad + scan.rate_radps * ToSeconds(beam.turning_time)));
    message.time_offset_ns.push_back(static_cast<std::int32_t>(beam.time_offset.count()));
    message.origin_height_m.push_back(static_cast<float>(beam.origin_height_m));
  }
  message.num_rings = Count(message.elevation_rad);
  for (const auto kind : head.returns) message.return_kind.push_back(ToWire(kind));
  message.num_returns = Count(message.return_kind);
  message.num_turn_columns = scan.num_columns();
  return message;
}

}  // namespace

lidar_packets_t ToMessage(const PacketBundle& bundle) {
  lidar_packets_t message{};
  message.utime_us = ToUtimeUs(bundle.time);
  message.seq = bundle.seq;
  message.marks = (bundle.is_start ? lidar_packets_t::MARK_START : 0) | (bundle.is_end ? lidar_packets_t::MARK_END : 0);
  for (const auto& item : bundle.items) {
    message.host_utime_us.push_back(ToUtimeUs(item.host_time));
    message.udp_port.push_back(item.udp_port);
    message.size_bytes.push_back(static_cast<std::int32_t>(item.size_bytes));
  }
  message.num_packets = Count(message.host_utime_us);
  message.payload = bundle.payload;
  message.num_bytes = Count(message.payload);
  return message;
}

std::optional<PacketBundle> ToBundle(const lidar_packets_t& message) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto num_items = message.host_utime_us.size();
  if (!time || message.seq < 0 || (message.marks & ~std::int32_t{lidar_packets_t::MARK_START} & ~std::int32_t{lidar_packets_t::MARK_END}) != 0)
    return std::nullopt;
  if (num_items > Bundler::kMaxItems || message.udp_port.size() != num_items || message.size_bytes.size() != num_items) return std::nullopt;
  PacketBundle bundle;
  bundle.time = *time;
  bundle.seq = message.seq;
  bundle.is_start = (message.marks & lidar_packets_t::MARK_START) != 0;
  bundle.is_end = (message.marks & lidar_packets_t::MARK_END) != 0;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < num_items; ++i) {
    const auto host_time = UtimeFromWire(message.host_utime_us[i]);
    if (!host_time || message.udp_port[i] < 0 || message.udp_port[i] > kMaxUdpPort || message.size_bytes[i] < 0) return std::nullopt;
    const auto size_bytes = static_cast<std::size_t>(message.size_bytes[i]);
    if (size_bytes > message.payload.size() - offset) return std::nullopt;
    bundle.items.push_back({*host_time, message.udp_port[i], offset, size_bytes});
    offset += size_bytes;
  }
  if (offset != message.payload.size()) return std::nullopt;
  bundle.payload = message.payload;
  return bundle;
}

lidar_nmea_t ToMessage(const SentenceOfLidar& sentence, std::int64_t seq, std::int64_t raw_seq) {
  lidar_nmea_t message{};
  message.utime_us = ToUtimeUs(sentence.time);
  message.seq = seq;
  message.raw_seq = raw_seq;
  message.host_utime_us = ToUtimeUs(sentence.host_time);
  message.sensor_past_hour_us = sentence.stamp_us;
  message.pps = sentence.pps;
  message.sentence = sentence.text;
  return message;
}

lidar_clock_t ToClockMessage(const Scan& scan, std::int64_t raw_seq) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  constexpr double kSecondsPerMinute = 60.0;
  const auto& clock = scan.clock;
  lidar_clock_t message{};
  message.utime_us = ToUtimeUs(scan.time);
  message.seq = scan.number;
  message.raw_seq = raw_seq;
  message.time_source = ToWire(clock.source, lidar_clock_t::TIME_HOST, lidar_clock_t::TIME_SENSOR);
  message.state = ToWire(clock.state);
  message.pps = clock.pps.value_or(-1);
  message.rmc_age_us = clock.rmc_age.value_or(microseconds(-1)).count();
  message.offset_s = clock.host_minus_sensor ? ToSeconds(*clock.host_minus_sensor) : kUnknown;
  message.drift_ppm = clock.drift_ppm.value_or(kUnknown);
  message.rotation_rpm = scan.rate_radps / kTwoPi * kSecondsPerMinute;
  message.num_packets = scan.counts.num_packets;
  message.num_lost_packets = scan.counts.num_lost;
  message.num_duplicate_packets = scan.counts.num_duplicates;
  message.num_reordered_packets = scan.counts.num_reordered;
  return message;
}

std::vector<lidar_scan_t> ToScanMessages(const Scan& scan, std::int64_t raw_seq, int max_message_bytes) {
  const lidar_scan_t head = ScanHead(scan, raw_seq);
  const int cells_per_column = head.num_rings * head.num_returns;
  const int column_bytes =
      static_cast<int>(sizeof(float) + sizeof(std::int32_t)) + cells_per_column * static_cast<int>(sizeof(std::int16_t) + sizeof(std::uint8_t));
  const int max_columns = std::max(1, (max_message_bytes - head.getEncodedSize()) / column_bytes);
  const int num_parts = (scan.num_columns() + max_columns - 1) / max_columns;
  const int part_columns = (scan.num_columns() + num_parts - 1) / num_parts;
  std::vector<lidar_scan_t> messages;
  for (int part = 0; part < num_parts; ++part) {
    lidar_scan_t& message = messages.emplace_back(head);
    message.part_index = part;
    message.num_parts = num_parts;
    message.first_column = part * part_columns;
    const int end_column = std::min(message.first_column + part_columns, scan.num_columns());
    message.azimuth_rad.assign(scan.azimuth_rad.begin() + message.first_column, scan.azimuth_rad.begin() + end_column);
    message.time_ns.assign(scan.time_ns.begin() + message.first_column, scan.time_ns.begin() + end_column);
    message.num_columns = Count(message.azimuth_rad);
    const auto first_cell = message.first_column * cells_per_column;
    const auto end_cell = end_column * cells_per_column;
    message.range.assign(scan.range.begin() + first_cell, scan.range.begin() + end_cell);
    message.reflectivity.assign(scan.reflectivity.begin() + first_cell, scan.reflectivity.begin() + end_cell);
    message.num_cells = Count(message.range);
  }
  return messages;
}

}  // namespace lookout::lidar
