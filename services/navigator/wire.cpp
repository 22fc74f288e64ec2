#include "services/navigator/wire.hpp"

#include <algorithm>
#include <cmath>

#include "services/navigator/core/lines.hpp"

namespace lookout::navigator {

namespace {

// Members that GNSS_FIX and ATTITUDE share.
template <typename Message, typename Measured>
Message Begin(const Measured& measured, std::int64_t seq, std::int64_t raw_seq) {
  Message message{};
  message.utime_us = ToUtimeUs(measured.when.utc);
  message.seq = seq;
  message.raw_seq = raw_seq;
  message.arrival_utime_us = ToUtimeUs(measured.when.arrival);
  message.is_time_from_sentence = measured.when.has_sentence_utc ? 1 : 0;
  message.source = measured.source;
  message.sentence_type = measured.sentence_type;
  return message;
}

static_assert(static_cast<int>(ItemKind::kStart) == nav_raw_t::KIND_START && static_cast<int>(ItemKind::kEnd) == nav_raw_t::KIND_END);
static_assert(static_cast<int>(PoseStatus::kRelativeToBoat) == pose_t::STATUS_RELATIVE_TO_BOAT &&
              static_cast<int>(HeadingSource::kCourse) == pose_t::HEADING_COURSE);
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
    Eigen::Vector3d::Map(sample.angular_velocity_radps) = item.imu->angular_velocity_radps;
    Eigen::Vector3d::Map(sample.specific_force_mps2) = item.imu->specific_force_mps2;
    std::ranges::fill(sample.magnetic_field_ut, kNan);
  }
  message.num_imu = static_cast<std::int32_t>(message.imu.size());
  return message;
}

std::variant<Item, Refusal> ToItem(const nav_raw_t& message) {
  const auto time = UtimeFromWire(message.utime_us);
  if (!time) return kRawTime;
  if (message.kind < nav_raw_t::KIND_START || message.kind > nav_raw_t::KIND_END) return kRawKind;
  if (message.imu.size() != (message.kind == nav_raw_t::KIND_IMU ? 1U : 0U)) return kRawImu;
  const bool is_sentence = message.kind == nav_raw_t::KIND_SENTENCE;
  const bool has_source = is_sentence || message.kind == nav_raw_t::KIND_IMU;
  if (is_sentence ? !IsLine(message.sentence) : !message.sentence.empty()) return kRawText;
  if (has_source ? !IsSourceName(message.source) && !IsImportedSource(message.source) : !message.source.empty()) return kRawText;
  Item item{*time, message.seq, static_cast<ItemKind>(message.kind), message.source, message.sentence};
  for (const auto& sample : message.imu) {
    const auto is_plausible = [](double value) { return std::abs(value) <= kMaxImuValue; };  // not for NaN
    if (!std::ranges::all_of(sample.angular_velocity_radps, is_plausible) || !std::ranges::all_of(sample.specific_force_mps2, is_plausible)) {
      return kRawImu;
    }
    item.imu = {Eigen::Vector3d::Map(sample.angular_velocity_radps), Eigen::Vector3d::Map(sample.specific_force_mps2)};
  }
  return item;
}

std::optional<OdometryMotion> ToMotion(const lidar_odometry_t& message) {
  const auto begin = UtimeFromWire(message.begin_utime_us);
  const auto end = UtimeFromWire(message.utime_us);
  if (!begin || !end || *end < *begin) return std::nullopt;
  OdometryMotion motion{*begin, *end, message.status == lidar_odometry_t::STATUS_OK};
  if (motion.is_known) {
    motion.displacement_m = Eigen::Vector2d::Map(message.displacement_m);
    motion.turn_rad = message.turn_rad;
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    motion.covariance = RowMajor::Map(&message.covariance[0][0]);
    if (!motion.displacement_m.allFinite() || !std::isfinite(motion.turn_rad) || !motion.covariance.allFinite()) return std::nullopt;
  }
  // A motion that a reader of NAV_RAW would refuse does not enter NAV_RAW.
  return ParseOdometry(ToSentence(motion));
}

gnss_fix_t ToMessage(const GnssFix& fix, std::int64_t seq, std::int64_t raw_seq) {
  auto message = Begin<gnss_fix_t>(fix, seq, raw_seq);
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
  auto message = Begin<attitude_t>(attitude, seq, raw_seq);
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
  Eigen::Vector3d::Map(message.position_map_m) = pose.p_map_m.unaryExpr(&Canonical);
  Eigen::Vector3d::Map(message.velocity_map_mps) = pose.velocity_map_mps.unaryExpr(&Canonical);
  message.heading_rad = Canonical(pose.heading_rad);
  message.pitch_rad = Canonical(pose.pitch_rad);
  message.roll_rad = Canonical(pose.roll_rad);
  message.heave_m = Canonical(pose.heave_m);
  using RowMajor = Eigen::Matrix<double, 9, 9, Eigen::RowMajor>;
  RowMajor::Map(&message.covariance[0][0]) = pose.covariance.unaryExpr(&Canonical);
  return message;
}

}  // namespace lookout::navigator
