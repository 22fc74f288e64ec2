// Existence of tracks.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/angles.hpp"
#include "services/tracker/core/step.hpp"

namespace lookout::tracker {

namespace {

constexpr std::size_t kLooksKept = 15;
constexpr double kDetectionUnknown = 0.5;  // where nobody knows which water was looked through
constexpr double kMostDetection = 0.95;
constexpr double kGreatestExistence = 6.0;
constexpr double kLeastExistence = -6.0;
constexpr double kMissS = 0.4;  // for how long a known thing is hidden at a time
constexpr double kMissHits = 30.0;

Eigen::Vector2d MiddleOf(const std::vector<Eigen::Vector2d>& outline_m) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& corner : outline_m) middle += corner / static_cast<double>(outline_m.size());
  return middle;
}

}  // namespace

Eigen::Vector2d Step::ToVessel(const Eigen::Vector2d& place_m) const {
  const Eigen::Vector2d off = place_m - scan_.own->position_map_m.head<2>();
  const auto [sine, cosine] = SinCosOf(scan_.own->heading_rad);  // forward is (sine, cosine) of east, north
  return {off.x() * sine + off.y() * cosine, -off.x() * cosine + off.y() * sine};
}

void Step::Look() {
  for (auto& track : known_.tracks) {
    track.is_met = false;
    if (!is_sight_known_ || params_.without.beams) {
      track.detection = kDetectionUnknown;
      continue;
    }
    const auto look = known_.sight.At(track.outline_m, track.top_m);
    const double share = track.beams_met / track.beams_open;
    // Probability that none of the beams comes back, each with this share; at most 20 count, as they are not independent.
    double none = 1.0;
    // A beam that ended in the outline does not count as empty, even if its return belongs to another segment.
    const double num_empty = look.num_open - look.num_met;
    for (int i = 0; i < std::min(20, static_cast<int>(std::lround(num_empty))); ++i) none *= 1.0 - share;
    track.is_met = look.num_met > 0.5 * look.num_open;
    track.detection = std::min(kMostDetection, 1.0 - none);
  }
}

// Evidence of existence: the thing is seen near its predicted place, by the deviation of that place, against clutter there.
void Step::Believe(Followed& track, std::size_t i, const Seen& seen, const Eigen::Vector2d& expected_m) {
  const auto& sighting = sightings_[i];
  const double sd = std::max(track.body ? 0.3 : 0.5, std::sqrt(0.5 * seen.covariance_relative_m2.trace()));
  const double off = (track.middle_m - expected_m).norm();
  const double density = Exp(-0.5 * std::min(off * off / (sd * sd), 50.0)) / (kTwoPi * sd * sd);
  const double clutter = known_.clutter.DensityAt(ToVessel(sighting.middle_m), seen.num_returns);
  const double detection = std::max(track.detection, 0.1);
  track.log_odds += Log(1.0 - detection + detection * density / clutter);
  track.log_odds = std::clamp(track.log_odds, kLeastExistence, kGreatestExistence);
  const Eigen::Vector2d middle_m = MiddleOf(seen.outline_m);
  // The step of a confirmed track since its last sighting is spread over the scans between: a hidden track is not unsteady.
  const double scans = track.is_confirmed ? std::max(1.0, ToSeconds(scan_.end_time - track.seen) / std::max(dt_s_, 0.01)) : 1.0;
  track.AddLook(Logit(seen.thing_probability), (middle_m - track.seen_m).norm() / scans);
  if (!track.is_confirmed && IsAlone(track, i)) ++track.num_alone;
  track.seen_m = middle_m;
  track.seen_radius_m = sighting.radius_m;
  Remember(track, true);
  if (!is_sight_known_) return;
  constexpr double kForgotten = 0.95;
  const auto look = known_.sight.At(seen.outline_m, seen.top_above_water_m);
  track.beams_met = kForgotten * track.beams_met + std::min(look.num_met, look.num_open);
  track.beams_open = kForgotten * track.beams_open + std::max(look.num_open, 1.0);
}

