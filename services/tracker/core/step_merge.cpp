// Which tracks are one thing.
#include <algorithm>
#include <cmath>

#include "services/tracker/core/step.hpp"

namespace lookout::tracker {

namespace {

constexpr double kNearM = 2.0;  // m, between the outlines of two tracks that may be one
constexpr double kNeverS = 0.0;
constexpr double kFoundS = 0.3;
constexpr double kMissedS = 0.15;  // more than once
constexpr double kSeenS = 0.35;    // a moment ago

double SpeedBetween(const Followed& one, const Followed& other) {
  const auto velocity = [](const Followed& track) {
    return track.body && track.body->IsMoving(0.5) ? track.body->velocity_mps() : Eigen::Vector2d(Eigen::Vector2d::Zero());
  };
  return (velocity(one) - velocity(other)).norm();
}

bool IsMoving(const Followed& track) { return track.body && track.body->IsMoving(0.95); }

}  // namespace

// Whether returns of both lie next to each other, in this scan.
bool Step::Touch(const Followed& one, const Followed& other) const {
  constexpr double kTouchM = 0.5;
  constexpr std::size_t kMostTouching = 200;
  const auto places = [this](const Followed& track) {
    std::vector<Eigen::Vector2d> found;
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      if (std::ranges::find(track.segment_ids, sightings_[i].seen.segment_id) == track.segment_ids.end()) continue;
      const std::size_t step = 1 + sightings_[i].places_m.size() / kMostTouching;
      for (std::size_t k = 0; k < sightings_[i].places_m.size(); k += step) found.push_back(sightings_[i].places_m[k]);
    }
    return found;
  };
  const auto theirs = places(other);
  return std::ranges::any_of(places(one), [&](const auto& mine) {
    return std::ranges::any_of(theirs, [&](const auto& their) { return (mine - their).squaredNorm() < kTouchM * kTouchM; });
  });
}

// Whether the lesser of two could be a part of the other: it lies in it, or is a mast, an oar or a bow beside it.
bool Step::IsLikePart(const Followed& larger, const Followed& lesser, double shared_m2) const {
  constexpr double kWithinShare = 0.4;
  constexpr double kBeamShare = 0.6;  // of a ship's length, its hidden side assumed
  constexpr double kPieceGapM = 1.5;
  constexpr double kPieceM = 2.0;
  constexpr double kPieceShare = 0.15;
  constexpr double kSameVelocityMps = 0.7;
  const auto around = RectangleAround(larger.outline_m);
  const double area = AreaOf(lesser.outline_m);
  const bool is_piece = area < kPieceShare * AreaOf(larger.outline_m) && RectangleAround(lesser.outline_m).length_m < kPieceM;
  // Within the outline of a possible dock with berths, only tracks that touch it.
  if (around.width_m > std::max(kWidestBoatM, kBeamShare * around.length_m) || around.length_m > kLongestWholeM)
    return is_piece && Touch(larger, lesser);
  if (shared_m2 > 0.0 && shared_m2 >= kWithinShare * area) return true;
  return is_piece && GapOf(larger.outline_m, lesser.outline_m).distance_m < kPieceGapM && SpeedBetween(larger, lesser) < kSameVelocityMps;
}

// Whether both together have the shape of a boat, and no more than a gap between them that a boat has in its middle.
bool Step::AreOneBoat(const Followed& one, const Followed& other) {
  constexpr double kLongestBoatM = 12.0;
  constexpr double kBroadestBoatM = 4.0;
  std::vector<Eigen::Vector2d> corners_m = one.outline_m;
  corners_m.insert(corners_m.end(), other.outline_m.begin(), other.outline_m.end());
  for (auto& corner : corners_m) corner -= one.middle_m;
  const auto around = RectangleAround(Polygon(SupportOf(corners_m)));
  return around.length_m < kLongestBoatM && around.width_m < kBroadestBoatM && GapOf(one.outline_m, other.outline_m).distance_m < kNearM;
}

