#include "services/navigator/core/attitude_tracker.hpp"

#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::navigator {

namespace {

using namespace std::chrono_literals;

// Assumptions on small boats. None turns half a circle in a second, nor heaves at more than 5 m/s.
constexpr double kMaxAngularRateRadps = kPi;
constexpr double kMaxHeaveRateMps = 5.0;
// What a boat may turn, roll and heave otherwise than its last rate says.
constexpr double kHeadingDriftRadps = DegToRad(5.0);
constexpr double kTiltDriftRadps = DegToRad(10.0);
constexpr double kHeaveDriftMps = 0.5;
// A turn lasts for seconds and is carried on as long as the sample counts; a roll swings back after about a second.
constexpr std::chrono::microseconds kMaxSwingCarry = 250ms;

TrackParams HeadingTrack(const AttitudeParams& params) { return {true, kMaxAngularRateRadps, params.max_age, kHeadingDriftRadps}; }
constexpr TrackParams kTiltTrack{true, kMaxAngularRateRadps, kMaxSwingCarry, kTiltDriftRadps};
constexpr TrackParams kHeaveTrack{false, kMaxHeaveRateMps, kMaxSwingCarry, kHeaveDriftMps};

// A sensor that says 0 does not know.
double SdOr(double said_sd, double default_sd) { return said_sd > 0.0 ? said_sd : default_sd; }

}  // namespace

AttitudeTracker::AttitudeTracker(const AttitudeParams& params)
    : params_(params),
      pashr_heading_(HeadingTrack(params)),
      hdt_heading_(HeadingTrack(params)),
      roll_(kTiltTrack),
      pitch_(kTiltTrack),
      heave_(kHeaveTrack) {}

bool AttitudeTracker::Add(const Attitude& attitude) {
  const Utime time = attitude.when.time;
  bool is_newer = true;
  const auto add = [&](Track& track, double value, double sd) {
    if (!std::isnan(value) && !track.Add(time, value, sd)) is_newer = false;
  };
  const bool is_hdt = attitude.sentence_type == "HDT";
  add(is_hdt ? hdt_heading_ : pashr_heading_, attitude.heading_rad, SdOr(attitude.heading_sd_rad, params_.heading_sd_rad));
  // One angle alone does not make a tilt.
  if (!std::isnan(attitude.roll_rad) && !std::isnan(attitude.pitch_rad)) {
    add(roll_, attitude.roll_rad, SdOr(attitude.roll_sd_rad, params_.tilt_sd_rad));
    add(pitch_, attitude.pitch_rad, SdOr(attitude.pitch_sd_rad, params_.tilt_sd_rad));
  }
  add(heave_, attitude.heave_m, 0.0);
  return is_newer;
}

std::optional<HeadingEstimate> AttitudeTracker::HeadingAt(Utime time) const {
  auto source = HeadingSource::kPashr;
  auto value = pashr_heading_.At(time, params_.max_age);
  if (!value) {
    source = HeadingSource::kHdt;
    value = hdt_heading_.At(time, params_.max_age);
  }
  if (!value) return std::nullopt;
  return HeadingEstimate{source, WrapTo2Pi(value->value), value->sd, value->rate};
}

std::optional<TiltEstimate> AttitudeTracker::TiltAt(Utime time) const {
  const auto roll = roll_.At(time, params_.max_age);
  const auto pitch = pitch_.At(time, params_.max_age);
  if (!roll || !pitch) return std::nullopt;
  return TiltEstimate{WrapToPi(roll->value), roll->sd, WrapToPi(pitch->value), pitch->sd};
}

std::optional<double> AttitudeTracker::HeaveAt(Utime time) const {
  const auto heave = heave_.At(time, params_.max_age);
  if (!heave) return std::nullopt;
  return heave->value;
}

}  // namespace lookout::navigator
