#include "services/tracker/wire.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/messages/pieces.hpp"
#include "services/tracker/alert_text.hpp"

namespace lookout::tracker {

namespace {

using std::chrono::microseconds;

static_assert(static_cast<int>(TrackStatus::kTentative) == track_t::STATUS_TENTATIVE);
static_assert(static_cast<int>(TrackStatus::kConfirmed) == track_t::STATUS_CONFIRMED);
static_assert(static_cast<int>(TrackStatus::kCoasting) == track_t::STATUS_COASTING);
static_assert(static_cast<int>(TrackStatus::kLost) == track_t::STATUS_LOST);
static_assert(static_cast<int>(TrackKind::kObstacle) == track_t::KIND_OBSTACLE);
static_assert(static_cast<int>(TrackKind::kBuoy) == track_t::KIND_BUOY);
static_assert(static_cast<int>(TrackKind::kBoat) == track_t::KIND_BOAT);
static_assert(static_cast<int>(TrackKind::kStructure) == track_t::KIND_STRUCTURE);
static_assert(static_cast<int>(TrackKind::kUnknown) == track_t::KIND_UNKNOWN);
static_assert(static_cast<int>(Encounter::kNone) == track_t::ENCOUNTER_NONE);
static_assert(static_cast<int>(Encounter::kHeadOn) == track_t::ENCOUNTER_HEAD_ON);
static_assert(static_cast<int>(Encounter::kCrossingGiveWay) == track_t::ENCOUNTER_CROSSING_GIVE_WAY);
static_assert(static_cast<int>(Encounter::kCrossingStandOn) == track_t::ENCOUNTER_CROSSING_STAND_ON);
static_assert(static_cast<int>(Encounter::kOvertaking) == track_t::ENCOUNTER_OVERTAKING);
static_assert(static_cast<int>(Encounter::kOvertaken) == track_t::ENCOUNTER_OVERTAKEN);
static_assert(kNoTrack == tracks_t::PIECE_NO_TRACK);
static_assert(static_cast<int>(AlertCause::kGuardZone) == alert_t::CAUSE_GUARD_ZONE);
static_assert(static_cast<int>(AlertCause::kClosestApproach) == alert_t::CAUSE_CLOSEST_APPROACH);
static_assert(static_cast<int>(AlertCause::kWatch) == alert_t::CAUSE_WATCH && kNumCauses == alert_t::CAUSE_WATCH);
static_assert(static_cast<int>(AlertLevel::kCaution) == alert_t::LEVEL_CAUTION);
static_assert(static_cast<int>(AlertLevel::kWarning) == alert_t::LEVEL_WARNING);
static_assert(static_cast<int>(AlertState::kActive) == alert_t::STATE_ACTIVE);
static_assert(static_cast<int>(AlertState::kAcknowledged) == alert_t::STATE_ACKNOWLEDGED);
static_assert(static_cast<int>(AlertState::kRectified) == alert_t::STATE_RECTIFIED);
static_assert(static_cast<int>(AlertState::kCleared) == alert_t::STATE_CLEARED);

static_assert(static_cast<int>(AlertSight::kSeen) == alert_t::SIGHT_SEEN);
static_assert(static_cast<int>(AlertSight::kJustSeen) == alert_t::SIGHT_JUST_SEEN);
static_assert(static_cast<int>(AlertSight::kLost) == alert_t::SIGHT_LOST);
static_assert(static_cast<int>(AlertEnd::kNone) == alert_t::END_NONE);
static_assert(static_cast<int>(AlertEnd::kClear) == alert_t::END_CLEAR);
static_assert(static_cast<int>(AlertEnd::kPassed) == alert_t::END_PASSED);
static_assert(static_cast<int>(AlertEnd::kGone) == alert_t::END_GONE);
static_assert(static_cast<int>(AlertEnd::kHidden) == alert_t::END_HIDDEN);
static_assert(static_cast<int>(AlertEnd::kMerged) == alert_t::END_MERGED);
static_assert(static_cast<int>(OrderKind::kSilence) == order_t::KIND_SILENCE);
static_assert(static_cast<int>(OrderKind::kSettings) == order_t::KIND_SETTINGS);
static_assert(static_cast<int>(OrderKind::kName) == order_t::KIND_NAME);
static_assert(static_cast<int>(Mode::kOpenWater) == order_t::MODE_OPEN_WATER);
static_assert(static_cast<int>(Mode::kHarbour) == order_t::MODE_HARBOUR);

// Where the method states no probability (the paper's).
constexpr double kThingProbabilityOfSure = 0.9;
constexpr double kThingProbabilityOfTentative = 0.1;
// More of a waterline than this would fill the message.
constexpr std::size_t kMaxWaterline = 8000;

std::vector<Eigen::Vector2d> ToCorners(const std::vector<float>& first_m, const std::vector<float>& second_m) {
  std::vector<Eigen::Vector2d> corners_m;
  corners_m.reserve(first_m.size());
  for (std::size_t i = 0; i < first_m.size(); ++i) corners_m.emplace_back(first_m[i], second_m[i]);
  return corners_m;
}

Eigen::Matrix2d ToMatrix(const double (&covariance)[3]) {
  Eigen::Matrix2d matrix;
  matrix << covariance[0], covariance[1], covariance[1], covariance[2];
  return matrix;
}

bool IsKnown(const double (&covariance)[3]) { return !std::isnan(covariance[0]); }

Seen ToSeen(const obstacle_t& message) {
  Seen seen;
  seen.segment_id = message.id;
  seen.time = Utime(microseconds(message.utime_us));
  seen.is_sure = message.confidence == obstacle_t::CONFIDENCE_SURE;
  seen.is_land = message.kind == obstacle_t::KIND_LAND;
  seen.thing_probability = message.thing_probability;
  if (std::isnan(message.thing_probability)) seen.thing_probability = seen.is_sure ? kThingProbabilityOfSure : kThingProbabilityOfTentative;
  seen.num_returns = message.num_points;
  seen.position_m = {message.position_map_m[0], message.position_map_m[1]};
  seen.covariance_m2 = ToMatrix(message.covariance_m2);
  seen.covariance_relative_m2 = ToMatrix(message.covariance_relative_m2);
  seen.top_above_water_m = message.top_above_water_m;
  seen.outline_m = ToCorners(message.footprint_east_m, message.footprint_north_m);
  seen.waterline_m = ToCorners(message.waterline_east_m, message.waterline_north_m);
  return seen;
}

VesselOutline ToOutline(const obstacle_t& message) {
  VesselOutline outline;
  outline.segment_id = message.id;
  outline.is_sure = message.confidence == obstacle_t::CONFIDENCE_SURE;
  outline.is_land = message.kind == obstacle_t::KIND_LAND;
  outline.is_line = message.num_waterline > 0;
  outline.corners_m = outline.is_line ? ToCorners(message.waterline_vessel_x_m, message.waterline_vessel_y_m)
                                      : ToCorners(message.footprint_vessel_x_m, message.footprint_vessel_y_m);
  outline.nearest_m = {message.nearest_vessel_m[0], message.nearest_vessel_m[1]};
  return outline;
}

float ToFloat(double value) { return static_cast<float>(Canonical(value)); }

// In a float the next number above is 2 pi.
float ToBearing(double bearing_rad) {
  const auto bearing = ToFloat(bearing_rad);
  return static_cast<double>(bearing) < kTwoPi || std::isnan(bearing) ? bearing : 0.0F;
}

std::int32_t Split(const std::vector<Eigen::Vector2d>& places_m, std::vector<float>& east_m, std::vector<float>& north_m) {
  for (const auto& place_m : places_m) {
    east_m.push_back(static_cast<float>(place_m.x()));
    north_m.push_back(static_cast<float>(place_m.y()));
  }
  return messages::CountOf(places_m);
}

void CopyApproach(const ClosestApproach& approach, track_t& message) {
  message.distance_m = ToFloat(approach.distance_m);
  message.cpa_m = ToFloat(approach.cpa_m);
  message.tcpa_s = ToFloat(approach.tcpa_s);
  message.cpa_probability = ToFloat(approach.probability);
  message.bearing_drift_radps = ToFloat(approach.bearing_drift_radps);
}

// @param map  nullopt: of a frame that is not on the earth
track_t ToMessage(const Track& track, const std::optional<LocalFrame>& map, double own_up_m) {
  track_t message{};
  message.id = track.id;
  message.status = static_cast<std::int32_t>(track.status);
  message.kind = static_cast<std::int32_t>(track.kind);
  message.first_utime_us = ToUtimeUs(track.first);
  message.seen_utime_us = ToUtimeUs(track.seen);
  message.latitude_deg = message.longitude_deg = kNan;
  if (map) {
    const auto place = map->Reverse({track.position_m.x(), track.position_m.y(), own_up_m});
    message.latitude_deg = place.latitude_deg;
    message.longitude_deg = place.longitude_deg;
  }
  for (int i = 0; i < 2; ++i) {
    message.position_map_m[i] = Canonical(track.position_m[i]);
    message.velocity_map_mps[i] = Canonical(track.velocity_mps[i]);
  }
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) message.covariance[i][k] = Canonical(track.covariance(i, k));
  }
  message.covariance_relative_m2[0] = Canonical(track.covariance_relative_m2(0, 0));
  message.covariance_relative_m2[1] = Canonical(track.covariance_relative_m2(0, 1));
  message.covariance_relative_m2[2] = Canonical(track.covariance_relative_m2(1, 1));
  const double speed_mps = track.velocity_mps.norm();
  message.speed_mps = ToFloat(speed_mps);
  message.course_rad = ToBearing(speed_mps > 0.0 ? WrapTo2Pi(Atan2(track.velocity_mps.x(), track.velocity_mps.y())) : kNan);
  message.turn_rate_radps = ToFloat(track.turn_rate_radps);
  message.existence_probability = ToFloat(track.existence_probability);
  message.moving_probability = ToFloat(track.moving_probability);
  message.length_m = ToFloat(track.rectangle.length_m);
  message.width_m = ToFloat(track.rectangle.width_m);
  // From north clockwise, where the rectangle counts from east counter-clockwise; a line has no sense.
  const double bearing_rad = WrapTo2Pi(kPi / 2.0 - track.rectangle.length_angle_rad);
  message.length_bearing_rad = ToFloat(bearing_rad < kPi ? bearing_rad : bearing_rad - kPi);
  message.top_above_water_m = ToFloat(track.top_above_water_m);
  message.seen_share = ToFloat(track.seen_share);
  message.num_outline = Split(track.outline_m, message.outline_east_m, message.outline_north_m);
  message.segment_ids = track.segment_ids;
  message.num_segments = messages::CountOf(message.segment_ids);
  message.parents = track.parents;
  message.num_parents = messages::CountOf(message.parents);
  message.children = track.children;
  message.num_children = messages::CountOf(message.children);
  message.num_seen = track.num_seen;
  message.num_looks = track.num_looks;
  message.mean_returns = ToFloat(track.mean_returns);
  message.range_m = ToFloat(track.range_m);
  message.bearing_rad = ToBearing(track.bearing_rad);
  CopyApproach(track.approach, message);
  message.encounter = static_cast<std::int32_t>(track.encounter);
  return message;
}

