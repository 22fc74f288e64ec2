#include "services/segmenter/wire.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <utility>

#include "common/messages/checks.hpp"

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

ScanHead HeadOf(const lidar_scan_t& message) {
  ScanHead head;
  head.time = Utime(std::chrono::microseconds(message.utime_us));
  head.end_time = Utime(std::chrono::microseconds(message.end_utime_us));
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
  message.thing_probability = segment.thing_probability;
  message.land_probability = segment.land_probability;
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
  const auto split = [](const auto& corners, auto& x_m, auto& y_m, auto& time_us) {
    for (const auto& corner : corners) {
      x_m.push_back(corner.x_m);
      y_m.push_back(corner.y_m);
      time_us.push_back(corner.time_us);
    }
    return messages::CountOf(corners);
  };
  message.num_hull = split(segment.hull, message.hull_x_m, message.hull_y_m, message.hull_time_us);
  message.num_waterline = split(segment.waterline, message.waterline_x_m, message.waterline_y_m, message.waterline_time_us);
  return message;
}

// Members that all parts share, without labels and segments.
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
  part.num_turn_segments = messages::CountOf(segments.segments);
  return part;
}

}  // namespace

std::optional<Scan> ToScan(const std::vector<lidar_scan_t>& parts) {
  Scan scan{HeadOf(parts.front()), {}, {}};
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (const auto& part : parts) {
    auto& columns = scan.columns;
    if (part.first_column != columns.size()) return std::nullopt;
    scan.parts.push_back({part.first_column, part.num_columns});
    append(columns.azimuth_rad, part.azimuth_rad);
    append(columns.time_ns, part.time_ns);
    append(columns.range, part.range);  // an unsigned count, bit for bit
    append(columns.reflectivity, part.reflectivity);
  }
  if (scan.columns.size() != scan.head.num_turn_columns) return std::nullopt;
  return scan;
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
    part.num_segments = messages::CountOf(part.segments);
  };

  int max_part_bytes = 0;
  const auto cells_per_column = static_cast<std::ptrdiff_t>(scan.head.num_rings()) * scan.head.num_returns;
  for (const auto& span : scan.parts) {
    segments_t& part = parts.emplace_back(PartOf(scan, segments, static_cast<int>(parts.size())));
    part.first_column = span.first_column;
    part.num_columns = span.num_columns;
    const auto begin = segments.label.begin() + span.first_column * cells_per_column;
    part.label.assign(begin, begin + span.num_columns * cells_per_column);
    part.num_cells = messages::CountOf(part.label);
    const auto piece = segments.piece.begin() + span.first_column * cells_per_column;
    part.piece.assign(piece, piece + span.num_columns * cells_per_column);
    std::erase(part.piece, std::int16_t{0});
    part.num_labelled = messages::CountOf(part.piece);
    max_part_bytes = std::max(max_part_bytes, part.getEncodedSize());
  }
  for (auto& part : parts) {
    if (max_part_bytes > max_message_bytes) {
      part.piece.clear();
      part.num_labelled = 0;
    }
    fill(part);
  }
  while (segment != segments.segments.end()) {
    segments_t& part = parts.emplace_back(PartOf(scan, segments, static_cast<int>(parts.size())));
    part.first_column = scan.head.num_turn_columns;
    fill(part);
  }
  for (auto& part : parts) part.num_parts = messages::CountOf(parts);
  return parts;
}

}  // namespace lookout::segmenter
