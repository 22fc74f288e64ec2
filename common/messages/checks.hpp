// Checks of the messages of a scan: LIDAR_SCAN, SEGMENTS, OBSTACLES, TRACKS, ALERTS, and of ALERT_ACK and ORDERS. A service uses messages without
// FaultOf; a tool, which also shows messages that a service refuses, asks IsWellFormed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "lookout/alert_ack_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/order_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/tracks_t.hpp"

namespace lookout::messages {

/// Whether the time exists, part_index lies below num_parts, no more parts than kMax... are announced, and the counts agree, so that every array may
/// be read by them.
bool IsWellFormed(const lidar_scan_t& message);
bool IsWellFormed(const segments_t& message);
bool IsWellFormed(const obstacles_t& message);
bool IsWellFormed(const tracks_t& message);

/// The fault of a message: the name of the counter of its refusals.
using Fault = std::string_view;

inline constexpr Fault kScanTime = "refused_time";             // utime out of bounds, or the end before the begin
inline constexpr Fault kScanCounts = "refused_counts";         // counts do not agree with the arrays or with each other
inline constexpr Fault kScanSize = "refused_size";             // more rings, returns, columns or cells than kMax..., or too large a message
inline constexpr Fault kScanBeams = "refused_beams";           // angles or height of a ring not finite or out of range, or not from the lowest up
inline constexpr Fault kScanRangeUnit = "refused_range_unit";  // not above 0, above 1 m, or not finite
inline constexpr Fault kScanPart = "refused_part";             // no such part, num_parts above 1000, or columns outside of the scan
inline constexpr Fault kScanAzimuth = "refused_azimuth";       // of a column, not in [0, 2 pi]
inline constexpr std::array kScanFaults{kScanTime, kScanCounts, kScanSize, kScanBeams, kScanRangeUnit, kScanPart, kScanAzimuth};

inline constexpr Fault kSegmentsTime = "segments_refused_time";      // does not exist, lies outside of its scan, or the scan is longer than 60 s
inline constexpr Fault kSegmentsParts = "segments_refused_parts";    // part_index, num_parts (above 1000), seq
inline constexpr Fault kSegmentsCount = "segments_refused_count";    // counts that do not agree
inline constexpr Fault kSegmentsId = "segments_refused_id";          // ids that do not increase, or are not in the scan
inline constexpr Fault kSegmentsNumber = "segments_refused_number";  // not finite, beyond 100 km, or a share or probability not in 0 to 1
inline constexpr Fault kSegmentsCode = "segments_refused_code";      // a confidence, ground or kind that does not exist
inline constexpr Fault kSegmentsSize = "segments_refused_size";      // larger than a message may be
inline constexpr std::array kSegmentsFaults{kSegmentsTime,   kSegmentsParts, kSegmentsCount, kSegmentsId,
                                            kSegmentsNumber, kSegmentsCode,  kSegmentsSize};

inline constexpr Fault kObstaclesTime = "obstacles_refused_time";    // does not exist, lies outside of its scan, or the scan is longer than 60 s
inline constexpr Fault kObstaclesParts = "obstacles_refused_parts";  // part_index, num_parts (above 2000), seq
inline constexpr Fault kObstaclesCount = "obstacles_refused_count";  // counts that do not agree; no corner
inline constexpr Fault kObstaclesId = "obstacles_refused_id";        // ids that do not increase
inline constexpr Fault kObstaclesNumber =
    "obstacles_refused_number";  // a value that the status says is known is not, or is no place, share or probability
inline constexpr Fault kObstaclesCovariance = "obstacles_refused_covariance";  // not a covariance; one that is not known is none
inline constexpr Fault kObstaclesCode = "obstacles_refused_code";              // a status, confidence, ground or kind that does not exist
inline constexpr Fault kObstaclesSize = "obstacles_refused_size";              // larger than a message may be
inline constexpr std::array kObstaclesFaults{kObstaclesTime,   kObstaclesParts,      kObstaclesCount, kObstaclesId,
                                             kObstaclesNumber, kObstaclesCovariance, kObstaclesCode,  kObstaclesSize};

inline constexpr Fault kAckTime = "acks_refused_time";      // its time, or that of its alert, does not exist
inline constexpr Fault kAckId = "acks_refused_id";          // 0: no alert has it
inline constexpr Fault kAckSource = "acks_refused_source";  // more than 64 bytes
inline constexpr std::array kAckFaults{kAckTime, kAckId, kAckSource};

inline constexpr Fault kOrderTime = "orders_refused_time";      // does not exist
inline constexpr Fault kOrderKind = "orders_refused_kind";      // a kind or mode that does not exist
inline constexpr Fault kOrderNumber = "orders_refused_number";  // infinite, or a range or limit below 0
inline constexpr Fault kOrderSource = "orders_refused_source";  // more than 64 bytes
inline constexpr Fault kOrderName = "orders_refused_name";      // of no track, or no line of UTF-8 of at most 40 bytes, or only spaces
inline constexpr std::array kOrderFaults{kOrderTime, kOrderKind, kOrderNumber, kOrderSource, kOrderName};

/// Bounds of a scan: 65 536 columns and 2^21 cells are more than any scan of a known lidar has (128 rings x 2 returns x 4096 columns make 2^20).
inline constexpr int kMaxRings = 128;
inline constexpr int kMaxReturns = 2;
inline constexpr int kMaxScanColumns = 65'536;
inline constexpr std::int64_t kMaxScanCells = std::int64_t{1} << 21;

/// Bounds of num_parts, so that waiting for parts needs bounded memory. A scan of kMaxScanCells takes less than 100 messages.
inline constexpr std::int32_t kMaxParts = 1000;                    // LIDAR_SCAN, SEGMENTS, TRACKS
inline constexpr std::int32_t kMaxObstaclesParts = 2 * kMaxParts;  // georeferencer makes at most two out of one of SEGMENTS

/// @return the first fault of a message; nullopt where there is none
std::optional<Fault> FaultOf(const lidar_scan_t& message, int max_message_bytes);
std::optional<Fault> FaultOf(const segments_t& message, int max_message_bytes);
std::optional<Fault> FaultOf(const obstacles_t& message, int max_message_bytes);
std::optional<Fault> FaultOf(const alert_ack_t& message);
std::optional<Fault> FaultOf(const order_t& message);

/// The count of an array, as a message says it.
template <typename T>
std::int32_t CountOf(const std::vector<T>& values) {
  return static_cast<std::int32_t>(values.size());
}

/// Whether two parts of one scan agree in the members of the whole scan.
bool AgreeAboutScan(const lidar_scan_t& one, const lidar_scan_t& other);
bool AgreeAboutScan(const segments_t& one, const segments_t& other);
bool AgreeAboutScan(const obstacles_t& one, const obstacles_t& other);

/// Whether a scan does not begin or does not end at the cut: flags of lidar_scan_t.
bool IsCut(std::int32_t scan_flags);

}  // namespace lookout::messages
