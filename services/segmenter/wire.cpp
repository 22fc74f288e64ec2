#include "services/segmenter/wire.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::segmenter {

namespace {

static_assert(static_cast<int>(Reason::kRange) == segments_t::REASON_RANGE);
static_assert(static_cast<int>(Reason::kOwnVessel) == segments_t::REASON_OWN_VESSEL);
static_assert(static_cast<int>(Reason::kFieldOfView) == segments_t::REASON_FIELD_OF_VIEW);
static_assert(static_cast<int>(Reason::kShadowed) == segments_t::REASON_SHADOWED);
static_assert(static_cast<int>(Reason::kTooSmall) == segments_t::REASON_TOO_SMALL);
static_assert(static_cast<int>(Confidence::kTentative) == segment_t::CONFIDENCE_TENTATIVE);
static_assert(static_cast<int>(Confidence::kSure) == segment_t::CONFIDENCE_SURE);
static_assert(static_cast<int>(Ground::kFewReturns) == segment_t::GROUND_FEW_RETURNS);
static_assert(static_cast<int>(Ground::kScattered) == segment_t::GROUND_SCATTERED);
static_assert(static_cast<int>(Ground::kAtSurface) == segment_t::GROUND_AT_SURFACE);
static_assert(static_cast<int>(SegmentKind::kObstacle) == segment_t::KIND_OBSTACLE);
static_assert(static_cast<int>(SegmentKind::kLand) == segment_t::KIND_LAND);

// A beam starts inside of the sensor.
constexpr float kMaxOriginHeightM = 10.0F;
// 65 535 counts of a metre are more than any lidar sees.
constexpr double kMaxRangeUnitM = 1.0;

template <typename T>
std::int32_t Count(const std::vector<T>& values) {
  return static_cast<std::int32_t>(values.size());
}

bool IsWithin(float value, float least, float greatest) { return value >= least && value <= greatest; }  // false for NaN

bool CountsAgree(const lidar_scan_t& message) {
  const auto num_cells = std::int64_t{message.num_columns} * message.num_rings * message.num_returns;
  return message.num_rings == Count(message.elevation_rad) && message.num_rings == Count(message.azimuth_offset_rad) &&
         message.num_rings == Count(message.time_offset_ns) && message.num_rings == Count(message.origin_height_m) &&
         message.num_returns == Count(message.return_kind) && message.num_columns == Count(message.azimuth_rad) &&
         message.num_columns == Count(message.time_ns) && message.num_cells == Count(message.range) &&
         message.num_cells == Count(message.reflectivity) && message.num_cells == num_cells;
}

bool IsOfGoodSize(const lidar_scan_t& message) {
  return message.num_rings >= 1 && message.num_rings <= kMaxRings && message.num_returns >= 1 && message.num_returns <= kMaxReturns &&
         message.num_turn_columns >= 0 && message.num_turn_columns <= kMaxTurnColumns &&
         std::int64_t{message.num_turn_columns} * message.num_rings * message.num_returns <= kMaxTurnCells;
}

bool AreBeamsGood(const lidar_scan_t& message) {
  constexpr auto kRightAngle = static_cast<float>(kPi / 2.0);
  constexpr auto kCircle = static_cast<float>(kTwoPi);
  return std::ranges::all_of(message.elevation_rad, [](float angle_rad) { return IsWithin(angle_rad, -kRightAngle, kRightAngle); }) &&
         std::ranges::is_sorted(message.elevation_rad) &&
         std::ranges::all_of(message.azimuth_offset_rad, [](float angle_rad) { return IsWithin(angle_rad, -kCircle, kCircle); }) &&
         std::ranges::all_of(message.origin_height_m, [](float height_m) { return IsWithin(height_m, -kMaxOriginHeightM, kMaxOriginHeightM); });
}

// A turn without columns is one part without columns; else no part is empty.
bool IsPartOfTurn(const lidar_scan_t& message) {
  if (message.seq < 0 || message.part_index < 0 || message.part_index >= message.num_parts) return false;
  if (message.num_parts > std::max(1, message.num_turn_columns) || (message.num_columns == 0 && message.num_turn_columns > 0)) return false;
  return message.first_column >= 0 && std::int64_t{message.first_column} + message.num_columns <= message.num_turn_columns;
}

ScanHead HeadOf(const lidar_scan_t& message, Utime time, Utime end_time) {
  ScanHead head;
  head.time = time;
  head.end_time = end_time;
  head.seq = message.seq;
  head.raw_seq = message.raw_seq;
  head.flags = message.flags;
  head.num_parts = message.num_parts;
  head.range_unit_m = message.range_unit_m;
  for (std::size_t ring = 0; ring < message.elevation_rad.size(); ++ring) {
    head.rings.push_back(
        {message.elevation_rad[ring], message.azimuth_offset_rad[ring], message.time_offset_ns[ring], message.origin_height_m[ring]});
  }
  head.num_returns = message.num_returns;
  head.num_turn_columns = message.num_turn_columns;
  return head;
}

segment_t ToMessage(const Segment& segment) {
  segment_t message{};
  message.utime_us = ToUtimeUs(segment.time);
  message.id = segment.id;
  message.confidence = static_cast<std::int32_t>(segment.confidence);
  message.grounds = segment.grounds;
  message.kind = static_cast<std::int32_t>(segment.kind);
  message.num_points = segment.num_points;
  const auto copy = [](const Point& from, float(&to)[3]) {
    to[0] = from.x_m;
    to[1] = from.y_m;
    to[2] = from.z_m;
  };
  copy(segment.centroid, message.centroid_m);
  copy(segment.nearest, message.nearest_m);
  message.nearest_utime_us = ToUtimeUs(segment.nearest_time);
  copy(segment.top, message.top_m);
  message.box_center_m[0] = segment.box_center_x_m;
  message.box_center_m[1] = segment.box_center_y_m;
  message.length_m = segment.length_m;
  message.width_m = segment.width_m;
  message.length_azimuth_rad = segment.length_azimuth_rad;
  message.min_z_m = segment.min_z_m;
  message.max_z_m = segment.max_z_m;
  message.min_reflectivity = segment.min_reflectivity;
  message.mean_reflectivity = segment.mean_reflectivity;
  message.max_reflectivity = segment.max_reflectivity;
  message.seen_share = segment.seen_share;
  for (const auto& corner : segment.hull) {
    message.hull_x_m.push_back(corner.x_m);
    message.hull_y_m.push_back(corner.y_m);
    message.hull_time_us.push_back(corner.time_us);
  }
  message.num_hull = Count(message.hull_x_m);
  for (const auto& corner : segment.waterline) {
    message.waterline_x_m.push_back(corner.x_m);
    message.waterline_y_m.push_back(corner.y_m);
    message.waterline_time_us.push_back(corner.time_us);
  }
  message.num_waterline = Count(message.waterline_x_m);
  return message;
}

// What all parts share, without labels and segments.
segments_t PartOf(const Scan& scan, const Segments& segments, int part_index) {
  segments_t part{};
  part.utime_us = ToUtimeUs(scan.head.time);
  part.seq = scan.head.seq;
  part.raw_seq = scan.head.raw_seq;
  part.end_utime_us = ToUtimeUs(scan.head.end_time);
  part.scan_flags = scan.head.flags;
  part.part_index = part_index;
  part.num_rings = scan.head.num_rings();
  part.num_returns = scan.head.num_returns;
  part.num_turn_segments = Count(segments.segments);
  return part;
}

}  // namespace

