// Between the messages of the segmenter and its own types.
#pragma once

#include <optional>
#include <vector>

#include "lookout/lidar_scan_t.hpp"
#include "lookout/segments_t.hpp"
#include "services/segmenter/core/scan.hpp"
#include "services/segmenter/core/segmenter.hpp"

namespace lookout::segmenter {

/// The scan out of its parts.
///
/// @param parts  all of one scan, at least one, by part_index, each without a fault (messages::FaultOf), agreeing about the scan
/// @return nullopt unless they cover the scan, each column once
std::optional<Scan> ToScan(const std::vector<lidar_scan_t>& parts);

/// The segments of a scan in parts: labels as the scan was split, segments in order wherever they fit behind them, then in further parts.
///
/// @param max_message_bytes  of an encoded message; the labels of a part fit, since those of its scan did. Where the pieces of a part do not, all
///                           parts go without pieces
std::vector<segments_t> ToMessages(const Scan& scan, const Segments& segments, int max_message_bytes);

}  // namespace lookout::segmenter
