#include "services/ais/wire.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"
#include "common/messages/checks.hpp"

namespace lookout::ais {

static_assert(static_cast<int>(Sender::kClassA) == ais_ship_t::SENDER_CLASS_A);
static_assert(static_cast<int>(Sender::kClassB) == ais_ship_t::SENDER_CLASS_B);
static_assert(static_cast<int>(Sender::kAid) == ais_ship_t::SENDER_AID);
static_assert(static_cast<int>(Sender::kBase) == ais_ship_t::SENDER_BASE);
static_assert(static_cast<int>(Sender::kAircraft) == ais_ship_t::SENDER_AIRCRAFT);
static_assert(static_cast<int>(ShipState::kTracked) == ais_ship_t::STATE_TRACKED);
static_assert(static_cast<int>(ShipState::kUnsure) == ais_ship_t::STATE_UNSURE);
static_assert(static_cast<int>(ShipState::kAisOnly) == ais_ship_t::STATE_AIS_ONLY);
static_assert(static_cast<int>(Status::kNoPosition) == ais_t::STATUS_NO_POSITION);
static_assert(static_cast<int>(Status::kNoPose) == ais_t::STATUS_NO_POSE);

namespace {

// Bounds far beyond the reach of any lidar, so that arithmetic inside stays far from overflow.
constexpr double kMostMapM = 1.4e7;
constexpr double kMostVariance = 1e12;
constexpr double kMostSpeedMps = 1000.0;
constexpr double kMostSizeM = 1e5;

bool IsAtMost(double value, double bound) { return std::abs(value) <= bound; }  // NaN is not
bool IsSize(double value) { return std::isnan(value) || (value >= 0.0 && value <= kMostSizeM); }

bool IsVariance(double variance) { return variance >= 0.0 && variance <= kMostVariance; }

// Positive semidefinite, but for rounding.
bool IsCovariance(double a, double b, double c) { return IsVariance(a) && IsVariance(c) && IsAtMost(b, std::sqrt(a * c) * 1.000001); }

bool IsConfirmed(const track_t& track) { return track.status == track_t::STATUS_CONFIRMED || track.status == track_t::STATUS_COASTING; }

bool AreNumbersGood(const track_t& track) {
  const auto& covariance = track.covariance;
  return IsAtMost(track.position_map_m[0], kMostMapM) && IsAtMost(track.position_map_m[1], kMostMapM) &&
         IsAtMost(track.velocity_map_mps[0], kMostSpeedMps) && IsAtMost(track.velocity_map_mps[1], kMostSpeedMps) &&
         IsCovariance(covariance[0][0], covariance[0][1], covariance[1][1]) && IsCovariance(covariance[2][2], covariance[2][3], covariance[3][3]) &&
         IsSize(track.length_m) && IsSize(track.width_m) && (std::isnan(track.length_bearing_rad) || IsAtMost(track.length_bearing_rad, kTwoPi)) &&
         std::ranges::all_of(track.outline_east_m, [](float east_m) { return IsAtMost(east_m, kMostMapM); }) &&
         std::ranges::all_of(track.outline_north_m, [](float north_m) { return IsAtMost(north_m, kMostMapM); });
}

TrackedThing ToThing(const track_t& track) {
  TrackedThing thing;
  thing.id = track.id;
  thing.center_map_m = {track.position_map_m[0], track.position_map_m[1]};
  thing.velocity_map_mps = {track.velocity_map_mps[0], track.velocity_map_mps[1]};
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) {
      thing.covariance_m2(i, k) = track.covariance[std::min(i, k)][std::max(i, k)];
      thing.velocity_covariance(i, k) = track.covariance[2 + std::min(i, k)][2 + std::max(i, k)];
    }
  }
  thing.length_m = double{track.length_m};
  thing.width_m = double{track.width_m};
  thing.length_bearing_rad = double{track.length_bearing_rad};
  thing.seen_share = std::isnan(track.seen_share) ? 0.0 : double{track.seen_share};
  thing.outline_map_m.reserve(track.outline_east_m.size());
  for (std::size_t i = 0; i < track.outline_east_m.size(); ++i) {
    thing.outline_map_m.emplace_back(double{track.outline_east_m[i]}, double{track.outline_north_m[i]});
  }
  return thing;
}

std::vector<Eigen::Vector2d> ShoreOf(const tracks_t& message) {
  std::vector<Eigen::Vector2d> shore_m;
  shore_m.reserve(message.waterline_east_m.size());
  for (std::size_t i = 0; i < message.waterline_east_m.size(); ++i) {
    const Eigen::Vector2d cell_m(double{message.waterline_east_m[i]}, double{message.waterline_north_m[i]});
    if (IsAtMost(cell_m.x(), kMostMapM) && IsAtMost(cell_m.y(), kMostMapM)) shore_m.push_back(cell_m);
  }
  return shore_m;
}

float ToFloat(double value) { return static_cast<float>(Canonical(value)); }