bool IsLabelled(const segments_t& part) {
  return std::ranges::any_of(part.label, [](std::int16_t label) { return label > 0; });
}

// Whether each piece has one label.
bool AreOfOneSegmentEach(const ScanLabels& scan) {
  std::vector<std::int16_t> segment_of_piece(std::size_t{std::numeric_limits<std::int16_t>::max()} + 1, 0);
  for (std::size_t cell = 0; cell < scan.piece.size(); ++cell) {
    if (scan.piece[cell] == 0) continue;
    auto& segment = segment_of_piece[static_cast<std::size_t>(scan.piece[cell])];
    if (segment != 0 && segment != scan.label[cell]) return false;
    segment = scan.label[cell];
  }
  return true;
}

template <typename Message>
void CopyLabel(const ScanLabel& scan, Message& message) {
  message.utime_us = ToUtimeUs(scan.key.time);
  message.seq = scan.key.seq;
  message.raw_seq = scan.raw_seq;
  message.end_utime_us = ToUtimeUs(scan.end_time);
  message.begin_seq = scan.begin.seq;
  message.begin_utime_us = ToUtimeUs(scan.begin.time);
}

}  // namespace

std::optional<ScanObstacles> ToObstacles(std::span<const obstacles_t> parts, LeftOut& left_out) {
  const auto& head = parts.front();
  ScanObstacles scan;
  scan.key = KeyOf(head);
  scan.end_time = Utime(microseconds(head.end_utime_us));
  scan.raw_seq = head.raw_seq;
  scan.flags = head.scan_flags;
  scan.is_whole = std::cmp_equal(parts.size(), head.num_parts);
  scan.datum = {head.datum_latitude_deg, head.datum_longitude_deg, head.datum_ellipsoid_height_m};
  std::int32_t last_id = 0;
  std::vector<float> ranges_m;  // [scan.seen]
  for (const auto& part : parts) {
    for (const auto& obstacle : part.obstacles) {
      if (std::exchange(last_id, obstacle.id) >= obstacle.id) return std::nullopt;
      scan.outlines.push_back(ToOutline(obstacle));
      if (obstacle.status != obstacle_t::STATUS_OK) {
        ++left_out.num_not_placed;
      } else if (!IsKnown(obstacle.covariance_m2) || !IsKnown(obstacle.covariance_relative_m2)) {
        ++left_out.num_without_covariance;
      } else {
        scan.seen.push_back(ToSeen(obstacle));
        ranges_m.push_back(obstacle.range_m);
      }
    }
  }
  if (std::cmp_greater(scan.seen.size(), kMostObstacles)) {
    left_out.num_over_limit += std::ssize(scan.seen) - kMostObstacles;
    std::vector<std::size_t> order(scan.seen.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return std::tuple(!scan.seen[i].is_sure, ranges_m[i], i); });
    order.resize(kMostObstacles);
    std::ranges::sort(order);
    std::vector<Seen> nearest;
    nearest.reserve(order.size());
    for (const auto i : order) nearest.push_back(std::move(scan.seen[i]));
    scan.seen = std::move(nearest);
  }
  return scan;
}

