// Between the messages of the segmenter and its own types.
#pragma once

#include <array>
#include <string_view>
#include <variant>
#include <vector>

#include "lookout/lidar_scan_t.hpp"
#include "lookout/segments_t.hpp"
#include "services/segmenter/core/scan.hpp"
#include "services/segmenter/core/segmenter.hpp"

namespace lookout::segmenter {

/// What is wrong with a message, as it is counted.
enum class Refusal { kTime, kCounts, kSize, kBeams, kRangeUnit, kPart, kAzimuth };

/// Names of the counters, by Refusal.
inline constexpr std::array<std::string_view, 7> kRefusalNames{"refused_time",       "refused_counts", "refused_size",   "refused_beams",
                                                               "refused_range_unit", "refused_part",   "refused_azimuth"};

/// Bounds of a turn: 65 536 columns and cells are more than any turn of a known lidar has (128 rings x 2 returns x 4096 columns make 2^20).
inline constexpr int kMaxRings = 128;
inline constexpr int kMaxReturns = 2;
inline constexpr int kMaxTurnColumns = 65'536;
inline constexpr std::int64_t kMaxTurnCells = std::int64_t{1} << 21;

/// The part of a turn that a message holds, or why the whole message is refused:
/// kTime: utime out of bounds, or the end before the begin. kCounts: counts do not agree with the arrays or with each other. kSize: more rings,
/// returns, columns or cells than kMax..., or a message larger than `max_message_bytes`. kBeams: elevation, azimuth offset or height of a ring not
/// finite, out of range, or rings not from the lowest up. kRangeUnit: not above 0, or not finite. kPart: no such part, or columns outside of the
/// turn. kAzimuth: of a column, not in [0, 2 pi].
std::variant<ScanPart, Refusal> ToScanPart(const lidar_scan_t& message, int max_message_bytes);

/// The segments of a turn in parts: labels as the scan was split, segments in order wherever they fit behind them, then in further parts.
///
/// @param max_message_bytes  of an encoded message; the labels of a part fit, since those of its scan did (ToScanPart)
std::vector<segments_t> ToMessages(const Scan& scan, const Segments& segments, int max_message_bytes);

}  // namespace lookout::segmenter
