#include "common/messages/checks.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/printable.hpp"
#include "common/core/utime.hpp"

namespace lookout::messages {

namespace {

using std::chrono::microseconds;

// A beam starts inside of the sensor.
constexpr float kMaxOriginHeightM = 10.0F;
// 65 535 counts of a metre are more than any lidar sees.
constexpr double kMaxRangeUnitM = 1.0;
// Wide enough for any lidar, so that arithmetic stays far from overflow.
constexpr double kMaxLidarM = 1e5;
constexpr std::chrono::seconds kMaxScan(60);
// A place on the map: the diameter of the earth, and more.
constexpr double kMaxPlaceM = 1.5e7;
constexpr double kMaxDatumHeightM = 1e5;
constexpr double kMaxVarianceM2 = 1e12;
constexpr std::size_t kMaxSourceBytes = 64;
constexpr std::int32_t kAllGrounds = static_cast<std::int32_t>(segment_t::GROUND_FEW_RETURNS) |
                                     static_cast<std::int32_t>(segment_t::GROUND_SCATTERED) | static_cast<std::int32_t>(segment_t::GROUND_AT_SURFACE);

template <typename Message>
constexpr std::int32_t kMaxPartsOf = kMaxParts;
template <>
constexpr std::int32_t kMaxPartsOf<obstacles_t> = kMaxObstaclesParts;

template <typename Message>
bool IsPartGood(const Message& message) {
  return message.part_index >= 0 && message.part_index < message.num_parts && message.num_parts <= kMaxPartsOf<Message>;
}

template <typename Message>
bool HasPlace(const Message& message) {
  return UtimeFromWire(message.utime_us) && IsPartGood(message);
}

// The generated decoder has checked that no count is negative and none exceeds the bytes; two of them may be multiplied.
template <typename Message>
bool HasCells(const Message& message) {
  if (message.num_columns < 0 || message.num_rings < 0 || message.num_returns < 0) return false;
  const std::int64_t cells_per_column = std::int64_t{message.num_rings} * message.num_returns;
  if (cells_per_column == 0 || message.num_columns == 0) return message.num_cells == 0;
  return message.num_cells % cells_per_column == 0 && message.num_cells / cells_per_column == message.num_columns;
}

// As many as cells with a label above 0, or none.
bool HasPieces(const segments_t& message) {
  if (!std::cmp_equal(message.num_labelled, message.piece.size())) return false;
  if (message.num_labelled == 0) return true;
  return message.num_labelled == std::ranges::count_if(message.label, [](std::int16_t label) { return label > 0; }) &&
         std::ranges::all_of(message.piece, [](std::int16_t piece) { return piece > 0; });
}

bool IsWithin(float value, float least, float greatest) { return value >= least && value <= greatest; }  // false for NaN
bool IsWithin(double value, double bound) { return std::abs(value) <= bound; }

bool CountsAgree(const lidar_scan_t& message) {
  const auto num_cells = std::int64_t{message.num_columns} * message.num_rings * message.num_returns;
  return message.num_rings == std::ssize(message.elevation_rad) && message.num_rings == std::ssize(message.azimuth_offset_rad) &&
         message.num_rings == std::ssize(message.time_offset_ns) && message.num_rings == std::ssize(message.origin_height_m) &&
         message.num_returns == std::ssize(message.return_kind) && message.num_columns == std::ssize(message.azimuth_rad) &&
         message.num_columns == std::ssize(message.time_ns) && message.num_cells == std::ssize(message.range) &&
         message.num_cells == std::ssize(message.reflectivity) && message.num_cells == num_cells;
}

bool IsSizeGood(const lidar_scan_t& message) {
  return message.num_rings >= 1 && message.num_rings <= kMaxRings && message.num_returns >= 1 && message.num_returns <= kMaxReturns &&
         message.num_turn_columns >= 0 && message.num_turn_columns <= kMaxScanColumns &&
         std::int64_t{message.num_turn_columns} * message.num_rings * message.num_returns <= kMaxScanCells;
}

bool AreBeamsGood(const lidar_scan_t& message) {
  constexpr auto kRightAngle = static_cast<float>(kPi / 2.0);
  constexpr auto kCircle = static_cast<float>(kTwoPi);
  return std::ranges::all_of(message.elevation_rad, [](float angle_rad) { return IsWithin(angle_rad, -kRightAngle, kRightAngle); }) &&
         std::ranges::is_sorted(message.elevation_rad) &&
         std::ranges::all_of(message.azimuth_offset_rad, [](float angle_rad) { return IsWithin(angle_rad, -kCircle, kCircle); }) &&
         std::ranges::all_of(message.origin_height_m, [](float height_m) { return IsWithin(height_m, -kMaxOriginHeightM, kMaxOriginHeightM); });
}

// A scan without columns is one part without columns; else no part is empty.
bool IsPartOfScan(const lidar_scan_t& message) {
  if (message.seq < 0 || !IsPartGood(message)) return false;
  if (message.num_parts > std::max(1, message.num_turn_columns) || (message.num_columns == 0 && message.num_turn_columns > 0)) return false;
  return message.first_column >= 0 && std::int64_t{message.first_column} + message.num_columns <= message.num_turn_columns;
}

bool IsPlace(const float (&point_m)[3]) {
  return std::ranges::all_of(point_m, [](float value) { return IsWithin(double{value}, kMaxLidarM); });
}

bool IsProbability(float value) { return std::isnan(value) || IsWithin(value, 0.0F, 1.0F); }  // NaN: the method states none

bool IsLength(double value) { return value >= 0.0 && value <= kMaxLidarM; }

bool CountsAgree(const segment_t& segment) {
  return segment.num_points > 0 && segment.num_hull > 0 && segment.num_hull == std::ssize(segment.hull_x_m) &&
         segment.num_hull == std::ssize(segment.hull_y_m) && segment.num_hull == std::ssize(segment.hull_time_us) &&
         segment.num_waterline == std::ssize(segment.waterline_x_m) && segment.num_waterline == std::ssize(segment.waterline_y_m) &&
         segment.num_waterline == std::ssize(segment.waterline_time_us);
}

bool AreNumbersGood(const segment_t& segment) {
  return IsPlace(segment.centroid_m) && IsPlace(segment.nearest_m) && IsPlace(segment.top_m) && IsLength(segment.length_m) &&
         IsLength(segment.width_m) && IsWithin(segment.min_z_m, kMaxLidarM) && IsWithin(segment.max_z_m, kMaxLidarM) &&
         segment.min_z_m <= segment.max_z_m && std::isfinite(segment.length_azimuth_rad) && std::isfinite(segment.mean_reflectivity) &&
         IsWithin(segment.box_center_m[0], kMaxLidarM) && IsWithin(segment.box_center_m[1], kMaxLidarM) && segment.min_reflectivity >= 0 &&
         segment.min_reflectivity <= segment.max_reflectivity && IsWithin(segment.seen_share, 0.0F, 1.0F) &&
         IsProbability(segment.thing_probability) && IsProbability(segment.land_probability);
}

bool AreCodesKnown(const segment_t& segment) {
  return (segment.confidence == segment_t::CONFIDENCE_TENTATIVE || segment.confidence == segment_t::CONFIDENCE_SURE) &&
         (segment.kind == segment_t::KIND_OBSTACLE || segment.kind == segment_t::KIND_LAND) && segment.grounds >= 0 && segment.grounds <= kAllGrounds;
}

// Of the corners of a hull or a waterline; the arrays are equally long.
std::optional<Fault> FaultOf(const std::vector<float>& x_m, const std::vector<float>& y_m, const std::vector<std::int32_t>& time_us,
                             microseconds scan_duration) {
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    if (!IsWithin(x_m[i], kMaxLidarM) || !IsWithin(y_m[i], kMaxLidarM)) return kSegmentsNumber;
    if (time_us[i] < 0 || microseconds(time_us[i]) > scan_duration) return kSegmentsTime;
  }
  return std::nullopt;
}

// Precondition: CountsAgree.
std::optional<Fault> FaultOf(const segment_t& segment, Utime scan_time, Utime scan_end) {
  for (const auto utime_us : {segment.utime_us, segment.nearest_utime_us}) {
    const auto time = UtimeFromWire(utime_us);
    if (!time || *time < scan_time || *time > scan_end) return kSegmentsTime;
  }
  if (!AreNumbersGood(segment)) return kSegmentsNumber;
  if (!AreCodesKnown(segment)) return kSegmentsCode;
  if (const auto fault = FaultOf(segment.hull_x_m, segment.hull_y_m, segment.hull_time_us, scan_end - scan_time)) return fault;
  return FaultOf(segment.waterline_x_m, segment.waterline_y_m, segment.waterline_time_us, scan_end - scan_time);
}

// Of east-east, east-north, north-north.
bool IsCovariance(const double (&covariance_m2)[3]) {
  constexpr double kRounding = 1.0 + 1e-6;
  const auto& [ee, en, nn] = covariance_m2;
  if (std::isnan(ee) && std::isnan(en) && std::isnan(nn)) return true;
  return ee >= 0.0 && ee <= kMaxVarianceM2 && nn >= 0.0 && nn <= kMaxVarianceM2 && std::abs(en) <= kRounding * std::sqrt(ee * nn);
}

bool AreWithin(const std::vector<float>& values, double bound) {
  return std::ranges::all_of(values, [bound](float value) { return IsWithin(double{value}, bound); });
}

bool CountsAgree(const obstacle_t& obstacle) {
  const auto have = [](std::int32_t number, const std::vector<float>& first, const std::vector<float>& second) {
    return number == std::ssize(first) && number == std::ssize(second);
  };
  const bool is_placed = obstacle.status == obstacle_t::STATUS_OK;
  return obstacle.num_points > 0 && obstacle.num_footprint > 0 &&
         have(obstacle.num_footprint, obstacle.footprint_vessel_x_m, obstacle.footprint_vessel_y_m) &&
         have(obstacle.num_map, obstacle.footprint_east_m, obstacle.footprint_north_m) &&
         have(obstacle.num_waterline, obstacle.waterline_vessel_x_m, obstacle.waterline_vessel_y_m) &&
         have(obstacle.num_waterline_map, obstacle.waterline_east_m, obstacle.waterline_north_m) &&
         obstacle.num_map == (is_placed ? obstacle.num_footprint : 0) && obstacle.num_waterline_map == (is_placed ? obstacle.num_waterline : 0);
}

// @param is_relative  the map frame is not on the earth: there is no latitude and longitude
bool AreNumbersGood(const obstacle_t& obstacle, bool is_relative) {
  const bool is_placed = obstacle.status == obstacle_t::STATUS_OK;
  const bool has_place = is_relative ? std::isnan(obstacle.latitude_deg) && std::isnan(obstacle.longitude_deg)
                                     : IsWithin(obstacle.latitude_deg, 90.0) && IsWithin(obstacle.longitude_deg, 180.0);
  if (is_placed && !(has_place && IsWithin(obstacle.position_map_m[0], kMaxPlaceM) && IsWithin(obstacle.position_map_m[1], kMaxPlaceM))) {
    return false;
  }
  return IsWithin(obstacle.top_above_water_m, kMaxLidarM) && IsWithin(double{obstacle.center_vessel_m[0]}, kMaxLidarM) &&
         IsWithin(double{obstacle.center_vessel_m[1]}, kMaxLidarM) && IsPlace(obstacle.nearest_vessel_m) && IsLength(obstacle.range_m) &&
         IsWithin(obstacle.bearing_rad, 0.0F, static_cast<float>(kTwoPi)) && IsLength(obstacle.length_m) && IsLength(obstacle.width_m) &&
         IsLength(obstacle.height_m) && IsWithin(obstacle.seen_share, 0.0F, 1.0F) && IsProbability(obstacle.thing_probability) &&
         AreWithin(obstacle.footprint_vessel_x_m, kMaxLidarM) && AreWithin(obstacle.footprint_vessel_y_m, kMaxLidarM) &&
         AreWithin(obstacle.waterline_vessel_x_m, kMaxLidarM) && AreWithin(obstacle.waterline_vessel_y_m, kMaxLidarM) &&
         AreWithin(obstacle.footprint_east_m, kMaxPlaceM) && AreWithin(obstacle.footprint_north_m, kMaxPlaceM) &&
         AreWithin(obstacle.waterline_east_m, kMaxPlaceM) && AreWithin(obstacle.waterline_north_m, kMaxPlaceM);
}

bool AreCodesKnown(const obstacle_t& obstacle) {
  return obstacle.status >= obstacle_t::STATUS_OK && obstacle.status <= obstacle_t::STATUS_POSE_TIMEOUT &&
         (obstacle.confidence == obstacle_t::CONFIDENCE_TENTATIVE || obstacle.confidence == obstacle_t::CONFIDENCE_SURE) &&
         (obstacle.kind == obstacle_t::KIND_OBSTACLE || obstacle.kind == obstacle_t::KIND_LAND) && obstacle.grounds >= 0 &&
         obstacle.grounds <= kAllGrounds;
}

// Of pieces, numbered from 1 by 16 bits.
bool HasSlice(const tracks_t& message) {
  if (!std::cmp_equal(message.num_pieces, message.track_of_piece.size())) return false;
  if (message.num_pieces == 0) return true;
  return message.first_piece >= 1 && std::int64_t{message.first_piece} + message.num_pieces - 1 <= std::numeric_limits<std::int16_t>::max();
}

bool IsSameNumber(double one, double other) { return one == other || (std::isnan(one) && std::isnan(other)); }

}  // namespace

