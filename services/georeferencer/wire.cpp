#include "services/georeferencer/wire.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "services/georeferencer/core/second_lidar.hpp"

namespace lookout::georeferencer {

namespace {

using std::chrono::microseconds;

// A scan of so few obstacles fits into one message, however large their outlines and waterlines are.
constexpr std::size_t kFewSegments = 18;
constexpr std::size_t kMaxObstacleBytes = kObstacleBytes + (kMaxFootprintVertices + kMaxWaterlineVertices) * kVertexBytes;
static_assert(kHeadBytes + kFewSegments * kMaxObstacleBytes <= 120'000);

// One set of codes from segment to obstacle.
static_assert(static_cast<int>(Confidence::kTentative) == segment_t::CONFIDENCE_TENTATIVE);
static_assert(static_cast<int>(Confidence::kTentative) == obstacle_t::CONFIDENCE_TENTATIVE);
static_assert(static_cast<int>(Confidence::kSure) == segment_t::CONFIDENCE_SURE);
static_assert(static_cast<int>(Confidence::kSure) == obstacle_t::CONFIDENCE_SURE);
static_assert(static_cast<int>(Kind::kObstacle) == segment_t::KIND_OBSTACLE);
static_assert(static_cast<int>(Kind::kObstacle) == obstacle_t::KIND_OBSTACLE);
static_assert(static_cast<int>(Kind::kLand) == segment_t::KIND_LAND);
static_assert(static_cast<int>(Kind::kLand) == obstacle_t::KIND_LAND);
static_assert(static_cast<int>(ObstacleStatus::kOk) == obstacle_t::STATUS_OK);
static_assert(static_cast<int>(ObstacleStatus::kVesselFrameOnly) == obstacle_t::STATUS_VESSEL_FRAME_ONLY);
static_assert(static_cast<int>(ObstacleStatus::kPoseTimeout) == obstacle_t::STATUS_POSE_TIMEOUT);
static_assert(static_cast<int>(SecondSight::kHole) == obstacles_t::FLAG_SECOND_HOLE);
static_assert(static_cast<int>(SecondSight::kSilent) == obstacles_t::FLAG_SECOND_SILENT);
static_assert(static_cast<int>(obstacle_t::GROUND_FEW_RETURNS) == segment_t::GROUND_FEW_RETURNS);
static_assert(static_cast<int>(obstacle_t::GROUND_SCATTERED) == segment_t::GROUND_SCATTERED);
static_assert(static_cast<int>(obstacle_t::GROUND_AT_SURFACE) == segment_t::GROUND_AT_SURFACE);

Eigen::Vector3d ToVector(const float (&point_m)[3]) { return {point_m[0], point_m[1], point_m[2]}; }

std::vector<HullVertex> ToCorners(const std::vector<float>& x_m, const std::vector<float>& y_m, const std::vector<std::int32_t>& time_us,
                                  Utime scan_time) {
  std::vector<HullVertex> corners;
  corners.reserve(x_m.size());
  for (std::size_t i = 0; i < x_m.size(); ++i) corners.push_back({{x_m[i], y_m[i]}, scan_time + microseconds(time_us[i])});
  return corners;
}

Segment ToSegment(const segment_t& message, Utime scan_time) {
  Segment segment;
  segment.time = Utime(microseconds(message.utime_us));
  segment.id = message.id;
  segment.rating = {static_cast<Confidence>(message.confidence), message.grounds, static_cast<Kind>(message.kind), message.thing_probability,
                    message.seen_share};
  segment.num_points = message.num_points;
  segment.centroid_m = ToVector(message.centroid_m);
  segment.nearest_m = ToVector(message.nearest_m);
  segment.top_m = ToVector(message.top_m);
  segment.length_m = message.length_m;
  segment.width_m = message.width_m;
  segment.min_z_m = message.min_z_m;
  segment.max_z_m = message.max_z_m;
  segment.mean_reflectivity = message.mean_reflectivity;
  segment.hull = ToCorners(message.hull_x_m, message.hull_y_m, message.hull_time_us, scan_time);
  segment.waterline = ToCorners(message.waterline_x_m, message.waterline_y_m, message.waterline_time_us, scan_time);
  return segment;
}

// @return their number
std::int32_t Split(const std::vector<Eigen::Vector2d>& places_m, std::vector<float>& first_m, std::vector<float>& second_m) {
  for (const auto& place_m : places_m) {
    first_m.push_back(static_cast<float>(place_m.x()));
    second_m.push_back(static_cast<float>(place_m.y()));
  }
  return messages::CountOf(places_m);
}

obstacle_t ToMessage(const Obstacle& obstacle) {
  obstacle_t message{};
  message.utime_us = ToUtimeUs(obstacle.time);
  message.id = obstacle.id;
  message.status = static_cast<std::int32_t>(obstacle.status);
  message.confidence = static_cast<std::int32_t>(obstacle.rating.confidence);
  message.grounds = obstacle.rating.grounds;
  message.kind = static_cast<std::int32_t>(obstacle.rating.kind);
  message.thing_probability = obstacle.rating.thing_probability;
  message.seen_share = obstacle.rating.seen_share;
  message.latitude_deg = obstacle.latitude_deg;
  message.longitude_deg = obstacle.longitude_deg;
  message.position_map_m[0] = obstacle.position_map_m.x();
  message.position_map_m[1] = obstacle.position_map_m.y();
  const auto copy_upper = [](const Eigen::Matrix2d& from_m2, double(&to_m2)[3]) {
    to_m2[0] = Canonical(from_m2(0, 0));
    to_m2[1] = Canonical(from_m2(0, 1));
    to_m2[2] = Canonical(from_m2(1, 1));
  };
  copy_upper(obstacle.covariance_m2, message.covariance_m2);
  copy_upper(obstacle.covariance_relative_m2, message.covariance_relative_m2);
  message.top_above_water_m = obstacle.top_above_water_m;
  for (int i = 0; i < 2; ++i) message.center_vessel_m[i] = static_cast<float>(obstacle.center_vessel_m[i]);
  for (int i = 0; i < 3; ++i) message.nearest_vessel_m[i] = static_cast<float>(obstacle.nearest_vessel_m[i]);
  message.range_m = static_cast<float>(obstacle.range_m);
  // The float next to 2 pi is above it.
  const auto bearing_rad = static_cast<float>(obstacle.bearing_rad);
  message.bearing_rad = static_cast<double>(bearing_rad) < kTwoPi ? bearing_rad : 0.0F;
  message.length_m = obstacle.length_m;
  message.width_m = obstacle.width_m;
  message.height_m = static_cast<float>(obstacle.height_m);
  message.num_points = obstacle.num_points;
  message.mean_reflectivity = obstacle.mean_reflectivity;
  message.num_footprint = Split(obstacle.footprint_vessel_m, message.footprint_vessel_x_m, message.footprint_vessel_y_m);
  message.num_map = Split(obstacle.footprint_map_m, message.footprint_east_m, message.footprint_north_m);
  message.num_waterline = Split(obstacle.waterline_vessel_m, message.waterline_vessel_x_m, message.waterline_vessel_y_m);
  message.num_waterline_map = Split(obstacle.waterline_map_m, message.waterline_east_m, message.waterline_north_m);
  return message;
}

}  // namespace

std::variant<SegmentPart, Refusal> ToSegmentPart(const segments_t& message, int max_message_bytes) {
  if (const auto fault = messages::FaultOf(message, max_message_bytes)) return *fault;
  SegmentPart part;
  part.head.time = Utime(microseconds(message.utime_us));
  part.head.end_time = Utime(microseconds(message.end_utime_us));
  part.head.seq = message.seq;
  part.head.raw_seq = message.raw_seq;
  part.head.scan_flags = message.scan_flags;
  part.head.part_index = message.part_index;
  part.head.num_parts = message.num_parts;
  part.head.num_scan_segments = message.num_turn_segments;
  part.num_returns = std::ranges::count_if(message.label, [](std::int16_t label) { return label != 0; });
  for (const auto& segment : message.segments) part.segments.push_back(ToSegment(segment, part.head.time));
  return part;
}

std::vector<obstacles_t> ToMessages(const ObstaclePart& part, int max_message_bytes) {
  obstacles_t head{};
  head.utime_us = ToUtimeUs(part.head.time);
  head.seq = part.head.seq;
  head.raw_seq = part.head.raw_seq;
  head.end_utime_us = ToUtimeUs(part.head.end_time);
  head.scan_flags = part.head.scan_flags;
  head.datum_latitude_deg = Canonical(part.datum.latitude_deg);
  head.datum_longitude_deg = Canonical(part.datum.longitude_deg);
  head.datum_ellipsoid_height_m = Canonical(part.datum.ellipsoid_height_m);
  const int head_bytes = head.getEncodedSize();

  // Filled in order; the second holds the obstacles that do not fit into the first.
  std::vector<obstacles_t> messages{head};
  int num_bytes = head_bytes;
  for (const auto& obstacle : part.obstacles) {
    auto message = ToMessage(obstacle);
    const int size = message._getEncodedSizeNoHash();
    if (num_bytes + size > max_message_bytes) {
      messages.push_back(head);
      num_bytes = head_bytes;
    }
    num_bytes += size;
    messages.back().obstacles.push_back(std::move(message));
  }
  // Other parts of the scan may need two messages: then each part gets two, since num_parts must be known with the first.
  const bool is_one_enough =
      part.head.num_scan_segments <= static_cast<std::int32_t>(kFewSegments) || (part.head.num_parts == 1 && messages.size() == 1);
  if (!is_one_enough && messages.size() == 1) messages.push_back(head);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const auto per_part = static_cast<std::int32_t>(messages.size());
    messages[i].part_index = part.head.part_index * per_part + static_cast<std::int32_t>(i);
    messages[i].num_parts = part.head.num_parts * per_part;
    messages[i].num_obstacles = messages::CountOf(messages[i].obstacles);
  }
  return messages;
}

}  // namespace lookout::georeferencer