std::optional<ScanBeams> ToBeams(std::span<const lidar_scan_t> parts) {
  const auto& head = parts.front();
  ScanBeams scan;
  scan.key = KeyOf(head);
  scan.num_returns = head.num_returns;
  scan.sweep.elevation_rad = head.elevation_rad;
  scan.sweep.azimuth_offset_rad = head.azimuth_offset_rad;
  const auto num_cells = static_cast<std::size_t>(head.num_turn_columns) * static_cast<std::size_t>(head.num_rings);
  scan.sweep.range_m.reserve(num_cells);
  scan.nearest.reserve(num_cells);
  const auto num_returns = static_cast<std::size_t>(head.num_returns);
  for (const auto& part : parts) {
    if (!std::cmp_equal(part.first_column, scan.sweep.azimuth_rad.size())) return std::nullopt;
    scan.sweep.azimuth_rad.insert(scan.sweep.azimuth_rad.end(), part.azimuth_rad.begin(), part.azimuth_rad.end());
    for (const auto time_ns : part.time_ns) {
      scan.sweep.time.push_back(scan.key.time + std::chrono::duration_cast<microseconds>(std::chrono::nanoseconds(time_ns)));
    }
    for (std::size_t shot = 0; shot + num_returns <= part.range.size(); shot += num_returns) {
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < num_returns; ++i) {
        const auto range = static_cast<std::uint16_t>(part.range[shot + i]);
        const auto least = static_cast<std::uint16_t>(part.range[shot + nearest]);
        if (range != 0 && (least == 0 || range < least)) nearest = i;
      }
      scan.nearest.push_back(static_cast<std::uint8_t>(nearest));
      scan.sweep.range_m.push_back(static_cast<float>(head.range_unit_m * static_cast<std::uint16_t>(part.range[shot + nearest])));
    }
  }
  if (!std::cmp_equal(scan.sweep.azimuth_rad.size(), head.num_turn_columns) || scan.sweep.range_m.size() != num_cells) return std::nullopt;
  return scan;
}