ais_ship_t ToMessage(const ShipInPicture& told) {
  const auto& ship = told.ship;
  const auto& fix = *ship.fix;
  ais_ship_t message{};
  message.mmsi = ship.mmsi;
  message.sender = static_cast<std::int32_t>(ship.sender);
  message.is_virtual = ship.is_virtual;
  message.name = ship.name;
  message.call_sign = ship.call_sign;
  message.ship_type = ship.ship_type;
  message.bow_m = ToFloat(ship.dimensions.bow_m);
  message.stern_m = ToFloat(ship.dimensions.stern_m);
  message.port_m = ToFloat(ship.dimensions.port_m);
  message.starboard_m = ToFloat(ship.dimensions.starboard_m);
  message.has_reference = ship.dimensions.has_reference;
  message.report_utime_us = ToUtimeUs(fix.time);
  message.is_report_time_known = fix.is_time_known;
  message.arrival_utime_us = ToUtimeUs(fix.arrival);
  message.is_accurate = fix.report.is_accurate;
  message.report_speed_mps = ToFloat(fix.report.speed_mps);
  message.report_course_rad = ToFloat(fix.report.course_rad);
  message.heading_rad = ToFloat(fix.report.heading_rad);
  message.turn_rate_radps = ToFloat(fix.report.turn_radps);
  message.navigational_status = fix.report.navigational_status;
  message.latitude_deg = Canonical(told.place.latitude_deg);
  message.longitude_deg = Canonical(told.place.longitude_deg);
  const Eigen::Vector2d unknown = Eigen::Vector2d::Constant(kNan);
  const Eigen::Vector2d center_m = told.predicted ? told.predicted->center_map_m : unknown;
  const Eigen::Matrix2d covariance_m2 = told.predicted ? told.predicted->covariance_m2 : Eigen::Matrix2d::Constant(kNan);
  for (int i = 0; i < 2; ++i) message.position_map_m[i] = Canonical(center_m[i]);
  message.covariance_m2[0] = Canonical(covariance_m2(0, 0));
  message.covariance_m2[1] = Canonical(covariance_m2(0, 1));
  message.covariance_m2[2] = Canonical(covariance_m2(1, 1));
  message.range_m = ToFloat(told.range_m);
  message.bearing_rad = ToFloat(told.bearing_rad);
  message.state = static_cast<std::int32_t>(told.state);
  message.track_id = told.track_id;
  message.track_probability = ToFloat(told.probability);
  return message;
}

}  // namespace

Fault FaultOf(const tracks_t& message) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto end_time = UtimeFromWire(message.end_utime_us);
  if (!time || !end_time || !UtimeFromWire(message.begin_utime_us) || *end_time < *time) return kTracksTime;
  if (!messages::IsWellFormed(message) || message.num_parts > messages::kMaxParts) return kTracksParts;
  // Tentative ones come first, with ids of -2 and below.
  std::int64_t last_id = std::numeric_limits<std::int64_t>::min();
  for (const auto& track : message.tracks) {
    if (track.id <= last_id) return kTracksId;
    last_id = track.id;
    if (IsConfirmed(track) && !AreNumbersGood(track)) return kTracksNumber;
  }
  return {};
}

std::variant<TracksOfScan, Fault> ToScan(std::span<const tracks_t> parts) {
  const auto& head = parts.front();
  TracksOfScan scan;
  scan.time = Utime(std::chrono::microseconds(head.utime_us));
  scan.end_time = Utime(std::chrono::microseconds(head.end_utime_us));
  scan.seq = head.seq;
  scan.raw_seq = head.raw_seq;
  scan.begin_seq = head.begin_seq;
  scan.begin_time = Utime(std::chrono::microseconds(head.begin_utime_us));
  scan.datum = {head.datum_latitude_deg, head.datum_longitude_deg, head.datum_ellipsoid_height_m};
  for (const auto& part : parts) {
    for (const auto& track : part.tracks) {
      if (!IsConfirmed(track)) continue;
      if (!scan.tracks.empty() && track.id <= scan.tracks.back().id) return kTracksId;
      scan.tracks.push_back(ToThing(track));
    }
    if (part.num_waterline > 0) {
      auto shore_m = ShoreOf(part);
      if (!scan.shore_m) scan.shore_m.emplace();
      scan.shore_m->insert(scan.shore_m->end(), shore_m.begin(), shore_m.end());
    }
  }
  return scan;
}

Item ToItem(const nav_raw_t& message, Utime time) { return {time, message.kind == nav_raw_t::KIND_START, message.source, message.sentence}; }

ais_t ToMessage(const TracksOfScan& scan, const Picture& picture, std::int64_t seq) {
  ais_t message{};
  message.utime_us = ToUtimeUs(scan.time);
  message.seq = seq;
  message.raw_seq = scan.raw_seq;
  message.scan_seq = scan.seq;
  message.end_utime_us = ToUtimeUs(scan.end_time);
  message.tracks_begin_utime_us = ToUtimeUs(scan.begin_time);
  message.status = static_cast<std::int32_t>(picture.status);
  message.own_mmsi = picture.own_mmsi;
  message.ships.reserve(picture.ships.size());
  for (const auto& ship : picture.ships) message.ships.push_back(ToMessage(ship));
  message.num_ships = messages::CountOf(message.ships);
  return message;
}

}  // namespace lookout::ais
