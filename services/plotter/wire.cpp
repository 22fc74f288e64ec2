#include "services/plotter/wire.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <string>

#include "common/core/angles.hpp"
#include "common/core/pose.hpp"
#include "common/core/printable.hpp"
#include "common/messages/alert_sound.hpp"
#include "common/messages/words.hpp"

namespace lookout::plotter {

namespace {

// Bounds far beyond the reach of any lidar.
constexpr double kMostSpeedMps = 1000.0;
constexpr double kMostLengthM = 1e5;
constexpr double kMostTcpaS = 1e6;
constexpr std::size_t kMostTextBytes = 1000;
constexpr std::int64_t kMostAlertId = 1'000'000'000'000'000;

// Longer than the usual intervals of reports (M.1371-5, annex 1, table 1), so that receivers still show the ship.
constexpr double kUnderWayMps = 1.0;
constexpr std::int64_t kReportsUnderWayUs = 60'000'000;
constexpr std::int64_t kReportsAtRestUs = 240'000'000;

bool IsWithin(double value, double min, double max) { return value >= min && value <= max; }  // NaN is not
bool IsWithinOrUnknown(double value, double min, double max) { return std::isnan(value) || IsWithin(value, min, max); }

bool IsOnEarth(double latitude_deg, double longitude_deg) { return IsWithin(latitude_deg, -90.0, 90.0) && IsWithin(longitude_deg, -180.0, 180.0); }

bool AreNumbersGood(const track_t& track) {
  return IsOnEarth(track.latitude_deg, track.longitude_deg) && IsWithin(track.velocity_map_mps[0], -kMostSpeedMps, kMostSpeedMps) &&
         IsWithin(track.velocity_map_mps[1], -kMostSpeedMps, kMostSpeedMps) && IsWithinOrUnknown(track.length_m, 0.0, kMostLengthM) &&
         IsWithinOrUnknown(track.width_m, 0.0, kMostLengthM) && IsWithinOrUnknown(track.length_bearing_rad, -kTwoPi, 2.0 * kTwoPi) &&
         IsWithinOrUnknown(track.distance_m, 0.0, kMostLengthM) && IsWithinOrUnknown(track.cpa_m, 0.0, kMostLengthM) &&
         IsWithinOrUnknown(track.tcpa_s, -kMostTcpaS, kMostTcpaS) && IsWithinOrUnknown(track.cpa_probability, 0.0, 1.0);
}

// Precondition: the cause is one of these. Ids of the watch run from -1 down.
Cause CauseOf(const alert_t& alert) {
  switch (alert.cause) {
    case alert_t::CAUSE_GUARD_ZONE:
      return Cause::kGuardZone;
    case alert_t::CAUSE_CLOSEST_APPROACH:
      return Cause::kClosestApproach;
    default:
      return alert.id > 0 ? Cause::kPartUnseen : Cause::kWatch;
  }
}

Sound SoundOf(const alerts_t& message, const alert_t& alert) {
  switch (messages::SoundOf(message, alert)) {
    case messages::AlertSound::kSounds:
      return Sound::kSounds;
    case messages::AlertSound::kSilenced:
      return Sound::kSilenced;
    default:
      return Sound::kQuiet;
  }
}

std::string_view KindText(std::int32_t kind) {
  switch (kind) {
    case track_t::KIND_BUOY:
      return "buoy";
    case track_t::KIND_BOAT:
      return "boat";
    case track_t::KIND_STRUCTURE:
      return "structure";
    default:
      return "obstacle";
  }
}

TargetState StateOf(std::int32_t status) {
  if (status == track_t::STATUS_TENTATIVE) return TargetState::kAcquiring;
  return status == track_t::STATUS_LOST ? TargetState::kLost : TargetState::kTracking;
}

// Axes of the map frame are those at the datum.
Eigen::Vector2d VelocityAt(const Position& position, const Datum& datum, const Eigen::Vector3d& velocity_map_mps) {
  if (velocity_map_mps.isZero(0.0) || !IsOnEarth(datum.latitude_deg, datum.longitude_deg)) return velocity_map_mps.head<2>();
  const LocalFrame here({position.latitude_deg, position.longitude_deg, 0.0});
  return (here.TransformFrom(datum.Map()).linear() * velocity_map_mps).head<2>();
}

double CourseOf(const Eigen::Vector2d& velocity_mps) {
  return velocity_mps.isZero(0.0) ? kNan : WrapTo2Pi(Atan2(velocity_mps.x(), velocity_mps.y()));
}

Target ToTarget(const track_t& track, const Datum& datum) {
  Target target;
  target.id = track.id;
  target.name = std::string(KindText(track.kind)) + " " + std::to_string(track.id);
  target.state = StateOf(track.status);
  target.first = UtimeFromWire(track.first_utime_us).value_or(Utime());
  target.position = {track.latitude_deg, track.longitude_deg};
  const auto velocity_mps = VelocityAt(target.position, datum, {track.velocity_map_mps[0], track.velocity_map_mps[1], 0.0});
  target.velocity_east_mps = velocity_mps.x();
  target.velocity_north_mps = velocity_mps.y();
  target.speed_mps = Hypot(velocity_mps.x(), velocity_mps.y());
  target.course_rad = CourseOf(velocity_mps);
  target.length_m = track.length_m;
  target.width_m = track.width_m;
  target.length_bearing_rad = track.length_bearing_rad;
  target.distance_m = track.distance_m;
  target.cpa_m = track.cpa_m;
  target.tcpa_s = track.tcpa_s;
  target.cpa_probability = track.cpa_probability;
  return target;
}

}  // namespace

std::variant<TracksPart, Fault> ToTracksPart(const tracks_t& message) {
  const auto time = UtimeFromWire(message.end_utime_us);
  const auto begin = UtimeFromWire(message.begin_utime_us);
  if (!UtimeFromWire(message.utime_us) || !time || !begin) return kTracksTime;
  if (!messages::IsWellFormed(message) || message.num_parts > messages::kMaxParts) return kTracksParts;
  TracksPart part{*time, *begin, {}};
  const Datum datum{message.datum_latitude_deg, message.datum_longitude_deg, message.datum_ellipsoid_height_m};
  // Targets of a frame that is not on the earth have no place that a chart could show.
  if (datum.IsRelative()) return part;
  // Tentative ones come first, with ids of -2 and below; 0 and -1 are none.
  std::int64_t last_id = std::numeric_limits<std::int64_t>::min();
  for (const auto& track : message.tracks) {
    if (track.id <= last_id || track.id == tracks_t::PIECE_LAND || track.id == tracks_t::PIECE_NO_TRACK) return kTracksId;
    last_id = track.id;
    if (track.status < track_t::STATUS_TENTATIVE || track.status > track_t::STATUS_LOST) return kTracksCode;
    if (!AreNumbersGood(track)) return kTracksNumber;
    part.targets.push_back(ToTarget(track, datum));
  }
  return part;
}

std::variant<std::vector<Notice>, Fault> ToNotices(const alerts_t& message) {
  std::vector<Notice> notices;
  std::set<std::int64_t> ids;
  for (const auto& alert : message.alerts) {
    const auto raised = UtimeFromWire(alert.raised_utime_us);
    const auto changed = UtimeFromWire(alert.changed_utime_us);
    if (!raised || !changed) return kAlertsTime;
    const bool are_codes_good = alert.cause >= alert_t::CAUSE_GUARD_ZONE && alert.cause <= alert_t::CAUSE_WATCH &&
                                alert.level >= alert_t::LEVEL_CAUTION && alert.level <= alert_t::LEVEL_WARNING &&
                                alert.state >= alert_t::STATE_ACTIVE && alert.state <= alert_t::STATE_CLEARED;
    if (!are_codes_good) return kAlertsCode;
    if (alert.id == 0 || std::abs(alert.id / 2) > kMostAlertId || !ids.insert(alert.id).second) return kAlertsId;
    if (alert.text.size() > kMostTextBytes) return kAlertsText;
    notices.push_back({.id = alert.id,
                       .cause = CauseOf(alert),
                       .level = static_cast<Level>(alert.level),
                       .state = static_cast<NoticeState>(alert.state),
                       .track_id = alert.track_id,
                       .raised = *raised,
                       .changed = *changed,
                       .sound = SoundOf(message, alert),
                       .text = alert.text});
  }
  return notices;
}

std::optional<GivenNames> ToGivenNames(const alerts_t& message) {
  GivenNames names;
  for (std::size_t i = 0; i < message.given_name.size(); ++i) {
    const auto& name = message.given_name[i];
    const auto track_id = message.named_track_id[i];
    if (!lookout::IsName(name) || (!names.empty() && track_id <= names.rbegin()->first)) return std::nullopt;
    names.emplace_hint(names.end(), track_id, name);
  }
  return names;
}

std::optional<ShipNames> ToShipNames(const ais_t& message) {
  const auto time = UtimeFromWire(message.end_utime_us);
  const auto begin = UtimeFromWire(message.tracks_begin_utime_us);
  if (!time || !begin) return std::nullopt;
  ShipNames names{*time, *begin, {}};
  for (const auto& ship : message.ships) {
    if (ship.state != ais_ship_t::STATE_TRACKED) continue;
    names.name_of_track[ship.track_id] = lookout::IsName(ship.name) ? ship.name : "MMSI " + words::MmsiText(ship.mmsi);
    const auto most_us = ship.report_speed_mps > kUnderWayMps ? kReportsUnderWayUs : kReportsAtRestUs;
    std::int64_t age_us = 0;
    const bool is_known = !__builtin_sub_overflow(message.end_utime_us, ship.arrival_utime_us, &age_us);
    if (is_known && age_us < most_us) names.on_air.insert(ship.track_id);
  }
  return names;
}

OwnShip ToOwnShip(const pose_t& message) {
  OwnShip own;
  own.time = Utime(std::chrono::microseconds(message.utime_us));
  own.is_estimated = message.status == pose_t::STATUS_COASTING;
  // In a frame of its own neither heading nor course are of the earth.
  if (message.status >= pose_t::STATUS_RELATIVE) {
    if (IsOnEarth(message.latitude_deg, message.longitude_deg)) own.position = {message.latitude_deg, message.longitude_deg};
    return own;
  }
  const bool has_position = message.status != pose_t::STATUS_NO_POSITION && message.status != pose_t::STATUS_UNKNOWN;
  const bool has_heading = message.status != pose_t::STATUS_NO_HEADING && message.status != pose_t::STATUS_UNKNOWN;
  // Course over ground that stands in for a heading is told as course only: a chart program would take it for a compass.
  const bool is_course = message.heading_source == pose_t::HEADING_COURSE;
  if (has_heading && !is_course && std::isfinite(message.heading_rad)) own.heading_rad = WrapTo2Pi(message.heading_rad);
  if (!has_position || !IsOnEarth(message.latitude_deg, message.longitude_deg)) return own;
  own.position = {message.latitude_deg, message.longitude_deg};
  const auto& velocity = message.velocity_map_mps;
  const bool has_velocity = std::ranges::all_of(velocity, [](double part) { return IsWithin(part, -kMostSpeedMps, kMostSpeedMps); });
  if (!has_velocity) return own;
  const Datum datum{message.datum_latitude_deg, message.datum_longitude_deg, message.datum_ellipsoid_height_m};
  const auto velocity_mps = VelocityAt(own.position, datum, {velocity[0], velocity[1], velocity[2]});
  own.speed_mps = Hypot(velocity_mps.x(), velocity_mps.y());
  own.course_rad = CourseOf(velocity_mps);
  return own;
}

alert_ack_t ToMessage(const Notice& notice, Utime host_time, std::int64_t seq) {
  alert_ack_t message{};
  message.utime_us = ToUtimeUs(host_time);
  message.seq = seq;
  message.source = "plotter";
  message.alert_id = notice.id;
  message.alert_raised_utime_us = ToUtimeUs(notice.raised);
  return message;
}

order_t ToSilence(Utime host_time, std::int64_t seq) {
  order_t message{};
  message.utime_us = ToUtimeUs(host_time);
  message.seq = seq;
  message.source = "plotter";
  message.kind = order_t::KIND_SILENCE;
  for (auto* limit : {&message.guard_zone_range_m, &message.guard_zone_from_rad, &message.guard_zone_to_rad, &message.cpa_limit_m}) {
    *limit = std::numeric_limits<float>::quiet_NaN();
  }
  return message;
}

}  // namespace lookout::plotter