void Step::Miss(Followed& track) {
  if (track.detection <= 0.0) return;                                      // it could not have been seen
  if (!is_sight_known_ && known_.had_sight && track.is_confirmed) return;  // the beams are lost: nobody knows
  // A wave or a roll of the boat that hides a known thing for a scan hides it for a while.
  const double known = std::min(1.0, track.num_hits / kMissHits);
  const double weight = 1.0 - known * (1.0 - std::min(1.0, dt_s_ / kMissS));
  track.log_odds = std::max(kLeastExistence, track.log_odds + weight * Log(1.0 - track.detection));
  if (track.detection > 0.5) Remember(track, false);
}

void Step::Remember(Followed& track, bool is_seen) {
  track.looks.push_back(is_seen);
  if (track.looks.size() > kLooksKept) track.looks.pop_front();
}

// A thing beyond doubt that stands by itself, so that it can be no part of another.
bool Step::IsClear(std::size_t i) const {
  constexpr int kLeastReturns = 20;
  constexpr double kLeastThing = 0.98;
  constexpr double kAloneM = 5.0;
  const auto& seen = sightings_[i].seen;
  if (seen.num_returns < kLeastReturns || seen.thing_probability < kLeastThing) return false;
  const auto is_near = [&](const Eigen::Vector2d& other_m, double radius_m) {
    return (other_m - sightings_[i].middle_m).norm() < kAloneM + radius_m + sightings_[i].radius_m;
  };
  for (std::size_t k = 0; k < sightings_.size(); ++k) {
    if (k != i && sightings_[k].seen.is_sure && !sightings_[k].seen.is_land && is_near(sightings_[k].middle_m, sightings_[k].radius_m)) return false;
  }
  return std::ranges::none_of(known_.tracks, [&](const Followed& other) { return other.body && is_near(other.middle_m, other.radius_m); });
}

// Where crew, rods and flags are seen.
bool Step::IsAtOwnHull(const Sighting& sighting) const {
  constexpr double kOwnGearM = 2.0;
  const std::array<Eigen::Vector2d, 1> place{ToVessel(sighting.middle_m)};
  const double to_own_m = params_.own_hull_m.empty() ? place.front().norm() : GapOf(params_.own_hull_m, place).distance_m;
  return to_own_m < kOwnGearM + sighting.radius_m;
}

// Beside a known thing its parts may be seen, beside the own hull gear: these stand as still as the thing or the boat.
bool Step::IsAlone(const Followed& track, std::size_t i) const {
  constexpr double kAloneM = 4.0;
  const auto& sighting = sightings_[i];
  if (IsAtOwnHull(sighting)) return false;
  return std::ranges::none_of(known_.tracks, [&](const Followed& other) {
    return other.is_confirmed && other.id != track.id && IsWithin(other.middle_m, sighting.middle_m, kAloneM + other.radius_m + sighting.radius_m);
  });
}

// Whether the water was watched in which the track came up; asked again where it turns out to be higher. Nothing comes up beside the place where a
// known thing was lost: that is the thing.
void Step::AskWatched(Followed& track) const {
  constexpr double kHigherM = 0.05;
  constexpr double kBesideLostM = 2.0;
  if (!is_sight_known_ || (track.watched && track.top_m < track.watched_top_m + kHigherM)) return;
  const bool is_beside = std::ranges::any_of(known_.tracks, [&](const Followed& other) {
    return other.is_confirmed && !other.is_ended && !other.is_seen_now &&
           (other.middle_m - track.first_m).norm() < kBesideLostM + other.radius_m + track.first_radius_m;
  });
  track.watched = is_beside || params_.without.watched_water ? Watched{} : known_.watched.At(track.first_m, track.top_m, track.first);
  track.watched_top_m = track.top_m;
}