bool IsWellFormed(const lidar_scan_t& message) { return HasPlace(message) && HasCells(message); }

bool IsWellFormed(const segments_t& message) { return HasPlace(message) && HasCells(message) && HasPieces(message); }

bool IsWellFormed(const obstacles_t& message) {
  return HasPlace(message) && std::ranges::all_of(message.obstacles, [](const obstacle_t& obstacle) {
           return obstacle.num_map == 0 || obstacle.num_map == obstacle.num_footprint;
         });
}

bool IsWellFormed(const tracks_t& message) { return HasPlace(message) && HasSlice(message); }

std::optional<Fault> FaultOf(const lidar_scan_t& message, int max_message_bytes) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto end_time = UtimeFromWire(message.end_utime_us);
  if (!time || !end_time || *end_time < *time) return kScanTime;
  // In this order: counts are multiplied once they are known to be small, and the encoded size is asked for once they are known to be true.
  if (!IsSizeGood(message)) return kScanSize;
  if (!CountsAgree(message)) return kScanCounts;
  if (message.getEncodedSize() > max_message_bytes) return kScanSize;
  if (!AreBeamsGood(message)) return kScanBeams;
  if (!(message.range_unit_m > 0.0 && message.range_unit_m <= kMaxRangeUnitM)) return kScanRangeUnit;
  if (!IsPartOfScan(message)) return kScanPart;
  constexpr auto kCircle = static_cast<float>(kTwoPi);
  if (!std::ranges::all_of(message.azimuth_rad, [](float angle_rad) { return IsWithin(angle_rad, 0.0F, kCircle); })) return kScanAzimuth;
  return std::nullopt;
}

