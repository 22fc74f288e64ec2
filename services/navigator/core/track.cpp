#include "services/navigator/core/track.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::navigator {

namespace {

using std::chrono::microseconds;

// Not through ToSeconds: its nanoseconds overflow after 292 years, and times from outside may be 300 years apart.
double Seconds(microseconds duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace

bool Track::Add(Utime time, double value, double sd) {
  if (last_ && time <= last_->time) return false;
  if (last_ && (!newer_ || last_->time - newer_->time >= kMinSpacing)) {
    older_ = newer_;
    newer_ = last_;
  }
  last_ = Sample{time, value, sd};
  return true;
}

const std::optional<Track::Sample>& Track::Previous() const { return newer_ && last_->time - newer_->time >= kMinSpacing ? newer_ : older_; }

std::optional<double> Track::Rate() const {
  const auto& previous = Previous();
  if (!previous || last_->time - previous->time >= kMaxSpacing) return std::nullopt;
  const auto spacing = last_->time - previous->time;
  const double difference = last_->value - previous->value;
  const double rate = (params_.is_angle ? WrapToPi(difference) : difference) / Seconds(spacing);
  if (std::abs(rate) > params_.max_rate) return std::nullopt;
  return rate;
}

std::optional<TrackValue> Track::At(Utime time, microseconds max_age) const {
  if (!last_) return std::nullopt;
  const auto rate = Rate();
  // Where there is a rate, the stretch between the two samples is known.
  const Utime first = rate ? Previous()->time : last_->time;
  const auto age = std::max({microseconds(0), time - last_->time, first - time});
  if (age > max_age) return std::nullopt;
  const auto carried = std::clamp(time - last_->time, first - last_->time, params_.max_carry);
  const bool is_held = !rate || carried != time - last_->time;
  return TrackValue{last_->value + rate.value_or(0.0) * Seconds(carried), std::hypot(last_->sd, params_.drift * Seconds(age)), is_held ? 0.0 : *rate};
}

}  // namespace lookout::navigator
