#include "services/georeferencer/core/pose.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::georeferencer {

namespace {

bool IsSameNumber(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

Pose Interpolate(const Pose& a, const Pose& b, Utime time) {
  const double share = ToSeconds(time - a.time) / ToSeconds(b.time - a.time);
  const auto between = [share](double from, double to) { return from + share * (to - from); };
  Pose pose;
  pose.time = time;
  pose.is_placed = a.is_placed && b.is_placed && a.datum.IsSameAs(b.datum);
  pose.datum = a.datum;
  pose.position_map_m = a.position_map_m + share * (b.position_map_m - a.position_map_m);
  pose.heading_rad = WrapTo2Pi(a.heading_rad + share * WrapToPi(b.heading_rad - a.heading_rad));
  pose.pitch_rad = between(a.pitch_rad, b.pitch_rad);
  pose.roll_rad = between(a.roll_rad, b.roll_rad);
  pose.heave_m = between(a.heave_m, b.heave_m);
  pose.covariance = a.covariance + share * (b.covariance - a.covariance);
  return pose;
}

}  // namespace

bool Datum::IsKnown() const { return std::isfinite(latitude_deg) && std::isfinite(longitude_deg); }

bool Datum::IsSameAs(const Datum& other) const {
  return latitude_deg == other.latitude_deg && longitude_deg == other.longitude_deg && IsSameNumber(ellipsoid_height_m, other.ellipsoid_height_m);
}

void PoseHistory::Add(const Pose& pose) {
  poses_.push_back(pose);
  while (pose.time - poses_.front().time > kLength) poses_.pop_front();
}

std::size_t PoseHistory::FirstNotBefore(Utime time) const {
  return static_cast<std::size_t>(std::ranges::lower_bound(poses_, time, {}, &Pose::time) - poses_.begin());
}

std::optional<Pose> PoseHistory::At(Utime time) const {
  const std::size_t index = FirstNotBefore(time);
  if (index == poses_.size()) return std::nullopt;
  const Pose& after = poses_[index];
  if (after.time == time) return after;
  if (index == 0) return std::nullopt;
  const Pose& before = poses_[index - 1];
  if (after.time - before.time > kMaxBracket) return std::nullopt;
  return Interpolate(before, after, time);
}

Datum PoseHistory::DatumAt(Utime time) const {
  const std::size_t index = FirstNotBefore(time);
  if (index < poses_.size() && poses_[index].time == time) return poses_[index].datum;
  return index == 0 ? Datum{} : poses_[index - 1].datum;
}

}  // namespace lookout::georeferencer