std::variant<ScanPart, Refusal> ToScanPart(const lidar_scan_t& message, int max_message_bytes) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto end_time = UtimeFromWire(message.end_utime_us);
  if (!time || !end_time || *end_time < *time) return Refusal::kTime;
  // In this order: products of counts are taken once they are known to be small, and the encoded size once they are known to be true.
  if (!IsOfGoodSize(message)) return Refusal::kSize;
  if (!CountsAgree(message)) return Refusal::kCounts;
  if (message.getEncodedSize() > max_message_bytes) return Refusal::kSize;
  if (!AreBeamsGood(message)) return Refusal::kBeams;
  if (!(message.range_unit_m > 0.0 && message.range_unit_m <= kMaxRangeUnitM)) return Refusal::kRangeUnit;
  if (!IsPartOfTurn(message)) return Refusal::kPart;
  constexpr auto kCircle = static_cast<float>(kTwoPi);
  if (!std::ranges::all_of(message.azimuth_rad, [](float angle_rad) { return IsWithin(angle_rad, 0.0F, kCircle); })) return Refusal::kAzimuth;

  ScanPart part;
  part.head = HeadOf(message, *time, *end_time);
  part.part_index = message.part_index;
  part.first_column = message.first_column;
  part.columns.azimuth_rad = message.azimuth_rad;
  part.columns.time_ns = message.time_ns;
  part.columns.range.resize(message.range.size());
  std::ranges::transform(message.range, part.columns.range.begin(), [](std::int16_t count) { return std::bit_cast<std::uint16_t>(count); });
  part.columns.reflectivity = message.reflectivity;
  return part;
}

std::vector<segments_t> ToMessages(const Scan& scan, const Segments& segments, int max_message_bytes) {
  std::vector<segments_t> parts;
  auto segment = segments.segments.begin();
  const auto fill = [&](segments_t& part) {
    int size_bytes = part.getEncodedSize();
    for (; segment != segments.segments.end(); ++segment) {
      auto message = ToMessage(*segment);
      size_bytes += message._getEncodedSizeNoHash();
      if (size_bytes > max_message_bytes) break;
      part.segments.push_back(std::move(message));
    }
    part.num_segments = Count(part.segments);
  };

  const auto cells_per_column = static_cast<std::ptrdiff_t>(scan.head.num_rings()) * scan.head.num_returns;
  for (const auto& span : scan.parts) {
    segments_t& part = parts.emplace_back(PartOf(scan, segments, static_cast<int>(parts.size())));
    part.first_column = span.first_column;
    part.num_columns = span.num_columns;
    const auto begin = segments.label.begin() + span.first_column * cells_per_column;
    part.label.assign(begin, begin + span.num_columns * cells_per_column);
    part.num_cells = Count(part.label);
    fill(part);
  }
  while (segment != segments.segments.end()) {
    segments_t& part = parts.emplace_back(PartOf(scan, segments, static_cast<int>(parts.size())));
    part.first_column = scan.head.num_turn_columns;
    fill(part);
  }
  for (auto& part : parts) part.num_parts = Count(parts);
  return parts;
}

}  // namespace lookout::segmenter
