#include "services/navigator/core/filter/pose_filter.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/datum_check.hpp"
#include "common/core/elementary.hpp"

namespace lookout::navigator {

namespace {

using namespace std::chrono_literals;
using filter::State;

// Satellites are above only, so height is worse than position: VDOP is about one and a half to two times HDOP.
constexpr double kVerticalFactor = 2.0;
// History kept beyond the greatest latency.
constexpr std::chrono::microseconds kMoreHistory = 1s;
// A sample of the IMU stands for no longer than this: five of a slow one (50 Hz).
constexpr std::chrono::microseconds kMaxSampleAge = 100ms;
// Least deviation of a position, whatever a receiver says: a millimetre.
constexpr double kMinSdM = 0.001;

// Sentences of one fix differ by how many digits they have, at most: receivers have 4 to 8 of a minute.
constexpr double kSamePlaceM = 0.2;

// A fix whose UTC lies so far before its arrival that it does not count as its time: the computer's clock is off, or the fix is old (a lidar goes on
// with its last RMC for a second and more). Which of them is not known before some sentences more; so the boat may have gone on for all of that time.
// Clocks of small computers are off by seconds; of more than that it is the clock.
constexpr std::chrono::microseconds kMaxAge = 10s;
constexpr double kUnknownSpeedMps = 3.0;
constexpr double kUnknownAccelerationMps2 = 0.5;

// A motion of the lidar that is used counts for so long, and contradictions are told after so long.
constexpr std::chrono::microseconds kMotionAge = 500ms;
constexpr std::chrono::microseconds kContradiction = 1s;
// Fixes that are not used are named for so long after the last one.
constexpr double kNamedS = 5.0;
// One place that comes twice, by a receiver that sends faster than it measures, is counted alone.
constexpr double kNamedFrozenS = 3.0;

double PossibleAgeS(const MeasurementTime& when) {
  if (!when.has_sentence_utc || when.is_from_sentence) return 0.0;
  const auto age = when.arrival - when.utc;
  return age > 0us && age <= kMaxAge ? std::chrono::duration<double>(age).count() : 0.0;
}

// A speed without a direction is anywhere on a circle around 0: this is the deviation of each component.
double SdOfUnknownCourse(double speed_mps) { return speed_mps * std::sqrt(0.5); }

filter::VelocityMeasurement ToVelocity(double speed_mps, double course_rad, double sd_mps, bool has_own_time) {
  filter::VelocityMeasurement velocity{.sd_mps = sd_mps, .course_rad = course_rad, .speed_mps = speed_mps, .has_own_time = has_own_time};
  if (std::isnan(course_rad)) {
    velocity.sd_mps = Hypot(sd_mps, SdOfUnknownCourse(speed_mps));
  } else {
    const auto [east, north] = SinCosOf(course_rad);
    velocity.east_north_mps = speed_mps * Eigen::Vector2d(east, north);
  }
  return velocity;
}

double SdOr(double said_sd, double default_sd) { return said_sd > 0.0 ? said_sd : default_sd; }

// Order of PoseCovariance.
enum Row { kRowPosition = 0, kRowVelocity = 3, kRowAngles = 6, kRowHeading = 8, kNumRows = 9 };

void Unknown(int first, int size, PoseCovariance& covariance) {
  covariance.middleRows(first, size).setConstant(kNan);
  covariance.middleCols(first, size).setConstant(kNan);
}

// @param map  of the datum; nullptr: no datum is known yet
Pose ToPose(const State& state, const std::optional<GeodeticPlace>& datum, const LocalFrame* map, const FilterParams& params) {
  Pose pose;
  pose.time = state.time;
  if (datum) pose.datum = *datum;
  const Eigen::Matrix3d R_level_vessel = state.nominal.R_level_vessel();
  const Eigen::Vector3d& p_vessel_origin_m = params.p_vessel_imu_m;
  Eigen::Vector3d reference_level_m = -(R_level_vessel * p_vessel_origin_m);  // from the origin
  Eigen::Vector3d swing_level_mps = -(R_level_vessel * state.nominal.angular_velocity_radps.cross(p_vessel_origin_m));
  if (!state.aiding.has_heading) {
    reference_level_m.head<2>().setZero();
    swing_level_mps.setZero();
  }

  const auto here = HereOf(state);
  const Eigen::Matrix3d R_here_vessel = here.R_here_level * R_level_vessel;
  const bool is_placed = state.aiding.has_position && state.nominal.level && map != nullptr;
  const Eigen::Isometry3d T_map_level = is_placed ? map->TransformFrom(state.nominal.level->frame) : Eigen::Isometry3d::Identity();

  Eigen::Matrix<double, kNumRows, filter::kNumErrors> jacobian = Eigen::Matrix<double, kNumRows, filter::kNumErrors>::Zero();
  jacobian.block<3, 3>(kRowPosition, filter::kPosition) = T_map_level.linear();
  jacobian.block<3, 3>(kRowVelocity, filter::kVelocity) = T_map_level.linear();
  jacobian.block<3, 3>(kRowPosition, filter::kRotation) = -(T_map_level.linear() * filter::Cross(reference_level_m));
  jacobian.block<3, 3>(kRowAngles, filter::kRotation) = filter::AngleJacobian(R_here_vessel) * here.R_here_level;
  jacobian.block<1, 3>(kRowHeading, filter::kPosition) = here.heading_per_east_radpm * here.R_here_level.row(0);
  pose.covariance = jacobian * state.covariance * jacobian.transpose();
  pose.covariance = (0.5 * (pose.covariance + pose.covariance.transpose())).eval();

  const Eigen::Vector3d angles_rad = filter::AnglesOf(R_here_vessel);
  pose.has_attitude = state.aiding.has_tilt;
  pose.roll_rad = state.aiding.has_tilt ? angles_rad[0] : 0.0;
  pose.pitch_rad = state.aiding.has_tilt ? angles_rad[1] : 0.0;
  if (state.aiding.heave.IsWithin(state.time, params.max_attitude_age)) {
    pose.heave_m = state.nominal.p_level_m.z() - state.nominal.water_level_m - (R_level_vessel * p_vessel_origin_m - p_vessel_origin_m).z();
  }
  if (state.aiding.has_heading) {
    pose.heading_rad = angles_rad[2];
    pose.heading_source = state.aiding.heading_source;
    pose.covariance(kRowHeading, kRowHeading) += state.aiding.HeadingDoubtRad() * state.aiding.HeadingDoubtRad();
  } else {
    Unknown(kRowHeading, 1, pose.covariance);
    // Without heading the position is the antenna's, which may lie this far from the reference point in any direction.
    const double lever_m = params.p_vessel_antenna_m.head<2>().norm();
    pose.covariance.diagonal().head<2>().array() += lever_m * lever_m;
  }
  if (is_placed) {
    Eigen::Vector3d p_level_m = state.nominal.p_level_m + reference_level_m;
    if (!state.aiding.has_height) p_level_m.z() = 0.0;  // the height of the datum
    pose.p_map_m = T_map_level * p_level_m;
    pose.velocity_map_mps = T_map_level.linear() * (state.nominal.velocity_level_mps + swing_level_mps);
    const GeodeticPlace place = state.nominal.level->frame.Reverse(p_level_m);
    pose.latitude_deg = place.latitude_deg;
    pose.longitude_deg = place.longitude_deg;
    pose.ellipsoid_height_m = place.ellipsoid_height_m;
    if (!state.aiding.has_height) {
      pose.ellipsoid_height_m = kNan;
      Unknown(kRowPosition + 2, 1, pose.covariance);
    }
  } else {
    Unknown(kRowPosition, 3, pose.covariance);
    Unknown(kRowVelocity, 3, pose.covariance);
  }

  const bool is_fix_stopped = state.aiding.fix.IsStoppedAt(state.time);
  if (state.aiding.has_position && state.aiding.has_heading) {
    pose.status = is_fix_stopped || state.aiding.heading().IsStoppedAt(state.time) ? PoseStatus::kCoasting : PoseStatus::kOk;
  } else if (state.aiding.has_position) {
    pose.status = PoseStatus::kNoHeading;
  } else if (state.aiding.has_heading) {
    pose.status = PoseStatus::kNoPosition;
  }
  return pose;
}

// "no position fix for 3 s, no heading for 2 s" of inputs that came and have stopped; empty = none.
std::string StoppedInputs(const State& state) {
  std::string text;
  const auto say = [&](const filter::UseTimes& input, const char* name) {
    if (!input.IsStoppedAt(state.time)) return;
    const auto since = std::chrono::floor<std::chrono::seconds>(state.time - *input.last).count();
    if (!text.empty()) text += ", ";
    text += "no " + std::string(name) + " for " + std::to_string(since) + " s";
  };
  say(state.aiding.fix, "position fix");
  say(state.aiding.sensor_heading, "heading");
  say(state.aiding.tilt, "attitude");
  say(state.aiding.imu, "IMU");
  if (IsImuRefused(state)) text += std::string(text.empty() ? "" : ", ") + "IMU not used: it contradicts fixes or attitudes";
  return text;
}

}  // namespace

PoseFilter::PoseFilter(const FilterParams& params) : params_(params) {
  if (params_.datum) SetDatum(*params_.datum);
}

void PoseFilter::Reset() {
  const FilterCounts counts = counts_;
  *this = PoseFilter(params_);
  counts_ = counts;
}

void PoseFilter::SetDatum(const GeodeticPlace& datum) {
  datum_ = datum;
  map_.emplace(datum);
}

// GGA decides the place of its epoch: where it is out of reach of the RMC before it, RMC was wrong.
BelievedPlace::Verdict PoseFilter::Judge(const GnssFix& fix, const GeodeticPlace& antenna, double sd_m) {
  const BelievedPlace before = believed_place_;
  auto verdict = believed_place_.Judge(fix.when.time, antenna, sd_m);
  const bool decides = fix.is_gga() && last_believed_ && last_believed_->source == fix.source && last_believed_->time == fix.when.time;
  if (verdict == BelievedPlace::Verdict::kHeld && decides) {
    believed_place_ = last_believed_->before;
    verdict = believed_place_.Judge(fix.when.time, antenna, sd_m);
    if (verdict == BelievedPlace::Verdict::kBelieved && last_believed_->gave_datum) MoveDatum(fix.when.time, antenna);
  }
  if (verdict != BelievedPlace::Verdict::kHeld && !fix.is_gga()) last_believed_ = {fix.source, fix.when.time, before, !datum_};
  return verdict;
}

void PoseFilter::MoveDatum(Utime time, const GeodeticPlace& antenna) {
  if (params_.datum) {
    datum_complaint_ = DatumComplaint(*params_.datum, antenna, "the new place of the fixes");
  } else {
    next_datum_ = {time, antenna};
  }
}

// "fixes of input 'udp' repeat one place for 12 s while the boat has moved by 36 m: not used", or
// "fixes of input 'udp' are 6120 km from the last that was believed, 3 s before: no boat gets so far; not used, unless they stay there for 57 s"
void PoseFilter::NameDoubted(Utime time) {
  doubted_.clear();
  const auto is_recent = [time](const auto& last) { return last && std::abs(filter::SecondsBetween(last->time, time)) <= kNamedS; };
  if (const auto& frozen = frozen_places_.last(); is_recent(frozen) && frozen->for_s >= kNamedFrozenS) {
    doubted_ = "fixes of input '" + frozen->source + "' repeat one place for " + std::to_string(std::llround(frozen->for_s)) +
               " s while the boat has moved by " + std::to_string(std::llround(frozen->way_m)) + " m: not used";
    return;
  }
  const auto& held = believed_place_.held();
  if (!is_recent(held)) return;
  constexpr double kMetresPerKm = 1e3;
  const bool is_far = held->distance_m >= 10.0 * kMetresPerKm;
  const auto distance =
      is_far ? std::to_string(std::llround(held->distance_m / kMetresPerKm)) + " km" : std::to_string(std::llround(held->distance_m)) + " m";
  doubted_ = "fixes of input '" + doubted_source_ + "' are " + distance + " from the last that was believed, " +
             std::to_string(std::llround(held->since_s)) + " s before: no boat gets so far; not used, unless they stay there for " +
             std::to_string(std::llround(held->rest_s)) + " s";
}

bool PoseFilter::Insert(Utime time, const Measurement& measurement) {
  if (base_ && time < base_->time) return false;
  // Behind all of its time, but attitude before position: the attitude turns the lever arm.
  const auto place = std::ranges::upper_bound(events_, std::pair(time, measurement.index()), {},
                                              [](const Event& event) { return std::pair(event.time, event.measurement.index()); });
  const auto index = static_cast<std::size_t>(place - events_.begin());
  events_.insert(place, Event{time, measurement, false, {}});
  Touch(index);
  newest_ = std::max(newest_.value_or(time), time);
  return true;
}

void PoseFilter::Touch(std::size_t index) { num_processed_ = std::min(num_processed_, index); }

void PoseFilter::DropOld() {
  if (!newest_) return;
  const Utime oldest = *newest_ - params_.max_latency - kMoreHistory;
  while (num_processed_ > 1 && (events_.front().time < oldest || events_.size() > kMaxEvents)) {
    base_ = std::move(events_.front().after);
    if (const auto* sample = std::get_if<ImuSample>(&events_.front().measurement)) {
      base_sample_ = *sample;
      base_sample_time_ = events_.front().time;
    }
    events_.pop_front();
    --num_processed_;
  }
}

// A receiver whose sentences come by two ways, as beside and through the lidar, says the same place of the same time.
filter::FixMeasurement* PoseFilter::SameEpoch(const filter::FixMeasurement& fix, Utime time, std::size_t& index) {
  const auto begin = std::ranges::lower_bound(events_, time, {}, &Event::time);
  for (auto event = begin; event != events_.end() && event->time == time; ++event) {
    auto* other = std::get_if<filter::FixMeasurement>(&event->measurement);
    if (other == nullptr) continue;
    const bool is_same_place = LocalFrame(OnEllipsoid(fix.antenna)).Forward(OnEllipsoid(other->antenna)).head<2>().norm() < kSamePlaceM;
    if (other->source != fix.source && !is_same_place) continue;
    index = static_cast<std::size_t>(event - events_.begin());
    return other;
  }
  return nullptr;
}

void PoseFilter::Add(const GnssFix& fix) {
  if (!IsMeasured(fix.quality) || !fix.position || !(fix.horizontal_sd_m > 0.0)) {
    ++counts_["unusable_fix"];
    return;
  }
  if (frozen_places_.Judge(fix)) {
    ++counts_["frozen_fix"];
    return;
  }
  const double ellipsoid_height_m = fix.EllipsoidHeightM();
  const bool has_height = !std::isnan(ellipsoid_height_m);
  GeodeticPlace antenna = *fix.position;
  if (has_height) antenna.ellipsoid_height_m = ellipsoid_height_m;
  const double white_sd_m = std::max(fix.horizontal_sd_m, kMinSdM);
  const double age_s = PossibleAgeS(fix.when);
  const double horizontal_sd_m = Hypot(white_sd_m, age_s * (std::isnan(fix.speed_mps) ? kUnknownSpeedMps : fix.speed_mps));
  const auto verdict = Judge(fix, antenna, horizontal_sd_m);
  if (verdict == BelievedPlace::Verdict::kHeld) {
    ++counts_["unreachable_fix"];
    doubted_source_ = fix.source;
    return;
  }
  const bool begins_place = verdict == BelievedPlace::Verdict::kNewPlace;
  if (begins_place) {
    ++counts_["new_place"];
    MoveDatum(fix.when.time, antenna);
  }
  if (!datum_) SetDatum(antenna);
  if (!has_height) antenna.ellipsoid_height_m = next_datum_ ? next_datum_->datum.ellipsoid_height_m : datum_->ellipsoid_height_m;
  if (!last_fix_arrival_ && params_.datum) datum_complaint_ = DatumComplaint(*datum_, antenna, "the first fix");

  filter::FixMeasurement measurement{.source = fix.source,
                                     .is_gga = fix.is_gga(),
                                     .begins_anew = fix.begins_time_scale || begins_place,
                                     .antenna = antenna,
                                     .has_height = has_height};
  measurement.horizontal_sd_m = horizontal_sd_m;
  measurement.vertical_sd_m = fix.vertical_sd_m > 0.0 ? std::max(fix.vertical_sd_m, kMinSdM) : kVerticalFactor * white_sd_m;
  if (!std::isnan(fix.speed_mps)) {
    const double sd_mps = Hypot(SdOr(fix.velocity_sd_mps, params_.velocity_sd_mps), age_s * kUnknownAccelerationMps2);
    measurement.velocity = ToVelocity(fix.speed_mps, fix.course_rad, sd_mps, true);
  }

  std::size_t index = 0;
  if (auto* same_epoch = SameEpoch(measurement, fix.when.time, index)) {
    const bool takes_position = measurement.is_gga && !same_epoch->is_gga;
    const bool takes_velocity = measurement.velocity && !same_epoch->velocity;
    if (!takes_position && !takes_velocity) return;
    if (takes_velocity) same_epoch->velocity = measurement.velocity;
    if (takes_position) {
      measurement.velocity = same_epoch->velocity;
      measurement.begins_anew = measurement.begins_anew || same_epoch->begins_anew;
      *same_epoch = measurement;
    }
    Touch(index);
  } else if (!Insert(fix.when.time, measurement)) {
    ++counts_["late_fix"];
    return;
  }
  last_fix_arrival_ = fix.when.arrival;
}

void PoseFilter::Add(const GroundVelocity& velocity) {
  if (std::isnan(velocity.speed_mps) || frozen_places_.Judge(velocity)) return;
  const auto measurement = ToVelocity(velocity.speed_mps, velocity.course_rad, params_.velocity_sd_mps, false);
  if (!Insert(velocity.time, measurement)) ++counts_["late_fix"];
}

void PoseFilter::Add(const Attitude& attitude) {
  auto measurement = static_cast<const AttitudeValues&>(attitude);
  measurement.heading_sd_rad = SdOr(attitude.heading_sd_rad, params_.heading_sd_rad);
  measurement.roll_sd_rad = SdOr(attitude.roll_sd_rad, params_.tilt_sd_rad);
  measurement.pitch_sd_rad = SdOr(attitude.pitch_sd_rad, params_.tilt_sd_rad);
  if (!Insert(attitude.when.time, measurement)) {
    ++counts_["late_attitude"];
    return;
  }
  has_had_heading_ = has_had_heading_ || !std::isnan(attitude.heading_rad);
}

void PoseFilter::Add(const ImuSample& sample) {
  if (!sample.angular_velocity_radps.allFinite() || !sample.specific_force_mps2.allFinite()) {
    ++counts_["unusable_imu"];
    return;
  }
  if (!Insert(sample.time, sample)) ++counts_["late_imu"];
}

void PoseFilter::Add(const OdometryMotion& motion) {
  frozen_places_.Add(motion);
  if (!Insert(motion.end, motion)) ++counts_["late_odometry"];
}

void PoseFilter::AdvanceTo(Utime time) { Insert(time, filter::Tick{}); }

const State& PoseFilter::StateBefore(std::size_t index) const { return index > 0 ? events_[index - 1].after : *base_; }

const ImuSample* PoseFilter::SampleFor(std::size_t next_index, Utime time) const {
  for (std::size_t i = next_index; i < events_.size() && events_[i].time - time <= kMaxSampleAge; ++i) {
    if (const auto* sample = std::get_if<ImuSample>(&events_[i].measurement)) return sample;
  }
  for (std::size_t i = std::min(next_index, events_.size()); i-- > 0 && time - events_[i].time <= kMaxSampleAge;) {
    if (const auto* sample = std::get_if<ImuSample>(&events_[i].measurement)) return sample;
  }
  return base_sample_ && time - base_sample_time_ <= kMaxSampleAge ? &*base_sample_ : nullptr;
}

void PoseFilter::Process(Event& event, std::size_t index) {
  State& state = event.after;
  state = StateBefore(index);
  Propagate(SampleFor(index, event.time), event.time, params_, state);
  filter::GateCounts counts;
  std::visit([&](const auto& measurement) { Apply(measurement, params_, state, counts); }, event.measurement);
  if (event.is_counted) return;
  event.is_counted = true;
  if (std::holds_alternative<OdometryMotion>(event.measurement)) {
    counts_["gated_odometry"] += counts.num_gated;
    return;
  }
  const bool is_attitude = std::holds_alternative<AttitudeValues>(event.measurement);
  (is_attitude ? counts_["gated_attitude"] : counts_["gated_fix"]) += counts.num_gated;
  (is_attitude ? counts_["renewed_attitude"] : counts_["renewed_position"]) += counts.num_renewed;
  nis_sum_ += counts.nis_sum;
  num_nis_degrees_ += counts.num_degrees;
}

void PoseFilter::ProcessUntil(Utime time) {
  for (; num_processed_ < events_.size() && events_[num_processed_].time <= time; ++num_processed_) {
    // Measurements of before the first item may still come.
    if (!base_) {
      base_ = filter::FreshState(events_.front().time - params_.max_latency - kMoreHistory, params_.unmeasured_tilt_sd_rad);
      // Valid until the first fix.
      if (params_.datum) filter::BeginLevel(*datum_, Eigen::Vector2d::Zero(), *base_);
    }
    Process(events_[num_processed_], num_processed_);
  }
}

Pose PoseFilter::At(Utime time) {
  if (next_datum_ && next_datum_->time <= time) {
    SetDatum(next_datum_->datum);
    next_datum_.reset();
  }
  ProcessUntil(time);
  State state = num_processed_ > 0 || base_ ? StateBefore(num_processed_) : filter::FreshState(time, params_.unmeasured_tilt_sd_rad);
  Propagate(SampleFor(num_processed_, time), time, params_, state);
  state.time = time;
  DropOld();
  stopped_ = StoppedInputs(state);
  const auto& aiding = state.aiding;
  const bool is_carried = (aiding.has_position && aiding.fix.IsStoppedAt(time)) || (aiding.has_heading && aiding.heading().IsStoppedAt(time));
  is_carried_by_lidar_ = is_carried && aiding.odometry.IsWithin(time, kMotionAge);
  const bool contradicts = aiding.odometry_contradicts_since && time - *aiding.odometry_contradicts_since >= kContradiction;
  contradicts_lidar_ = contradicts || IsOdometryRefused(state);
  heading_apart_rad_ = aiding.has_heading && aiding.HeadingDoubtRad() > 0.0 ? aiding.heading_apart_rad : 0.0;
  NameDoubted(time);
  return ToPose(state, datum_, map_ ? &*map_ : nullptr, params_);
}

}  // namespace lookout::navigator
