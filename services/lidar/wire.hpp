// Between the messages of the lidar process and its own types.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lookout/lidar_clock_t.hpp"
#include "lookout/lidar_nmea_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/lidar/core/driver/bundler.hpp"
#include "services/lidar/core/driver/decoder.hpp"
#include "services/lidar/core/driver/scan.hpp"

namespace lookout::lidar {

lidar_packets_t ToMessage(const PacketBundle& bundle);

/// @return nullopt unless the whole message is valid: counts that agree, at most Bundler::kMaxItems payloads, times and marks that exist.
///         What is inside the payloads is not checked.
std::optional<PacketBundle> ToBundle(const lidar_packets_t& message);

lidar_nmea_t ToMessage(const SentenceOfLidar& sentence, std::int64_t seq, std::int64_t raw_seq);

lidar_clock_t ToClockMessage(const Scan& scan, std::int64_t raw_seq);

/// @param max_message_bytes  of an encoded message: a larger scan goes in parts of about the same number of columns
std::vector<lidar_scan_t> ToScanMessages(const Scan& scan, std::int64_t raw_seq, int max_message_bytes);

}  // namespace lookout::lidar
