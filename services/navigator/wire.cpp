#include "services/navigator/wire.hpp"

#include <algorithm>
#include <cmath>

#include "services/navigator/core/sentence.hpp"

namespace lookout::navigator {

namespace {

// All that is unknown goes out as one and the same NaN: same bytes whatever made it.
double Canonical(double value) { return std::isnan(value) ? kNan : value; }

void Copy(const Eigen::Vector3d& from, double (&to)[3]) {
  for (int axis = 0; axis < 3; ++axis) to[axis] = Canonical(from[axis]);
}

static_assert(static_cast<int>(ItemKind::kStart) == nav_raw_t::KIND_START && static_cast<int>(ItemKind::kEnd) == nav_raw_t::KIND_END);
static_assert(static_cast<int>(PoseStatus::kUnknown) == pose_t::STATUS_UNKNOWN && static_cast<int>(HeadingSource::kCourse) == pose_t::HEADING_COURSE);
static_assert(static_cast<int>(FixQuality::kSimulator) == gnss_fix_t::QUALITY_SIMULATOR);

// rad/s and m/s2: beyond what any strapdown sensor of a boat measures (100 g, 160 turns a second).
constexpr double kMaxImuValue = 1000.0;

}  // namespace

nav_raw_t ToMessage(const Item& item) {
  nav_raw_t message{};
  message.utime_us = ToUtimeUs(item.time);
  message.seq = item.seq;
  message.kind = static_cast<std::int32_t>(item.kind);
  message.source = item.source;
  message.sentence = item.sentence;
  if (item.imu) {
    auto& sample = message.imu.emplace_back();
    std::ranges::copy(item.imu->angular_velocity_radps, sample.angular_velocity_radps);
    std::ranges::copy(item.imu->specific_force_mps2, sample.specific_force_mps2);
    std::ranges::fill(sample.magnetic_field_ut, kNan);
  }
  message.num_imu = static_cast<std::int32_t>(message.imu.size());
  return message;
}

ItemResult ToItem(const nav_raw_t& message) {
  const auto time = UtimeFromWire(message.utime_us);
  if (!time) return {ItemFault::kBadTime, {}};
  if (message.kind < nav_raw_t::KIND_START || message.kind > nav_raw_t::KIND_END) return {ItemFault::kBadKind, {}};
  if (message.imu.size() != (message.kind == nav_raw_t::KIND_IMU ? 1U : 0U)) return {ItemFault::kBadImu, {}};
  const bool is_sentence = message.kind == nav_raw_t::KIND_SENTENCE;
  const bool has_source = is_sentence || message.kind == nav_raw_t::KIND_IMU;
  if (is_sentence ? !IsLine(message.sentence) : !message.sentence.empty()) return {ItemFault::kBadText, {}};
  if (has_source ? !IsSourceName(message.source) : !message.source.empty()) return {ItemFault::kBadText, {}};
  ItemResult result{ItemFault::kNone, {*time, message.seq, static_cast<ItemKind>(message.kind), message.source, message.sentence}};
  for (const auto& sample : message.imu) {
    const auto is_plausible = [](double value) { return std::abs(value) <= kMaxImuValue; };  // not for NaN
    if (!std::ranges::all_of(sample.angular_velocity_radps, is_plausible) || !std::ranges::all_of(sample.specific_force_mps2, is_plausible)) {
      return {ItemFault::kBadImu, {}};
    }
    auto& imu = result.item.imu.emplace();
    std::ranges::copy(sample.angular_velocity_radps, imu.angular_velocity_radps.begin());
    std::ranges::copy(sample.specific_force_mps2, imu.specific_force_mps2.begin());
  }
  return result;
}

gnss_fix_t ToMessage(const GnssFix& fix, std::int64_t seq, std::int64_t raw_seq) {
  gnss_fix_t message{};
  message.utime_us = ToUtimeUs(fix.when.utc);
  message.seq = seq;
  message.raw_seq = raw_seq;
  message.arrival_utime_us = ToUtimeUs(fix.when.arrival);
  message.is_time_from_sentence = fix.when.has_sentence_utc ? 1 : 0;
  message.source = fix.source;
  message.sentence_type = fix.sentence_type;
  message.quality = static_cast<std::int32_t>(fix.quality);
  message.num_satellites = fix.num_satellites;
  message.hdop = Canonical(fix.hdop);
  message.horizontal_sd_m = Canonical(fix.horizontal_sd_m);
  message.latitude_deg = fix.position ? fix.position->latitude_deg : kNan;
  message.longitude_deg = fix.position ? fix.position->longitude_deg : kNan;
  message.msl_height_m = Canonical(fix.msl_height_m);
  message.geoid_separation_m = Canonical(fix.geoid_separation_m);
  message.speed_mps = Canonical(fix.speed_mps);
  message.course_rad = Canonical(fix.course_rad);
  return message;
}

attitude_t ToMessage(const Attitude& attitude, std::int64_t seq, std::int64_t raw_seq) {
  attitude_t message{};
  message.utime_us = ToUtimeUs(attitude.when.utc);
  message.seq = seq;
  message.raw_seq = raw_seq;
  message.arrival_utime_us = ToUtimeUs(attitude.when.arrival);
  message.is_time_from_sentence = attitude.when.has_sentence_utc ? 1 : 0;
  message.source = attitude.source;
  message.sentence_type = attitude.sentence_type;
  message.heading_rad = Canonical(attitude.heading_rad);
  message.pitch_rad = Canonical(attitude.pitch_rad);
  message.roll_rad = Canonical(attitude.roll_rad);
  message.heave_m = Canonical(attitude.heave_m);
  message.heading_sd_rad = Canonical(attitude.heading_sd_rad);
  message.pitch_sd_rad = Canonical(attitude.pitch_sd_rad);
  message.roll_sd_rad = Canonical(attitude.roll_sd_rad);
  return message;
}

pose_t ToMessage(const Pose& pose, std::int64_t seq, std::int64_t raw_seq) {
  pose_t message{};
  message.utime_us = ToUtimeUs(pose.time);
  message.seq = seq;
  message.raw_seq = raw_seq;
  message.status = static_cast<std::int32_t>(pose.status);
  message.heading_source = static_cast<std::int32_t>(pose.heading_source);
  message.has_attitude = pose.has_attitude ? 1 : 0;
  message.datum_latitude_deg = Canonical(pose.datum.latitude_deg);
  message.datum_longitude_deg = Canonical(pose.datum.longitude_deg);
  message.datum_ellipsoid_height_m = Canonical(pose.datum.ellipsoid_height_m);
  message.latitude_deg = Canonical(pose.latitude_deg);
  message.longitude_deg = Canonical(pose.longitude_deg);
  message.ellipsoid_height_m = Canonical(pose.ellipsoid_height_m);
  Copy(pose.p_map_m, message.position_map_m);
  Copy(pose.velocity_map_mps, message.velocity_map_mps);
  message.heading_rad = Canonical(pose.heading_rad);
  message.pitch_rad = Canonical(pose.pitch_rad);
  message.roll_rad = Canonical(pose.roll_rad);
  message.heave_m = Canonical(pose.heave_m);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 9; ++column) message.covariance[row][column] = Canonical(pose.covariance(row, column));
  }
  return message;
}

std::optional<LidarSentence> ToLidarSentence(const lidar_nmea_t& message) {
  const auto arrival = UtimeFromWire(message.host_utime_us);
  if (!arrival || !IsLine(message.sentence)) return std::nullopt;
  return LidarSentence{*arrival, message.sentence};
}

}  // namespace lookout::navigator