std::optional<Fault> FaultOf(const segments_t& message, int max_message_bytes) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto end_time = UtimeFromWire(message.end_utime_us);
  if (!time || !end_time || *end_time < *time || *end_time - *time > kMaxScan) return kSegmentsTime;
  if (message.seq < 0 || message.raw_seq < 0 || !HasPlace(message)) return kSegmentsParts;
  if (message.num_segments > message.num_turn_segments || message.num_segments != std::ssize(message.segments)) return kSegmentsCount;
  if (!std::ranges::all_of(message.segments, [](const segment_t& segment) { return CountsAgree(segment); })) return kSegmentsCount;
  if (message.getEncodedSize() > max_message_bytes) return kSegmentsSize;
  std::int32_t last_id = 0;
  for (const auto& segment : message.segments) {
    if (segment.id <= last_id || segment.id > message.num_turn_segments) return kSegmentsId;
    last_id = segment.id;
    if (const auto fault = FaultOf(segment, *time, *end_time)) return fault;
  }
  return std::nullopt;
}

std::optional<Fault> FaultOf(const obstacles_t& message, int max_message_bytes) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto end_time = UtimeFromWire(message.end_utime_us);
  if (!time || !end_time || *end_time < *time || *end_time - *time > kMaxScan) return kObstaclesTime;
  if (message.seq < 0 || message.raw_seq < 0 || !HasPlace(message)) return kObstaclesParts;
  if (message.num_obstacles != std::ssize(message.obstacles)) return kObstaclesCount;
  if (!std::ranges::all_of(message.obstacles, [](const obstacle_t& obstacle) { return AreCodesKnown(obstacle); })) return kObstaclesCode;
  if (!std::ranges::all_of(message.obstacles, [](const obstacle_t& obstacle) { return CountsAgree(obstacle); })) return kObstaclesCount;
  if (message.getEncodedSize() > max_message_bytes) return kObstaclesSize;
  const bool has_height = std::isnan(message.datum_ellipsoid_height_m) || IsWithin(message.datum_ellipsoid_height_m, kMaxDatumHeightM);
  const bool has_datum = IsWithin(message.datum_latitude_deg, 90.0) && IsWithin(message.datum_longitude_deg, 180.0) && has_height;
  const bool is_relative =
      std::isnan(message.datum_latitude_deg) && std::isnan(message.datum_longitude_deg) && message.datum_ellipsoid_height_m >= 1.0;
  if (!has_datum && !std::isnan(message.datum_latitude_deg)) return kObstaclesNumber;
  std::int32_t last_id = 0;
  for (const auto& obstacle : message.obstacles) {
    if (obstacle.id <= last_id) return kObstaclesId;
    last_id = obstacle.id;
    const auto obstacle_time = UtimeFromWire(obstacle.utime_us);
    if (!obstacle_time || *obstacle_time < *time || *obstacle_time > *end_time) return kObstaclesTime;
    if (!AreNumbersGood(obstacle, is_relative)) return kObstaclesNumber;
    if (obstacle.status == obstacle_t::STATUS_OK && !has_datum && !is_relative) return kObstaclesNumber;
    if (!IsCovariance(obstacle.covariance_m2) || !IsCovariance(obstacle.covariance_relative_m2)) return kObstaclesCovariance;
  }
  return std::nullopt;
}