void Step::Begin() {
  std::vector<Followed*> confirmed;
  for (auto& track : known_.tracks) {
    if (track.is_confirmed && !track.is_ended) confirmed.push_back(&track);
  }
  // Where there are too many, sure ones come first.
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (sightings_[i].use == Sighting::Use::kFree) order.push_back(i);
  }
  std::stable_partition(order.begin(), order.end(), [this](std::size_t i) { return sightings_[i].seen.is_sure; });
  for (const std::size_t i : order) {
    const auto& seen = sightings_[i].seen;
    known_.clutter.Add(ToVessel(sightings_[i].middle_m), seen.num_returns);
    if (known_.tracks.size() >= kMostTracks) {
      ++known_.num_over_limit;
      continue;
    }
    Followed track;
    track.id = known_.next_id++;
    track.first = track.seen = track.seen_alone = scan_.end_time;
    track.outline_m = seen.outline_m;
    track.middle_m = track.seen_m = track.first_m = sightings_[i].middle_m;
    track.radius_m = track.seen_radius_m = track.first_radius_m = sightings_[i].radius_m;
    track.top_m = seen.top_above_water_m;
    track.AddLook(Logit(seen.thing_probability), 0.0);
    track.sum_returns = seen.num_returns;
    track.own_covariance_m2 = seen.covariance_m2 - seen.covariance_relative_m2;
    track.relative_covariance_m2 = seen.covariance_relative_m2;
    track.segment_ids.push_back(seen.segment_id);
    Remember(track, true);
    for (auto* other : confirmed) {
      if (IsWithin(track.middle_m, other->middle_m, other->radius_m) && Contains(other->outline_m, track.middle_m)) {
        Followed::Relate(track.parents, other->number, scan_.end_time);
      }
    }
    if (seen.is_sure) {
      track.body.emplace(seen.outline_m, SidesOf(i), seen.covariance_relative_m2, sightings_[i].range_m);
      Place(track);
      AskWatched(track);
      if (IsClear(i) && Sigmoid(track.NoCrestLogOdds()) > params_.confirm_probability && !IsPerhapsLand(track, i)) {
        Confirm(track);
        track.log_odds = kClearLogOdds;
      }
    }
    known_.tracks.push_back(std::move(track));
  }
}

void Step::ConfirmWhereLikely(Followed& track, std::size_t i) {
  if (track.is_confirmed) return;
  if (track.body) AskWatched(track);
  // Where nobody knows how the water was watched: a crest lives for about a second.
  constexpr double kCrestThing = 2.0;
  constexpr double kCrestS = 1.0;
  if (!track.watched && track.mean_thing < kCrestThing && ToSeconds(scan_.end_time - track.first) < kCrestS) return;
  if (track.Probability() > params_.confirm_probability && !IsSuspect(track) && !IsPerhapsLand(track, i)) Confirm(track);
}

// From now on it has a number, which its parents are told.
void Step::Confirm(Followed& track) {
  track.is_confirmed = true;
  merged_.emplace_back(track.PublicId(), known_.next_number);
  track.number = known_.next_number++;
  for (auto& other : known_.tracks) {
    if (std::ranges::any_of(track.parents, [&](const auto& parent) { return parent.first == other.number; })) {
      Followed::Relate(other.children, track.number, scan_.end_time);
    }
  }
}

void Step::EndUnseen() {
  constexpr double kLongestS = 30.0;  // sooner where it was not followed for as long
  constexpr double kShortestS = 2.0;
  constexpr int kHardlyKnownHits = 5;
  constexpr double kHardlyKnownS = 0.7;
  constexpr double kTentativeS = 1.0;
  constexpr double kLeastOfConfirmed = 0.05;
  for (auto& track : known_.tracks) {
    const double known_s = std::clamp(ToSeconds(track.seen - track.first), kShortestS, kLongestS);
    const double end_s = !track.is_confirmed ? kTentativeS : track.num_hits < kHardlyKnownHits ? kHardlyKnownS : known_s;
    if (track.UnseenS(scan_.end_time) > end_s || track.Existence() < (track.is_confirmed ? kLeastOfConfirmed : params_.end_probability) ||
        (!track.is_confirmed && track.log_odds < kBirthLogOdds - 1.0))
      track.is_ended = true;
  }
}

}  // namespace lookout::tracker
