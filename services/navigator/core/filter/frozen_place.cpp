#include "services/navigator/core/filter/frozen_place.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::navigator {

namespace {

// A velocity stands for no longer than this.
constexpr double kMaxVelocityAgeS = 2.0;

double SecondsFrom(Utime from, Utime to) { return std::chrono::duration<double>(to - from).count(); }

}  // namespace

void FrozenPlaces::AddVelocity(Utime time, double speed_mps, double course_rad, Receiver& receiver) {
  if (std::isnan(speed_mps)) return;
  if (receiver.velocity_time) {
    const double for_s = SecondsFrom(*receiver.velocity_time, time);
    if (for_s <= 0.0 && for_s > -kMaxVelocityAgeS) return;  // of the same epoch
    if (for_s > 0.0) receiver.way_m += std::min(for_s, kMaxVelocityAgeS) * receiver.velocity_mps;
  }
  receiver.velocity_time = time;
  receiver.velocity_mps.setZero();
  if (std::isnan(course_rad) || speed_mps < kLeastSpeedMps) return;
  const auto [sin, cos] = SinCosOf(course_rad);
  receiver.velocity_mps = speed_mps * Eigen::Vector2d(sin, cos);
}

bool FrozenPlaces::Judge(const GnssFix& fix) {
  Receiver& receiver = receivers_[fix.source];
  const Utime time = fix.when.time;
  AddVelocity(time, fix.speed_mps, fix.course_rad, receiver);
  const auto [entry, is_new] = receiver.places.try_emplace(std::string(fix.sentence_type));
  Place& place = entry->second;
  const auto& now = *fix.position;
  if (is_new || place.latitude_deg != now.latitude_deg || place.longitude_deg != now.longitude_deg || time < place.since) {
    place = {now.latitude_deg, now.longitude_deg, time, receiver.way_m, lidar_way_m_};
    receiver.is_frozen = false;
    return false;
  }
  const bool has_velocity = receiver.velocity_time && std::abs(SecondsFrom(*receiver.velocity_time, time)) <= kMaxVelocityAgeS;
  const double way_m = std::max((receiver.way_m - place.way_m).norm(), has_velocity ? 0.0 : (lidar_way_m_ - place.lidar_way_m).norm());
  receiver.is_frozen = way_m > kMostWayM;
  if (receiver.is_frozen) last_ = {fix.source, time, SecondsFrom(place.since, time), way_m};
  return receiver.is_frozen;
}

bool FrozenPlaces::Judge(const GroundVelocity& velocity) {
  Receiver& receiver = receivers_[velocity.source];
  AddVelocity(velocity.time, velocity.speed_mps, velocity.course_rad, receiver);
  return receiver.is_frozen;
}

void FrozenPlaces::Add(const OdometryMotion& motion) {
  if (!motion.is_known) return;
  const double for_s = SecondsFrom(motion.begin, motion.end);
  // Forward and port of the begin in axes of which the second is along the bow of the first scan.
  const auto [sin, cos] = SinCosOf(lidar_heading_rad_);
  const auto& way_m = motion.displacement_m;
  if (for_s > 0.0 && way_m.norm() >= kLeastSpeedMps * for_s) {
    lidar_way_m_ += Eigen::Vector2d(sin * way_m.x() - cos * way_m.y(), cos * way_m.x() + sin * way_m.y());
  }
  lidar_heading_rad_ = WrapTo2Pi(lidar_heading_rad_ + motion.turn_rad);
}

}  // namespace lookout::navigator
