// A scan of a recording as the messages that any lidar's driver would publish.
#pragma once

#include <string>
#include <vector>

#include "lookout/lidar_scan_t.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::data {

/// LIDAR_SCAN in parts split by columns, none larger than `max_message_bytes` unless a single column is. Times are by the computer's clock: clouds of
/// other programs have no time by the sensor.
///
/// @param model  printable ASCII
std::vector<lidar_scan_t> ToScanMessages(const segmenter::Scan& scan, const std::string& model, int max_message_bytes);

}  // namespace lookout::data