std::optional<Fault> FaultOf(const alert_ack_t& message) {
  if (!UtimeFromWire(message.utime_us) || !UtimeFromWire(message.alert_raised_utime_us)) return kAckTime;
  if (message.alert_id == 0) return kAckId;
  if (message.source.size() > kMaxSourceBytes) return kAckSource;
  return std::nullopt;
}

std::optional<Fault> FaultOf(const order_t& message) {
  if (!UtimeFromWire(message.utime_us)) return kOrderTime;
  if (message.source.size() > kMaxSourceBytes) return kOrderSource;
  if (message.kind == order_t::KIND_SILENCE) return std::nullopt;
  if (message.kind == order_t::KIND_NAME) {
    return message.track_id > 0 && (message.name.empty() || IsName(message.name)) ? std::nullopt : std::optional(kOrderName);
  }
  if (message.kind != order_t::KIND_SETTINGS || message.mode < order_t::MODE_OPEN_WATER || message.mode > order_t::MODE_HARBOUR) return kOrderKind;
  const auto is_bad = [](float value) { return std::isinf(value); };
  if (is_bad(message.guard_zone_range_m) || is_bad(message.guard_zone_from_rad) || is_bad(message.guard_zone_to_rad) || is_bad(message.cpa_limit_m) ||
      message.guard_zone_range_m < 0.0F || message.cpa_limit_m < 0.0F ||
      std::isnan(message.guard_zone_from_rad) != std::isnan(message.guard_zone_to_rad)) {
    return kOrderNumber;
  }
  return std::nullopt;
}