std::optional<ScanLabels> ToLabels(std::span<const segments_t> parts) {
  const auto& head = parts.front();
  ScanLabels scan;
  scan.key = KeyOf(head);
  scan.num_returns = head.num_returns;
  const auto cells_per_column = std::int64_t{head.num_rings} * head.num_returns;
  bool has_pieces = false;
  for (const auto& part : parts) {
    if (part.num_columns == 0) continue;  // segments that did not fit in the parts before
    if (!std::cmp_equal(cells_per_column * part.first_column, scan.label.size())) return std::nullopt;
    if (!std::cmp_equal(cells_per_column * part.num_columns, part.label.size())) return std::nullopt;
    scan.label.insert(scan.label.end(), part.label.begin(), part.label.end());
    has_pieces |= !part.piece.empty();
  }
  if (!has_pieces) return scan;
  scan.piece.reserve(scan.label.size());
  for (const auto& part : parts) {
    if (part.piece.empty() && IsLabelled(part)) return std::nullopt;
    const auto piece = messages::PiecesOf(part);
    scan.piece.insert(scan.piece.end(), piece.begin(), piece.end());
  }
  if (!AreOfOneSegmentEach(scan)) return std::nullopt;
  return scan;
}

Acknowledgement ToAcknowledgement(const alert_ack_t& message) {
  return {Utime(microseconds(message.utime_us)), message.source, message.alert_id, Utime(microseconds(message.alert_raised_utime_us)), message.seq};
}