// A part of a known thing becomes no track of its own at once.
bool Step::IsSuspect(const Followed& track) const {
  constexpr double kShortestS = 1.0;
  constexpr double kLongestS = 3.0;
  constexpr double kAsNewS = 1.0;
  constexpr double kSameVelocityMps = 0.7;
  const double since_s = ToSeconds(scan_.end_time - track.first);
  if (since_s > kLongestS) return false;
  const double area = AreaOf(track.outline_m);
  return std::ranges::any_of(known_.tracks, [&](const Followed& other) {
    if (!other.is_confirmed || other.is_ended || other.id == track.id) return false;
    if ((other.middle_m - track.middle_m).norm() > other.radius_m + track.radius_m + kNearM || AreaOf(other.outline_m) < area) return false;
    const bool is_as_new = ToSeconds(track.first - other.first) < kAsNewS;
    if (other.UnseenS(scan_.end_time) < kSeenS && since_s < (is_as_new ? kShortestS : kLongestS) &&
        (!track.body->IsMoving(0.5) || SpeedBetween(other, track) < kSameVelocityMps) && AreOneBoat(other, track))
      return true;
    const auto both = Intersection(other.outline_m, track.outline_m);
    return IsLikePart(other, track, both.empty() ? 0.0 : std::max(1e-9, AreaOf(both)));
  });
}

// Whether the first track, known and lost although it should have been seen, is the second, which came up beside its last place.
bool Step::IsFoundAgain(const Followed& lost, const Followed& found) const {
  constexpr double kLostProbability = 0.3;
  constexpr double kBeforeS = 1.5;
  constexpr double kLatestS = 2.0;
  constexpr double kFoundBesideM = 1.5;
  constexpr double kFasterMps = 5.0;
  constexpr double kMostTimesLarger = 8.0;
  constexpr double kMostReachM = 4.0;
  constexpr double kMostRadiusM = 3.0;
  if (!lost.is_confirmed || lost.is_seen_now || lost.is_inside_now || lost.detection < kLostProbability) return false;
  if (!found.is_confirmed || !found.is_seen_now || !found.body || lost.UnseenS(scan_.end_time) < kMissedS) return false;
  const double after_s = ToSeconds(found.first - lost.seen);
  if (after_s < -kBeforeS || after_s > kLatestS || lost.num_hits < found.num_hits) return false;
  const double reach_m = std::min(kMostReachM, kFoundBesideM + kFasterMps * std::abs(after_s)) + std::min(kMostRadiusM, lost.seen_radius_m) +
                         std::min(kMostRadiusM, found.first_radius_m);
  if ((found.first_m - lost.seen_m).norm() > reach_m) return false;
  const double times = std::max(0.1, AreaOf(found.outline_m)) / std::max(0.1, AreaOf(lost.outline_m));
  return times < kMostTimesLarger && times > 1.0 / kMostTimesLarger;
}

// For how long two tracks must look like one until they are taken for one; 0: they do not, in this scan.
double Step::OneForS(const Followed& one, const Followed& other) const {
  constexpr double kShortestS = 0.5;
  constexpr double kLongestS = 10.0;
  constexpr double kPerHitS = 0.05;
  constexpr double kPartS = 1.5;
  constexpr double kSameVelocityMps = 0.7;
  if (IsFoundAgain(one, other)) return kFoundS;
  const bool is_inside = (one.is_inside_now && one.inside_of == other.id) || (other.is_inside_now && other.inside_of == one.id);
  if (!is_inside && (one.middle_m - other.middle_m).norm() > one.radius_m + other.radius_m + kNearM) return kNeverS;
  if (is_inside) return kFoundS;
  const double area = AreaOf(one.outline_m);
  const double other_area = AreaOf(other.outline_m);
  const Followed& larger = area >= other_area ? one : other;
  const Followed& lesser = area >= other_area ? other : one;
  const auto both = Intersection(one.outline_m, other.outline_m);
  const double shared_m2 = both.empty() ? 0.0 : std::max(1e-9, AreaOf(both));
  // Longer where both are well known, as a boat and the dock with which it is segmented for a while.
  if (!both.empty() && shared_m2 >= 0.5 * std::min(area, other_area) && !(one.is_seen_now && other.is_seen_now)) {
    const int num_hits = one.is_confirmed == other.is_confirmed ? std::min(one.num_hits, other.num_hits) : (one.is_confirmed ? one : other).num_hits;
    return std::clamp(kPerHitS * num_hits, kShortestS, kLongestS);
  }
  if (IsLikePart(larger, lesser, shared_m2)) return kPartS;
  if (one.is_seen_now && other.is_seen_now && AreTwo(one.sighting, other.sighting)) return kNeverS;
  const bool is_moving_together = IsMoving(one) && IsMoving(other) && SpeedBetween(one, other) < kSameVelocityMps;
  return is_moving_together && GapOf(one.outline_m, other.outline_m).distance_m < kNearM ? kPartS : kNeverS;
}

