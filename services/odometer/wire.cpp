#include "services/odometer/wire.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include "common/core/elementary.hpp"

namespace lookout::odometer {

static_assert(static_cast<int>(Reason::kFirstScan) == lidar_odometry_t::REASON_FIRST_SCAN);
static_assert(static_cast<int>(Reason::kGap) == lidar_odometry_t::REASON_GAP);
static_assert(static_cast<int>(Reason::kFewReturns) == lidar_odometry_t::REASON_FEW_RETURNS);
static_assert(static_cast<int>(Reason::kOneThing) == lidar_odometry_t::REASON_ONE_THING);
static_assert(static_cast<int>(Reason::kNoFit) == lidar_odometry_t::REASON_NO_FIT);
static_assert(static_cast<int>(Reason::kUndetermined) == lidar_odometry_t::REASON_UNDETERMINED);

std::optional<Scan> ToScan(const std::vector<lidar_scan_t>& parts) {
  const auto& head = parts.front();
  Scan scan;
  scan.time = Utime(std::chrono::microseconds(head.utime_us));
  scan.end_time = Utime(std::chrono::microseconds(head.end_utime_us));
  scan.seq = head.seq;
  scan.raw_seq = head.raw_seq;
  scan.range_unit_m = head.range_unit_m;
  scan.rings.reserve(head.elevation_rad.size());
  for (std::size_t ring = 0; ring < head.elevation_rad.size(); ++ring) {
    scan.rings.push_back(
        {double{head.elevation_rad[ring]}, double{head.azimuth_offset_rad[ring]}, head.time_offset_ns[ring], double{head.origin_height_m[ring]}});
  }
  const auto num_returns = static_cast<std::size_t>(head.num_returns);
  for (const auto& part : parts) {
    if (!std::cmp_equal(part.first_column, scan.azimuth_rad.size())) return std::nullopt;
    scan.azimuth_rad.insert(scan.azimuth_rad.end(), part.azimuth_rad.begin(), part.azimuth_rad.end());
    scan.time_ns.insert(scan.time_ns.end(), part.time_ns.begin(), part.time_ns.end());
    for (std::size_t cell = 0; cell + num_returns <= part.range.size(); cell += num_returns) {
      std::uint16_t nearest = 0;
      for (std::size_t i = 0; i < num_returns; ++i) {
        const auto range = static_cast<std::uint16_t>(part.range[cell + i]);
        if (range != 0 && (nearest == 0 || range < nearest)) nearest = range;
      }
      scan.range.push_back(nearest);
    }
  }
  if (!std::cmp_equal(scan.azimuth_rad.size(), head.num_turn_columns)) return std::nullopt;
  if (scan.range.size() != scan.azimuth_rad.size() * scan.rings.size()) return std::nullopt;
  return scan;
}

lidar_odometry_t ToMessage(const Motion& motion, const Scan& scan) {
  lidar_odometry_t message{};
  message.utime_us = ToUtimeUs(motion.end);
  message.seq = scan.seq;
  message.raw_seq = scan.raw_seq;
  message.begin_utime_us = ToUtimeUs(motion.begin);
  message.status = static_cast<std::int32_t>(motion.is_known() ? +lidar_odometry_t::STATUS_OK : +lidar_odometry_t::STATUS_UNKNOWN);
  message.reason = static_cast<std::int32_t>(motion.reason);
  const auto known = [&motion](double value) { return motion.is_known() ? Canonical(value) : kNan; };
  message.displacement_m[0] = known(motion.displacement_m.x());
  message.displacement_m[1] = known(motion.displacement_m.y());
  message.turn_rad = known(motion.turn_rad);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) message.covariance[i][k] = known(0.5 * (motion.covariance(i, k) + motion.covariance(k, i)));
  }
  message.num_returns = motion.num_returns;
  message.num_matched = motion.num_matched;
  message.residual_m = static_cast<float>(motion.residual_m);
  return message;
}

}  // namespace lookout::odometer
