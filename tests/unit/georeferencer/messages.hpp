// Messages and poses of a boat on a lake, for the tests of georeferencer.
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/pose.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/segments_t.hpp"
#include "services/georeferencer/core/obstacle.hpp"
#include "services/georeferencer/params.hpp"
#include "tests/support/messages.hpp"

namespace lookout::georeferencer::test {

inline constexpr std::int64_t kStartUs = 1'800'000'000'000'000;  // a multiple of 20 ms
inline constexpr Datum kLake{43.7, -72.3, 100.0};

inline Utime At(std::int64_t offset_us) { return Utime(std::chrono::microseconds(kStartUs + offset_us)); }

/// A placed pose at the datum, heading north, level.
inline Pose MakePose(std::int64_t offset_us) {
  Pose pose;
  pose.time = At(offset_us);
  pose.is_placed = true;
  pose.datum = kLake;
  return pose;
}

/// A segment of one return.
inline Segment MakePoint(std::int64_t offset_us, double x_m, double y_m, double z_m) {
  Segment segment;
  segment.time = At(offset_us);
  segment.id = 1;
  segment.num_points = 1;
  segment.centroid_m = segment.nearest_m = segment.top_m = {x_m, y_m, z_m};
  segment.min_z_m = segment.max_z_m = z_m;
  segment.hull = {{{x_m, y_m}, At(offset_us)}};
  return segment;
}

inline SegmentPart MakePart(std::int64_t offset_us, std::int64_t seq, std::vector<Segment> segments) {
  SegmentPart part;
  part.head.time = At(offset_us);
  part.head.end_time = At(offset_us + 99'000);
  part.head.seq = seq;
  part.head.num_scan_segments = static_cast<std::int32_t>(segments.size());
  part.segments = std::move(segments);
  return part;
}

inline pose_t MakePoseMessage(std::int64_t offset_us, std::int64_t seq = 0) {
  pose_t message{};
  message.utime_us = kStartUs + offset_us;
  message.seq = seq;
  message.status = pose_t::STATUS_OK;
  message.heading_source = pose_t::HEADING_HDT;
  support::SetDatum(message, kLake);
  message.latitude_deg = kLake.latitude_deg;
  message.longitude_deg = kLake.longitude_deg;
  message.ellipsoid_height_m = kLake.ellipsoid_height_m;
  for (int i = 0; i < 9; ++i) message.covariance[i][i] = 0.01;
  return message;
}

inline segment_t MakeSegmentMessage(std::int32_t id, std::int64_t offset_us, int num_vertices = 1) {
  segment_t message{};
  message.utime_us = kStartUs + offset_us;
  message.nearest_utime_us = message.utime_us;
  message.id = id;
  message.confidence = segment_t::CONFIDENCE_SURE;
  message.thing_probability = 0.875F;
  message.land_probability = 0.125F;
  message.seen_share = 1.0F;
  message.num_points = num_vertices;
  message.centroid_m[0] = message.nearest_m[0] = 10.0F;
  for (int i = 0; i < num_vertices; ++i) {
    message.hull_x_m.push_back(10.0F + static_cast<float>(i % 2));
    message.hull_y_m.push_back(static_cast<float>(i));
    message.hull_time_us.push_back(0);
  }
  message.num_hull = num_vertices;
  return message;
}

/// Makes it land: so many vertices along a straight shore 20 m ahead, one after the other within 99 ms of the turn.
inline void AddWaterline(segment_t& message, int num_vertices) {
  message.kind = segment_t::KIND_LAND;
  for (int i = 0; i < num_vertices; ++i) {
    message.waterline_x_m.push_back(20.0F);
    message.waterline_y_m.push_back(-static_cast<float>(i));
    message.waterline_time_us.push_back(99'000 * i / num_vertices);
  }
  message.num_waterline = num_vertices;
}

/// A turn of 100 ms without labels.
inline segments_t MakeSegmentsMessage(std::int64_t offset_us, std::int64_t seq, std::vector<segment_t> segments) {
  auto message = support::OfScan<segments_t>(kStartUs + offset_us, seq, 99'000);
  message.raw_seq = 10 * seq;
  support::Fill(message, std::move(segments));
  return message;
}

/// An obstacle, and land with a waterline of four vertices.
inline segments_t MakeGoodSegments() {
  auto message = MakeSegmentsMessage(0, 3, {MakeSegmentMessage(1, 10'000, 3), MakeSegmentMessage(2, 99'000)});
  AddWaterline(message.segments[1], 4);
  return message;
}

}  // namespace lookout::georeferencer::test