// The second track becomes one with the first, by the older name.
void Step::Join(Followed& one, Followed& other) {
  const std::int64_t one_before = one.PublicId();
  const std::int64_t other_before = other.PublicId();
  const bool is_part = one.is_seen_now && other.is_seen_now;
  // A confirmed track is not replaced by an unconfirmed one.
  const bool is_larger = AreaOf(other.outline_m) > AreaOf(one.outline_m);
  const bool is_part_better = IsMoving(one) == IsMoving(other) ? is_larger : IsMoving(other);
  const bool is_other_better = is_part ? is_part_better : other.seen_alone > one.seen_alone;
  if (one.is_confirmed == other.is_confirmed ? is_other_better : other.is_confirmed) {
    if (!is_part && IsMoving(one) && !IsMoving(other)) other.body->MoveAs(*one.body);
    std::swap(one, other);
    std::swap(one.id, other.id);
    std::swap(one.number, other.number);
    std::swap(one.parents, other.parents);
    std::swap(one.children, other.children);
    std::swap(one.first, other.first);
    std::swap(one.watched, other.watched);
  }
  one.is_proven = one.is_proven || other.is_proven;
  one.segment_ids.insert(one.segment_ids.end(), other.segment_ids.begin(), other.segment_ids.end());
  other.segment_ids.clear();
  if (one.overtaking == Encounter::kNone) one.overtaking = other.overtaking;
  // The lower number is the older name.
  if (one.number == 0 || (other.number > 0 && other.number < one.number)) std::swap(one.number, other.number);
  merged_.emplace_back(one.PublicId() == one_before ? other_before : one_before, one.PublicId());
  if (other.number > 0) {
    Followed::Relate(one.parents, other.number, scan_.end_time);
    Followed::Relate(other.children, one.number, scan_.end_time);
  }
  if (is_part && other.Existence() > 0.5) {
    one.body->Include(other.outline_m);
    Place(one);
  }
  other.is_ended = true;
}

// Two tracks merge after their evidence for being one object has lasted `OneForS()`. Each scan with evidence against it subtracts its own duration.
void Step::Merge() {
  std::map<Ids, double> still_s;
  for (auto one = known_.tracks.begin(); one != known_.tracks.end(); ++one) {
    if (!one->body || one->is_ended) continue;
    for (auto other = std::next(one); other != known_.tracks.end(); ++other) {
      if (!other->body || other->is_ended) continue;
      const Ids ids(one->id, other->id);
      const auto before = known_.together_s.find(ids);
      const double least_s = OneForS(*one, *other);
      const double change_s = least_s > kNeverS ? dt_s_ : -dt_s_;
      const double for_s = (before == known_.together_s.end() ? 0.0 : before->second) + change_s;
      if (for_s <= 0.0) continue;
      if (least_s <= kNeverS || for_s < least_s) {
        still_s.emplace(ids, for_s);
        continue;
      }
      Join(*one, *other);
    }
  }
  known_.together_s = std::move(still_s);
}

}  // namespace lookout::tracker