alert_ack_t ToMessage(const Acknowledgement& acknowledgement) {
  alert_ack_t message{};
  message.utime_us = ToUtimeUs(acknowledgement.time);
  message.seq = acknowledgement.seq;
  message.source = acknowledgement.source;
  message.alert_id = acknowledgement.alert_id;
  message.alert_raised_utime_us = ToUtimeUs(acknowledgement.raised);
  return message;
}

std::vector<tracks_t> ToMessages(const ScanLabel& scan, const Picture& picture, int max_message_bytes) {
  tracks_t head{};
  CopyLabel(scan, head);
  head.scan_flags = scan.flags;
  if (picture.is_sight_known) head.sight = tracks_t::SIGHT_KNOWN;
  head.datum_latitude_deg = Canonical(scan.datum.latitude_deg);
  head.datum_longitude_deg = Canonical(scan.datum.longitude_deg);
  head.datum_ellipsoid_height_m = Canonical(scan.datum.ellipsoid_height_m);
  head.num_scan_tracks = messages::CountOf(picture.tracks);
  const int head_bytes = head.getEncodedSize();

  std::vector<tracks_t> parts{head};
  parts[0].land_segment_ids = picture.land_segment_ids;
  parts[0].num_land_segments = messages::CountOf(parts[0].land_segment_ids);
  auto waterline_m = picture.waterline_m;
  if (waterline_m.size() > kMaxWaterline) waterline_m.resize(kMaxWaterline);
  parts[0].num_waterline = Split(waterline_m, parts[0].waterline_east_m, parts[0].waterline_north_m);
  int num_bytes = parts[0].getEncodedSize();
  if (!picture.tracks.empty()) {
    const auto map = scan.datum.IsRelative() ? std::nullopt : std::optional(scan.datum.Map());
    for (const auto& track : picture.tracks) {
      auto message = ToMessage(track, map, scan.own_up_m);
      const int size = message._getEncodedSizeNoHash();
      if (num_bytes + size > max_message_bytes) {
        parts.push_back(head);
        num_bytes = head_bytes;
      }
      num_bytes += size;
      parts.back().tracks.push_back(std::move(message));
    }
  }
  for (std::span<const std::int64_t> rest = picture.track_of_piece; !rest.empty();) {
    const auto room = static_cast<std::size_t>(std::max(0, max_message_bytes - num_bytes)) / sizeof(std::int64_t);
    const auto slice = rest.first(std::min(room, rest.size()));
    if (!slice.empty()) {
      parts.back().first_piece = static_cast<std::int32_t>(picture.track_of_piece.size() - rest.size()) + 1;
      parts.back().num_pieces = static_cast<std::int32_t>(slice.size());
      parts.back().track_of_piece.assign(slice.begin(), slice.end());
    }
    rest = rest.subspan(slice.size());
    if (rest.empty()) break;
    parts.push_back(head);
    num_bytes = head_bytes;
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].part_index = static_cast<std::int32_t>(i);
    parts[i].num_parts = messages::CountOf(parts);
    parts[i].num_tracks = messages::CountOf(parts[i].tracks);
  }
  return parts;
}

