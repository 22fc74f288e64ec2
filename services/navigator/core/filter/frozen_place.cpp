#include "services/navigator/core/filter/frozen_place.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/navigator/core/filter/state.hpp"

namespace lookout::navigator {

namespace {

constexpr double kMaxVelocityAgeS = 2.0;  // a velocity stands for no longer
constexpr double kMetresPerDeg = 111'320.0;
// A motion that is shorter than this many of its deviations is noise.
constexpr double kInSds = 3.0;

void LearnStep(double before_deg, double now_deg, double& step_deg) {
  const double step = std::abs(now_deg - before_deg);
  if (step > 0.0 && !(step >= step_deg)) step_deg = step;
}

}  // namespace

double FrozenPlaces::Place::StepM() const {
  if (std::isnan(latitude_step_deg) && std::isnan(longitude_step_deg)) return kUnknownStepM;
  // On a way along a parallel only the longitude's step is known: the latitude's step then counts as equal, as both have the same digits.
  const double degrees = std::isnan(latitude_step_deg) ? longitude_step_deg : latitude_step_deg;
  return kMetresPerDeg * Hypot(degrees, std::isnan(longitude_step_deg) ? degrees : longitude_step_deg);
}

Eigen::Vector2d FrozenPlaces::Receiver::WayAt(Utime time) const {
  if (!velocity_time) return way_m;
  return way_m + std::clamp(filter::SecondsBetween(*velocity_time, time), 0.0, kMaxVelocityAgeS) * velocity_mps;
}

bool FrozenPlaces::Receiver::HasVelocity(Utime time) const {
  return velocity_time && std::abs(filter::SecondsBetween(*velocity_time, time)) <= kMaxVelocityAgeS;
}

void FrozenPlaces::AddVelocity(Utime time, double speed_mps, double course_rad, Receiver& receiver) {
  const bool is_at_rest = speed_mps < kLeastSpeedMps;
  if (std::isnan(speed_mps) || (std::isnan(course_rad) && !is_at_rest)) return;
  const bool is_late =
      receiver.velocity_time && time < *receiver.velocity_time && filter::SecondsBetween(time, *receiver.velocity_time) < kMaxVelocityAgeS;
  if (is_late) return;
  receiver.way_m = receiver.WayAt(time);
  receiver.velocity_time = time;
  receiver.velocity_mps.setZero();
  if (is_at_rest) return;
  const auto [sin, cos] = SinCosOf(course_rad);
  receiver.velocity_mps = speed_mps * Eigen::Vector2d(sin, cos);
}

void FrozenPlaces::Begin(const GnssFix& fix, const Receiver& receiver, Place& place) const {
  const auto& now = *fix.position;
  LearnStep(place.latitude_deg, now.latitude_deg, place.latitude_step_deg);
  LearnStep(place.longitude_deg, now.longitude_deg, place.longitude_step_deg);
  place.latitude_deg = now.latitude_deg;
  place.longitude_deg = now.longitude_deg;
  place.since = fix.when.time;
  place.way_m = receiver.WayAt(fix.when.time);
  place.lidar_way_m = lidar_way_m_;
  place.is_frozen_by_lidar = false;
}

// How far the boat has moved since the place first came.
double FrozenPlaces::WayM(Utime time, const Receiver& receiver, Place& place) const {
  if (receiver.HasVelocity(time)) place.lidar_way_m = lidar_way_m_;  // the receiver is believed
  const double lidar_m = (lidar_way_m_ - place.lidar_way_m).norm();
  const double receiver_m = (receiver.WayAt(time) - place.way_m).norm();
  const bool may_begin = time - place.since <= kByLidar;
  return place.is_frozen_by_lidar || may_begin ? std::max(receiver_m, lidar_m) : receiver_m;
}

bool FrozenPlaces::Judge(const GnssFix& fix) {
  Receiver& receiver = receivers_[fix.source];
  const Utime time = fix.when.time;
  AddVelocity(time, fix.speed_mps, fix.course_rad, receiver);
  const auto [entry, is_new] = receiver.places.try_emplace(std::string(fix.sentence_type));
  Place& place = entry->second;
  if (is_new || place.latitude_deg != fix.position->latitude_deg || place.longitude_deg != fix.position->longitude_deg || time < place.since) {
    Begin(fix, receiver, place);
    receiver.is_frozen = false;
    return false;
  }
  const double way_m = WayM(time, receiver, place);
  receiver.is_frozen = way_m > std::max(kMostWayM, kMostSteps * place.StepM());
  place.is_frozen_by_lidar = receiver.is_frozen && !receiver.HasVelocity(time);
  if (receiver.is_frozen) last_ = {fix.source, time, filter::SecondsBetween(place.since, time), way_m};
  return receiver.is_frozen;
}

bool FrozenPlaces::Judge(const GroundVelocity& velocity) {
  Receiver& receiver = receivers_[velocity.source];
  AddVelocity(velocity.time, velocity.speed_mps, velocity.course_rad, receiver);
  return receiver.is_frozen;
}

void FrozenPlaces::Add(const OdometryMotion& motion) {
  if (!motion.is_known) return;
  const auto& way_m = motion.displacement_m;
  const double sd_m = Hypot(kMotionSdM, std::sqrt(std::max(motion.covariance(0, 0), motion.covariance(1, 1))));
  const double least_m = std::max(kLeastSpeedMps * filter::SecondsBetween(motion.begin, motion.end), kInSds * sd_m);
  // Forward and port of the begin in axes of which the second is along the bow of the first scan.
  const auto [sin, cos] = SinCosOf(lidar_heading_rad_);
  if (way_m.norm() > least_m) lidar_way_m_ += Eigen::Vector2d(sin * way_m.x() - cos * way_m.y(), cos * way_m.x() + sin * way_m.y());
  lidar_heading_rad_ = WrapTo2Pi(lidar_heading_rad_ + motion.turn_rad);
}

}  // namespace lookout::navigator
