#include "services/navigator/core/antenna_tracker.hpp"

#include <cmath>

namespace lookout::navigator {

namespace {

using std::chrono::microseconds;

// Assumptions on small boats. How fast one goes that says no velocity (navigator.proto: "a boat at 3 m/s").
constexpr double kUnknownSpeedSdMps = 3.0;
// How its velocity may change unseen.
constexpr double kAccelerationSdMps2 = 0.5;
// The swing of an antenna on the waves.
constexpr double kVerticalVelocitySdMps = 0.3;
// Satellites are above only, so height is worse than position: VDOP is about one and a half to two times HDOP.
constexpr double kVerticalFactor = 2.0;

// Not through ToSeconds: its nanoseconds overflow after 292 years, and times from outside may be 300 years apart.
double Seconds(microseconds duration) { return std::chrono::duration<double>(duration).count(); }

microseconds Distance(Utime a, Utime b) { return a < b ? b - a : a - b; }

}  // namespace

AntennaTracker::AntennaTracker(const AntennaParams& params) : params_(params) {
  if (params_.datum) SetDatum(*params_.datum);
}

void AntennaTracker::SetDatum(const Datum& datum) {
  datum_ = datum;
  map_.emplace(datum.latitude_deg, datum.longitude_deg, datum.ellipsoid_height_m);
}

void AntennaTracker::Add(const GnssFix& fix) {
  if (!IsMeasured(fix.quality) || !fix.position) {
    ++num_unusable_;
    return;
  }
  const bool is_comparable = fix_ && fix_->is_time_from_sentence == fix.when.is_from_sentence;
  if (is_comparable && fix.when.time < fix_->time) {
    ++num_late_;
    return;
  }
  const double ellipsoid_height_m = fix.EllipsoidHeightM();
  const bool has_height = !std::isnan(ellipsoid_height_m);
  if (!datum_) SetDatum({fix.position->latitude_deg, fix.position->longitude_deg, has_height ? ellipsoid_height_m : 0.0});
  const bool is_same_epoch = is_comparable && fix.when.time == fix_->time;
  if (!is_same_epoch || fix.sentence_type == "GGA") fix_ = Fix{fix.when.time, fix.when.is_from_sentence, *fix.position, fix.horizontal_sd_m};
  if (has_height) height_ = Height{fix.when.time, ellipsoid_height_m};
  if (!std::isnan(fix.speed_mps)) velocity_ = GroundVelocity{fix.when.time, fix.speed_mps, fix.course_rad};
  last_arrival_ = fix.when.arrival;
}

void AntennaTracker::Add(const GroundVelocity& velocity) {
  if (!std::isnan(velocity.speed_mps)) velocity_ = velocity;
}

std::optional<AntennaEstimate> AntennaTracker::PositionAt(Utime time) const {
  if (!fix_ || Distance(time, fix_->time) > params_.max_age) return std::nullopt;
  AntennaEstimate estimate;
  estimate.has_height = height_ && Distance(time, height_->time) <= params_.max_age;
  Eigen::Vector3d& p_map_m = estimate.p_map_m;
  map_->Forward(fix_->position.latitude_deg, fix_->position.longitude_deg, estimate.has_height ? height_->ellipsoid_m : datum_->ellipsoid_height_m,
                p_map_m.x(), p_map_m.y(), p_map_m.z());
  const auto velocity = VelocityAt(time);
  if (velocity) p_map_m += velocity->map_mps * Seconds(time - fix_->time);
  const double age_s = Seconds(Distance(time, fix_->time));
  const double velocity_sd_mps = velocity ? velocity->horizontal_sd_mps : kUnknownSpeedSdMps;
  estimate.horizontal_sd_m = std::hypot(fix_->sd_m, age_s * std::hypot(velocity_sd_mps, params_.position_drift_mps));
  estimate.vertical_sd_m = std::hypot(kVerticalFactor * fix_->sd_m, kVerticalVelocitySdMps * age_s);
  return estimate;
}

std::optional<VelocityEstimate> AntennaTracker::VelocityAt(Utime time) const {
  if (!velocity_ || Distance(time, velocity_->time) > params_.max_age) return std::nullopt;
  const double growth_mps = kAccelerationSdMps2 * Seconds(Distance(time, velocity_->time));
  VelocityEstimate estimate;
  estimate.vertical_sd_mps = kVerticalVelocitySdMps;
  estimate.horizontal_sd_mps = std::hypot(params_.velocity_sd_mps, growth_mps);
  if (std::isnan(velocity_->course_rad)) {
    // A speed without a direction: anywhere on a circle around 0.
    estimate.horizontal_sd_mps = std::hypot(estimate.horizontal_sd_mps, velocity_->speed_mps);
  } else {
    estimate.map_mps = velocity_->speed_mps * Eigen::Vector3d(std::sin(velocity_->course_rad), std::cos(velocity_->course_rad), 0.0);
  }
  return estimate;
}

std::optional<CourseEstimate> AntennaTracker::CourseAt(Utime time) const {
  if (!velocity_ || std::isnan(velocity_->course_rad)) return std::nullopt;
  const auto age = Distance(time, velocity_->time);
  if (age > params_.max_age) return std::nullopt;
  return CourseEstimate{velocity_->course_rad, velocity_->speed_mps, age};
}

}  // namespace lookout::navigator