alert_t ToMessage(const Alert& alert, const std::optional<LocalFrame>& map) {
  alert_t message{};
  message.id = alert.id;
  message.cause = static_cast<std::int32_t>(alert.cause);
  message.is_in_zone = alert.is_in_zone;
  message.comes_near = alert.comes_near;
  message.level = static_cast<std::int32_t>(alert.level);
  message.state = static_cast<std::int32_t>(alert.state);
  message.track_id = alert.nearest_track;
  message.name = NameOf(alert);
  message.raised_utime_us = ToUtimeUs(alert.raised);
  message.changed_utime_us = ToUtimeUs(alert.changed);
  message.distance_m = ToFloat(alert.distance_m);
  message.bearing_rad = ToBearing(alert.bearing_rad);
  message.cpa_m = ToFloat(alert.cpa_m);
  message.tcpa_s = ToFloat(alert.tcpa_s);
  message.cpa_probability = ToFloat(alert.cpa_probability);
  message.time_left_s = ToFloat(alert.time_left_s);
  message.latitude_deg = message.longitude_deg = Canonical(kNan);
  if (map && !alert.place_map_m.hasNaN()) {
    const auto place = map->Reverse({alert.place_map_m.x(), alert.place_map_m.y(), 0.0});
    message.latitude_deg = place.latitude_deg;
    message.longitude_deg = place.longitude_deg;
  }
  message.sight = static_cast<std::int32_t>(alert.sight);
  message.seen_utime_us = ToUtimeUs(alert.seen);
  message.end = static_cast<std::int32_t>(alert.end);
  message.text = TextOf(alert);
  return message;
}

Order ToOrder(const order_t& message) {
  Order order{Utime(microseconds(message.utime_us)), message.seq, message.source, static_cast<OrderKind>(message.kind), {}, 0, {}};
  if (order.kind == OrderKind::kName) {
    order.track_id = message.track_id;
    order.name = message.name;
  }
  if (order.kind != OrderKind::kSettings) return order;
  order.settings = {static_cast<Mode>(message.mode), message.guard_zone_range_m, message.guard_zone_from_rad, message.guard_zone_to_rad,
                    message.cpa_limit_m};
  return order;
}

order_t ToMessage(const Order& order) {
  order_t message{};
  message.utime_us = ToUtimeUs(order.time);
  message.seq = order.seq;
  message.source = order.source;
  message.kind = static_cast<std::int32_t>(order.kind);
  message.mode = static_cast<std::int32_t>(order.settings.mode);
  message.guard_zone_range_m = ToFloat(order.settings.guard_zone_range_m);
  message.guard_zone_from_rad = ToFloat(order.settings.guard_zone_from_rad);
  message.guard_zone_to_rad = ToFloat(order.settings.guard_zone_to_rad);
  message.cpa_limit_m = ToFloat(order.settings.cpa_limit_m);
  message.track_id = order.track_id;
  message.name = order.name;
  return message;
}

alerts_t ToMessage(const ScanLabel& scan, const AlertsTold& told, const Picture& picture, int max_message_bytes) {
  alerts_t message{};
  CopyLabel(scan, message);
  message.summary = SummaryOf(told.alerts);
  message.sounding_alert_id = told.sounding_alert_id;
  message.silenced_until_utime_us = told.silenced_until ? ToUtimeUs(*told.silenced_until) : 0;
  message.mode = static_cast<std::int32_t>(told.limits.mode);
  message.guard_zone_range_m = ToFloat(told.limits.guard_zone.range_m);
  message.guard_zone_from_rad = ToFloat(told.limits.guard_zone.bearing.start_rad);
  message.guard_zone_to_rad = ToFloat(told.limits.guard_zone.bearing.start_rad + told.limits.guard_zone.bearing.width_rad);
  message.cpa_limit_m = ToFloat(told.limits.cpa_limit_m);
  for (const auto& [id, name] : told.names) {
    message.named_track_id.push_back(id);
    message.given_name.push_back(name);
  }
  message.num_names = messages::CountOf(message.given_name);
  for (const auto& acknowledgement : told.acknowledged) message.acknowledged.push_back(ToMessage(acknowledgement));
  message.num_acknowledged = messages::CountOf(message.acknowledged);
  for (const auto& order : told.orders) message.orders.push_back(ToMessage(order));
  message.num_orders = messages::CountOf(message.orders);
  const bool has_map = !std::isnan(scan.datum.latitude_deg);
  const auto map = has_map ? std::optional(scan.datum.Map()) : std::nullopt;
  int num_bytes = message.getEncodedSize();
  for (const auto& alert : told.alerts) {
    auto part = ToMessage(alert, map);
    const auto track = std::ranges::find(picture.tracks, alert.nearest_track, &Track::id);
    if (track == picture.tracks.end() || track->status == TrackStatus::kLost) part.track_id = kLandTrack;
    num_bytes += part._getEncodedSizeNoHash();
    if (num_bytes > max_message_bytes) break;
    message.alerts.push_back(std::move(part));
  }
  message.num_alerts = messages::CountOf(message.alerts);
  return message;
}

}  // namespace lookout::tracker