bool AgreeAboutScan(const segments_t& one, const segments_t& other) {
  return one.end_utime_us == other.end_utime_us && one.num_parts == other.num_parts && one.num_rings == other.num_rings &&
         one.num_returns == other.num_returns;
}

bool AgreeAboutScan(const obstacles_t& one, const obstacles_t& other) {
  return one.end_utime_us == other.end_utime_us && one.raw_seq == other.raw_seq && one.scan_flags == other.scan_flags &&
         one.num_parts == other.num_parts && IsSameNumber(one.datum_latitude_deg, other.datum_latitude_deg) &&
         IsSameNumber(one.datum_longitude_deg, other.datum_longitude_deg) &&
         IsSameNumber(one.datum_ellipsoid_height_m, other.datum_ellipsoid_height_m);
}

bool AgreeAboutScan(const lidar_scan_t& one, const lidar_scan_t& other) {
  return one.end_utime_us == other.end_utime_us && one.raw_seq == other.raw_seq && one.flags == other.flags && one.num_parts == other.num_parts &&
         one.range_unit_m == other.range_unit_m && one.elevation_rad == other.elevation_rad && one.azimuth_offset_rad == other.azimuth_offset_rad &&
         one.time_offset_ns == other.time_offset_ns && one.origin_height_m == other.origin_height_m && one.num_returns == other.num_returns &&
         one.num_turn_columns == other.num_turn_columns;
}

bool IsCut(std::int32_t scan_flags) {
  return (scan_flags & lidar_scan_t::FLAG_PARTIAL_START) != 0 || (scan_flags & lidar_scan_t::FLAG_PARTIAL_END) != 0;
}

}  // namespace lookout::messages
