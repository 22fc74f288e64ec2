#include "common/core/pose.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout {

namespace {

bool IsSameNumber(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

// POSE comes for every whole 20 ms.
constexpr std::chrono::milliseconds kGrid(20);

double Between(double from, double to, double share) { return from + share * (to - from); }
double HeadingBetween(double from_rad, double to_rad, double share) { return WrapTo2Pi(from_rad + share * WrapToPi(to_rad - from_rad)); }

}  // namespace

bool Datum::IsSameAs(const Datum& other) const {
  if (IsRelative()) return other.IsRelative() && ellipsoid_height_m == other.ellipsoid_height_m;
  return latitude_deg == other.latitude_deg && longitude_deg == other.longitude_deg && IsSameNumber(ellipsoid_height_m, other.ellipsoid_height_m);
}

LocalFrame Datum::Map() const { return LocalFrame({latitude_deg, longitude_deg, std::isfinite(ellipsoid_height_m) ? ellipsoid_height_m : 0.0}); }

void PoseHistory::Add(const Pose& pose) {
  poses_.push_back(pose);
  if (pose.is_placed && !pose.datum.IsRelative() && !pose.position_map_m.head<2>().isZero(0.0)) {
    const LocalFrame map = pose.datum.Map();
    poses_.back().R_map_here = map.TransformFrom(LocalFrame(map.Reverse(pose.position_map_m))).linear();
  }
  while (pose.time - poses_.front().time > kLength) poses_.pop_front();
}

std::size_t PoseHistory::FirstNotBefore(Utime time) const {
  // On an even grid it stands where it is looked for first.
  if (!poses_.empty() && time > poses_.front().time) {
    const auto guess = static_cast<std::size_t>((time - poses_.front().time + kGrid - std::chrono::microseconds(1)) / kGrid);
    if (guess < poses_.size() && poses_[guess].time >= time && poses_[guess - 1].time < time) return guess;
  }
  return static_cast<std::size_t>(std::ranges::lower_bound(poses_, time, {}, &Pose::time) - poses_.begin());
}

std::optional<PoseHistory::Bracket> PoseHistory::BracketAt(Utime time) const {
  const std::size_t index = FirstNotBefore(time);
  if (index == poses_.size()) return std::nullopt;
  const Pose& after = poses_[index];
  if (after.time == time) return Bracket{after, after, 0.0};
  if (index == 0) return std::nullopt;
  const Pose& before = poses_[index - 1];
  if (after.time - before.time > kMaxBracket) return std::nullopt;
  return Bracket{before, after, ToSeconds(time - before.time) / ToSeconds(after.time - before.time)};
}

// Its is_placed is that of both in whatever datum.
Place PoseHistory::PlaceIn(const Bracket& bracket) {
  const auto& [a, b, share] = bracket;
  if (bracket.IsOnePose()) return static_cast<const Place&>(a);
  // Of rotations by next to nothing the mean is a rotation.
  return {a.is_placed && b.is_placed,
          a.position_map_m + share * (b.position_map_m - a.position_map_m),
          a.R_map_here + share * (b.R_map_here - a.R_map_here),
          HeadingBetween(a.heading_rad, b.heading_rad, share),
          Between(a.pitch_rad, b.pitch_rad, share),
          Between(a.roll_rad, b.roll_rad, share)};
}

std::optional<Pose> PoseHistory::At(Utime time) const {
  const auto bracket = BracketAt(time);
  if (!bracket) return std::nullopt;
  const auto& [a, b, share] = *bracket;
  if (bracket->IsOnePose()) return a;
  Pose pose;
  static_cast<Place&>(pose) = PlaceIn(*bracket);
  pose.is_placed = pose.is_placed && a.datum.IsSameAs(b.datum);
  pose.time = time;
  pose.datum = a.datum;
  pose.heave_m = Between(a.heave_m, b.heave_m, share);
  pose.velocity_map_mps = a.velocity_map_mps + share * (b.velocity_map_mps - a.velocity_map_mps);
  pose.covariance = a.covariance + share * (b.covariance - a.covariance);
  return pose;
}

std::optional<Place> PoseHistory::PlaceAt(Utime time, const Datum& datum) const {
  const auto bracket = BracketAt(time);
  if (!bracket) return std::nullopt;
  auto place = PlaceIn(*bracket);
  place.is_placed = place.is_placed && bracket->before.datum.IsSameAs(datum) && bracket->after.datum.IsSameAs(datum);
  return place;
}

Datum PoseHistory::DatumAt(Utime time) const {
  const std::size_t index = FirstNotBefore(time);
  if (index < poses_.size() && poses_[index].time == time) return poses_[index].datum;
  return index == 0 ? Datum{} : poses_[index - 1].datum;
}

}  // namespace lookout
