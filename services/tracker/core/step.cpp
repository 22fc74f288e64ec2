#include "services/tracker/core/step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"
#include "services/tracker/core/assignment.hpp"

namespace lookout::tracker {

namespace {

constexpr std::size_t kLooksKept = 15;
constexpr double kPieceBesideM = 0.3;      // beyond the outline of the thing that it is a piece of
constexpr double kDetectionUnknown = 0.5;  // where nobody knows what could have been seen
constexpr double kMostDetection = 0.95;
constexpr double kGreatestExistence = 6.0;
constexpr double kLeastExistence = -6.0;
constexpr double kMissS = 0.4;  // for how long a known thing is hidden at a time
constexpr double kMissHits = 30.0;
constexpr double kMostCost = 6.0;
constexpr double kLongestScanS = 0.2;
// A seen outline that is farther off, or fits worse, is that of something else too, or of a part: it moves nothing. After so many it is the new one.
constexpr double kMostOff = 16.0;
constexpr double kMostMisfit = 9.0;
constexpr int kMisfitsToRestart = 3;

double RadiusOf(const std::vector<Eigen::Vector2d>& outline_m, const Eigen::Vector2d& middle_m) {
  double radius = 0.0;
  for (const auto& corner : outline_m) radius = std::max(radius, (corner - middle_m).norm());
  return radius;
}

Eigen::Vector2d MiddleOf(const std::vector<Eigen::Vector2d>& outline_m) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& corner : outline_m) middle += corner / static_cast<double>(outline_m.size());
  return middle;
}

// Cheap, before a polygon is asked: rounding counts for it.
bool IsWithin(const Eigen::Vector2d& place_m, const Eigen::Vector2d& middle_m, double radius_m) {
  constexpr double kOfRoundingM = 1e-6;
  return (place_m - middle_m).norm() <= radius_m + kOfRoundingM;
}

}  // namespace

void Step::Run() {
  Predict();
  is_sight_known_ = known_.sight.Begin(scan_);
  known_.had_sight = known_.had_sight || is_sight_known_;
  if (!scan_.own) return;
  FindPlaces();
  LeaveOutdated();
  Settle();
  FindLand();
  Look();
  FindCommonStep();
  known_.clutter.Begin();
  AssignBodies();
  AssignLost();
  AssignRest();
  FindInside();
  for (auto& track : known_.tracks) {
    if (!track.is_seen_now && !track.is_inside_now && !has_left_out_) Miss(track);
  }
  Begin();
  known_.clutter.End(dt_s_);
  FeedLand();
  EndLand();
  Merge();

  if (is_sight_known_) known_.watched.Add(known_.sight, scan_.end_time);
}

Eigen::Vector2d Step::ToVessel(const Eigen::Vector2d& place_m) const {
  const Eigen::Vector2d off = place_m - scan_.own->position_map_m.head<2>();
  const auto [sine, cosine] = SinCosOf(scan_.own->heading_rad);  // forward is (sine, cosine) of east, north
  return {off.x() * sine + off.y() * cosine, -off.x() * cosine + off.y() * sine};
}

void Step::Predict() {
  known_.land_pieces.Predict(dt_s_);
  for (auto& track : known_.tracks) {
    track.segment_ids.clear();
    track.is_seen_now = track.is_inside_now = false;
    track.detection = 0.0;
    if (!track.body) continue;
    track.body->Predict(dt_s_);
    Place(track);
  }
}

void Step::Place(Followed& track) {
  track.outline_m = track.body->Outline();
  track.middle_m = track.body->center_m();
  track.radius_m = RadiusOf(track.outline_m, track.middle_m);
}

void Step::FindPlaces() {
  use_.assign(scan_.seen.size(), Use::kFree);
  middle_m_.clear();
  radius_m_.clear();
  for (const auto& seen : scan_.seen) {
    middle_m_.push_back(MiddleOf(seen.outline_m));
    radius_m_.push_back(RadiusOf(seen.outline_m, middle_m_.back()));
  }
  sides_.assign(scan_.seen.size(), std::nullopt);
  ranges_m_.clear();
  for (const auto& middle_m : middle_m_) ranges_m_.push_back((middle_m - known_.sight.from_m()).norm());
  places_m_.assign(scan_.seen.size(), {});
  std::map<std::int32_t, std::size_t> index_of;
  for (std::size_t i = 0; i < scan_.seen.size(); ++i) index_of[scan_.seen[i].segment_id] = i;
  heights_m_.assign(scan_.seen.size(), {});
  for (const auto& one : known_.sight.Returns()) {
    const auto found = index_of.find(one.label);
    if (found == index_of.end()) continue;
    places_m_[found->second].push_back(one.place_m);
    heights_m_[found->second].push_back(one.height_m);
  }
  for (std::size_t i = 0; i < scan_.seen.size(); ++i) {
    const auto& seen = scan_.seen[i];
    if (!places_m_[i].empty()) continue;
    places_m_[i] = seen.waterline_m.empty() ? seen.outline_m : seen.waterline_m;
  }
}

void Step::Look() {
  for (auto& track : known_.tracks) {
    track.is_met = false;
    if (!is_sight_known_) {
      track.detection = kDetectionUnknown;
      continue;
    }
    const auto look = known_.sight.At(track.outline_m, track.top_m);
    const double share = track.beams_met / track.beams_open;
    // Of so many beams that each would come back with this share; not all of them by themselves.
    double none = 1.0;
    // What ended in it was something there, if not by itself.
    const double num_empty = look.num_open - look.num_met;
    for (int i = 0; i < std::min(20, static_cast<int>(std::lround(num_empty))); ++i) none *= 1.0 - share;
    track.is_met = look.num_met > 0.5 * look.num_open;
    track.detection = std::min(kMostDetection, 1.0 - none);
  }
}

double Step::CostOf(const Followed& track, std::size_t i) const {
  constexpr double kWidestGateM = 12.5;  // of what follows; most pairs are farther apart
  if ((middle_m_[i] - track.middle_m).norm() > kWidestGateM + track.radius_m + radius_m_[i]) return kMostCost;
  const auto& seen = scan_.seen[i];
  const Eigen::Matrix4d covariance = track.body->covariance();
  const double sd = std::min(3.0, std::sqrt(std::max(covariance(0, 0), covariance(1, 1))));
  const double noise = std::sqrt(0.5 * seen.covariance_relative_m2.trace());
  const double gate = 0.5 + 2.0 * sd + std::min(3.0 * std::max(0.0, noise - 0.3), 6.0);
  if ((middle_m_[i] - track.middle_m).norm() > gate + track.radius_m + radius_m_[i]) return kMostCost;
  const double gap = GapOf(track.outline_m, seen.outline_m).distance_m;
  if (gap > gate) return kMostCost;
  const double area_track = std::max(0.1, AreaOf(track.outline_m));
  const double area_seen = std::max(0.1, AreaOf(seen.outline_m));
  const auto both = Intersection(track.outline_m, seen.outline_m);
  const double overlap = both.empty() ? 0.0 : std::min(1.0, std::max(AreaOf(both), 0.1) / std::min(area_track, area_seen));
  const auto shift = track.body->ShiftOf(seen.outline_m, SidesOf(i), seen.covariance_relative_m2, ranges_m_[i]);
  return 0.1 * std::min(shift.off, 30.0) + 0.1 * std::min(shift.misfit, 20.0) + (1.0 - overlap) + 0.1 * std::abs(Log(area_seen / area_track));
}

// Computed once for a segment, where it is asked for.
const Sides& Step::SidesOf(std::size_t i) const {
  if (!sides_[i]) {
    sides_[i] = known_.sight.SidesOf(scan_.seen[i].outline_m, scan_.seen[i].top_above_water_m);
    sides_[i]->before_s = std::clamp(ToSeconds(scan_.end_time - scan_.seen[i].time), 0.0, kLongestScanS);
  }
  return *sides_[i];
}

void Step::AssignBodies() {
  std::vector<std::size_t> rows;
  for (std::size_t t = 0; t < known_.tracks.size(); ++t) {
    if (known_.tracks[t].body) rows.push_back(t);
  }
  std::vector<Candidate> candidates;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t i = 0; i < scan_.seen.size(); ++i) {
      // Land takes no part, unless it is the very thing that was seen there before.
      const bool may_be = use_[i] == Use::kFree || (use_[i] == Use::kLand && known_.tracks[rows[row]].is_confirmed &&
                                                    radius_m_[i] < 2.0 * known_.tracks[rows[row]].radius_m + 1.0);
      if (!may_be) continue;
      const double cost = CostOf(known_.tracks[rows[row]], i) + (use_[i] == Use::kLand ? 1.0 : 0.0);
      if (cost < kMostCost) candidates.push_back({static_cast<std::int32_t>(row), static_cast<std::int32_t>(i), cost});
    }
  }
  const auto column_of = Assign(static_cast<std::int32_t>(rows.size()), static_cast<std::int32_t>(scan_.seen.size()), candidates, kMostCost);
  for (const auto column : column_of) {
    if (column >= 0 && use_[static_cast<std::size_t>(column)] == Use::kFree) use_[static_cast<std::size_t>(column)] = Use::kAssigned;
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (column_of[row] >= 0) HitWhole(known_.tracks[rows[row]], static_cast<std::size_t>(column_of[row]));
  }
}

// A thing may come in several segments. What nothing else is known by, and lies in the outline of a track, is of it.
void Step::HitWhole(Followed& track, std::size_t i) {
  std::vector<std::size_t> others;
  const auto around = RectangleAround(track.outline_m);
  if (track.is_confirmed && use_[i] == Use::kAssigned && around.width_m < kWidestBoatM && around.length_m < kLongestWholeM) {
    for (std::size_t k = 0; k < scan_.seen.size(); ++k) {
      if (use_[k] != Use::kFree || scan_.seen[k].thing_probability < 0.5 || (middle_m_[k] - track.middle_m).norm() > track.radius_m + kPieceBesideM)
        continue;
      if (std::ranges::all_of(scan_.seen[k].outline_m, [&](const auto& corner) {
            return Contains(track.outline_m, corner) || GapOf(track.outline_m, std::array{corner}).distance_m < kPieceBesideM;
          }))
        others.push_back(k);
    }
  }
  if (others.empty()) {
    Hit(track, i, scan_.seen[i], SidesOf(i));
    return;
  }
  Seen whole = scan_.seen[i];
  for (const auto k : others) {
    const auto& piece = scan_.seen[k];
    use_[k] = Use::kTaken;
    whole.outline_m.insert(whole.outline_m.end(), piece.outline_m.begin(), piece.outline_m.end());
    whole.num_returns += piece.num_returns;
    whole.top_above_water_m = std::max(whole.top_above_water_m, piece.top_above_water_m);
    track.segment_ids.push_back(piece.segment_id);
  }
  for (auto& corner : whole.outline_m) corner -= track.middle_m;
  whole.outline_m = Polygon(SupportOf(whole.outline_m));
  for (auto& corner : whole.outline_m) corner += track.middle_m;
  auto sides = known_.sight.SidesOf(whole.outline_m, whole.top_above_water_m);
  sides.before_s = SidesOf(i).before_s;
  Hit(track, i, whole, sides);
}

// The nearest pairs first, each track and each segment once; ties by the lower track, then the lower segment.
template <typename Take>
void Step::TakeNearest(std::vector<Near>& pairs, const Take& take) {
  std::ranges::sort(pairs, {}, [](const Near& near) { return std::tuple(near.distance_m, near.track, near.seen); });
  for (const auto& pair : pairs) {
    if (!known_.tracks[pair.track].is_seen_now && use_[pair.seen] == Use::kFree) take(pair);
  }
}

// What should have been seen where it was and was not, and what is new beside it: the same, which moved otherwise than was thought.
void Step::AssignLost() {
  if (!is_sight_known_ && known_.had_sight) return;
  constexpr double kLostReachM = 1.5;
  constexpr double kFasterMps = 3.0;
  constexpr double kMostReachM = 4.0;
  constexpr double kMostTimesLarger = 8.0;  // in area
  std::vector<Near> pairs;
  for (std::size_t t = 0; t < known_.tracks.size(); ++t) {
    const auto& track = known_.tracks[t];
    if (!track.body || !track.is_confirmed || track.is_seen_now || track.is_met || track.mean_thing < 0.0 || track.detection < kDetectionUnknown)
      continue;
    const double reach_m = std::min(kMostReachM, kLostReachM + kFasterMps * track.UnseenS(scan_.end_time));
    const double area_m2 = std::max(0.1, AreaOf(track.outline_m));
    for (std::size_t i = 0; i < scan_.seen.size(); ++i) {
      if (use_[i] != Use::kFree || !scan_.seen[i].is_sure) continue;
      if ((middle_m_[i] - track.middle_m).norm() > reach_m + track.radius_m + radius_m_[i]) continue;
      const double times = std::max(0.1, AreaOf(scan_.seen[i].outline_m)) / area_m2;
      if (times > kMostTimesLarger || times < 1.0 / kMostTimesLarger) continue;
      const double gap_m = GapOf(track.outline_m, scan_.seen[i].outline_m).distance_m;
      if (gap_m < reach_m) pairs.push_back({gap_m, t, i});
    }
  }
  TakeNearest(pairs, [&](const Near& pair) {
    auto& track = known_.tracks[pair.track];
    track.num_misfits = kMisfitsToRestart;
    Hit(track, pair.seen, scan_.seen[pair.seen], SidesOf(pair.seen), true);
  });
}

// What is not yet likely takes the nearest of the rest.
void Step::AssignRest() {
  std::vector<std::size_t> by_east;
  for (std::size_t i = 0; i < scan_.seen.size(); ++i) {
    if (use_[i] == Use::kFree) by_east.push_back(i);
  }
  const auto east = [this](std::size_t i) { return middle_m_[i].x(); };
  std::ranges::sort(by_east, [&](std::size_t a, std::size_t b) { return std::pair(east(a), a) < std::pair(east(b), b); });
  std::vector<Near> pairs;
  for (std::size_t t = 0; t < known_.tracks.size(); ++t) {
    const auto& track = known_.tracks[t];
    if (track.body) continue;
    const double sd = std::sqrt(0.5 * track.relative_covariance_m2.trace());
    const double reach = 0.4 + std::min(3.0 * std::max(0.0, sd - 0.3), 6.0) + 3.0 * std::min(std::max(0.3, dt_s_), track.UnseenS(scan_.end_time));
    const double far = reach + track.radius_m + 2.0;
    auto first = std::ranges::lower_bound(by_east, track.middle_m.x() - far, {}, east);
    for (; first != by_east.end() && east(*first) <= track.middle_m.x() + far; ++first) {
      const double distance = (middle_m_[*first] - track.middle_m).norm() - track.radius_m - radius_m_[*first];
      if (distance < reach) pairs.push_back({std::max(0.0, distance) + 0.01 * (middle_m_[*first] - track.middle_m).norm(), t, *first});
    }
  }
  TakeNearest(pairs, [&](const Near& pair) {
    Hit(known_.tracks[pair.track], pair.seen, scan_.seen[pair.seen], SidesOf(pair.seen));
    known_.clutter.Add(ToVessel(middle_m_[pair.seen]));
  });
}

void Step::Hit(Followed& track, std::size_t i, const Seen& seen, const Sides& sides, bool is_lost) {
  const bool was_land = use_[i] == Use::kLand;
  use_[i] = Use::kTaken;
  track.is_seen_now = true;
  VoteLand(track, was_land);
  if (was_land) land_ids_kept_.push_back(seen.segment_id);
  const Eigen::Vector2d before_m = track.middle_m;
  const double range_m = ranges_m_[i];
  if (track.body) {
    // Where another that is known lies in what is seen, this is not the outline of one.
    const bool grows = !was_land && std::ranges::none_of(known_.tracks, [&](const Followed& other) {
      return other.is_confirmed && other.id != track.id && IsWithin(other.middle_m, middle_m_[i], radius_m_[i]) &&
             Contains(seen.outline_m, other.middle_m);
    });
    const auto shift = track.body->ShiftOf(seen.outline_m, sides, seen.covariance_relative_m2, range_m);
    if (shift.off < kMostOff && shift.misfit < kMostMisfit) {
      track.num_misfits = 0;
      track.body->Update(seen.outline_m, sides, seen.covariance_relative_m2, range_m, grows);
    } else if (++track.num_misfits >= kMisfitsToRestart) {
      track.num_misfits = 0;
      track.body->Restart(seen.outline_m, sides, range_m, is_lost || (shift.off >= kMostOff && !shift.is_part));
    }
    Place(track);
  } else {
    track.outline_m = seen.outline_m;
    track.middle_m = middle_m_[i];
    track.radius_m = radius_m_[i];
  }
  // Evidence: as dense as its place is known, against clutter there.
  const double sd = std::max(track.body ? 0.3 : 0.5, std::sqrt(0.5 * seen.covariance_relative_m2.trace()));
  const double off = (track.middle_m - before_m).norm();
  const double density = Exp(-0.5 * std::min(off * off / (sd * sd), 50.0)) / (kTwoPi * sd * sd);
  const double clutter = known_.clutter.DensityAt(ToVessel(middle_m_[i]));
  const double detection = std::max(track.detection, 0.1);
  track.log_odds += Log(1.0 - detection + detection * density / clutter);
  track.log_odds = std::clamp(track.log_odds, kLeastExistence, kGreatestExistence);
  const Eigen::Vector2d middle_m = MiddleOf(seen.outline_m);
  // Of what is known for sure, a way behind something else is no unsteadiness.
  const double scans = track.is_confirmed ? std::max(1.0, ToSeconds(scan_.end_time - track.seen) / std::max(dt_s_, 0.01)) : 1.0;
  const Eigen::Vector2d way_m = middle_m - track.seen_m;
  const double step_m = std::min(way_m.norm(), (way_m - common_step_m_).norm());
  track.AddLook(Logit(seen.thing_probability), step_m / scans);
  if (!track.is_confirmed && IsAlone(track, i)) ++track.num_alone;
  track.seen_m = middle_m;
  track.seen_radius_m = radius_m_[i];
  track.sum_returns += seen.num_returns;
  track.top_m = std::max(seen.top_above_water_m, track.top_m + 0.05 * (seen.top_above_water_m - track.top_m));
  track.seen = track.seen_alone = scan_.end_time;
  track.own_covariance_m2 = seen.covariance_m2 - seen.covariance_relative_m2;
  track.relative_covariance_m2 = seen.covariance_relative_m2;
  track.segment_ids.push_back(seen.segment_id);
  Remember(track, true);
  if (is_sight_known_) {
    const auto look = known_.sight.At(seen.outline_m, seen.top_above_water_m);
    constexpr double kForgotten = 0.95;
    track.beams_met = kForgotten * track.beams_met + std::min(look.num_met, look.num_open);
    track.beams_open = kForgotten * track.beams_open + std::max(look.num_open, 1.0);
  }
  if (!track.body && track.Existence() > 0.5) {
    track.body.emplace(seen.outline_m, sides, seen.covariance_relative_m2, range_m);
    Place(track);
  }
  if (track.body && !track.is_confirmed) AskWatched(track);
  // Where nobody knows how the water was watched: a crest lives for about a second.
  constexpr double kCrestThing = 2.0;
  constexpr double kCrestS = 1.0;
  const bool is_perhaps_crest = !track.watched && track.mean_thing < kCrestThing && ToSeconds(scan_.end_time - track.first) < kCrestS;
  if (!track.is_confirmed && !is_perhaps_crest && track.Probability() > params_.confirm_probability && !IsSuspect(track) && !IsPerhapsLand(track, i))
    track.is_confirmed = true;
}

void Step::Remember(Followed& track, bool is_seen) {
  track.looks.push_back(is_seen);
  if (track.looks.size() > kLooksKept) track.looks.pop_front();
}

void Step::Miss(Followed& track) {
  if (track.detection <= 0.0) return;                                      // it could not have been seen
  if (!is_sight_known_ && known_.had_sight && track.is_confirmed) return;  // what was looked through is lost: nobody knows
  // What hides a known thing for a scan (a wave, a roll of the boat) hides it for a while.
  const bool is_moving = track.body && track.body->IsMoving(0.5);
  const double known = is_moving ? 0.0 : std::min(1.0, track.num_hits / kMissHits);
  const double weight = 1.0 - known * (1.0 - std::min(1.0, dt_s_ / kMissS));
  track.log_odds = std::max(kLeastExistence, track.log_odds + weight * Log(1.0 - track.detection));
  if (track.detection > 0.5) Remember(track, false);
}

// Tracks that lie in what another is seen by: a boat that a dock, a bank or another boat was merged with in this scan.
void Step::FindInside() {
  for (auto& track : known_.tracks) {
    if (track.is_seen_now || !track.body) continue;
    for (std::size_t i = 0; i < scan_.seen.size(); ++i) {
      if (use_[i] == Use::kFree || use_[i] == Use::kLeftOut) continue;
      if ((middle_m_[i] - track.middle_m).norm() > radius_m_[i] + track.radius_m) continue;
      const auto both = Intersection(scan_.seen[i].outline_m, track.outline_m);
      const double area = std::max(0.05, AreaOf(track.outline_m));
      if (both.empty() || AreaOf(both) < 0.5 * area) continue;
      // Something of what was seen must lie in it.
      if (!track.is_met && std::ranges::none_of(places_m_[i], [&](const Eigen::Vector2d& place_m) { return Contains(track.outline_m, place_m); }))
        continue;
      track.is_inside_now = true;
      track.seen = scan_.end_time;
      track.inside_of = 0;
      for (const auto& other : known_.tracks) {
        if (other.is_seen_now && std::ranges::find(other.segment_ids, scan_.seen[i].segment_id) != other.segment_ids.end())
          track.inside_of = other.id;
      }
      if (track.inside_of == 0) track.body->Fade(dt_s_);
      break;
    }
  }
}

// A thing beyond doubt that stands by itself, so that it can be no part of another.
bool Step::IsClear(std::size_t i) const {
  constexpr int kLeastReturns = 20;
  constexpr double kLeastThing = 0.98;
  constexpr double kAloneM = 5.0;
  const auto& seen = scan_.seen[i];
  if (seen.num_returns < kLeastReturns || seen.thing_probability < kLeastThing) return false;
  const auto is_near = [&](const Eigen::Vector2d& other_m, double radius_m) {
    return (other_m - middle_m_[i]).norm() < kAloneM + radius_m + radius_m_[i];
  };
  for (std::size_t k = 0; k < scan_.seen.size(); ++k) {
    if (k != i && scan_.seen[k].is_sure && !scan_.seen[k].is_land && is_near(middle_m_[k], radius_m_[k])) return false;
  }
  return std::ranges::none_of(known_.tracks, [&](const Followed& other) { return other.body && is_near(other.middle_m, other.radius_m); });
}

// Beside a known thing its parts may be seen, beside the own hull crew, rods and flags: these stand as still as the thing or the boat.
bool Step::IsAlone(const Followed& track, std::size_t i) const {
  constexpr double kAloneM = 4.0;
  constexpr double kOwnGearM = 2.0;
  const std::array<Eigen::Vector2d, 1> place{ToVessel(middle_m_[i])};
  const double to_own_m = params_.own_hull_m.empty() ? place.front().norm() : GapOf(params_.own_hull_m, place).distance_m;
  if (to_own_m < kOwnGearM + radius_m_[i]) return false;
  return std::ranges::none_of(known_.tracks, [&](const Followed& other) {
    return other.is_confirmed && other.id != track.id && IsWithin(other.middle_m, middle_m_[i], kAloneM + other.radius_m + radius_m_[i]);
  });
}

// How the water was watched in which it came up; again where it turns out to be higher. Nothing comes up beside where a known thing was lost: that is
// the thing.
void Step::AskWatched(Followed& track) const {
  constexpr double kHigherM = 0.05;
  constexpr double kBesideM = 2.0;
  if (!is_sight_known_ || (track.watched && track.top_m < track.watched_top_m + kHigherM)) return;
  const bool is_beside = std::ranges::any_of(known_.tracks, [&](const Followed& other) {
    return other.is_confirmed && !other.is_ended && !other.is_seen_now &&
           (other.middle_m - track.first_m).norm() < kBesideM + other.radius_m + track.first_radius_m;
  });
  track.watched = is_beside ? Watched{} : known_.watched.At(track.first_m, track.top_m, track.first);
  track.watched_top_m = track.top_m;
}

void Step::Begin() {
  std::vector<Followed*> confirmed;
  for (auto& track : known_.tracks) {
    if (track.is_confirmed && !track.is_ended) confirmed.push_back(&track);
  }
  // Where there are too many, what is sure comes first.
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < scan_.seen.size(); ++i) {
    if (use_[i] == Use::kFree) order.push_back(i);
  }
  std::stable_partition(order.begin(), order.end(), [this](std::size_t i) { return scan_.seen[i].is_sure; });
  for (const std::size_t i : order) {
    const auto& seen = scan_.seen[i];
    known_.clutter.Add(ToVessel(middle_m_[i]));
    if (known_.tracks.size() >= kMostTracks) {
      ++known_.num_over_limit;
      continue;
    }
    Followed track;
    track.id = known_.next_id++;
    track.first = track.seen = track.seen_alone = scan_.end_time;
    track.outline_m = seen.outline_m;
    track.middle_m = track.seen_m = track.first_m = middle_m_[i];
    track.radius_m = track.seen_radius_m = track.first_radius_m = radius_m_[i];
    track.top_m = seen.top_above_water_m;
    track.AddLook(Logit(seen.thing_probability), 0.0);
    track.sum_returns = seen.num_returns;
    track.own_covariance_m2 = seen.covariance_m2 - seen.covariance_relative_m2;
    track.relative_covariance_m2 = seen.covariance_relative_m2;
    track.segment_ids.push_back(seen.segment_id);
    Remember(track, true);
    for (auto* other : confirmed) {
      if (IsWithin(track.middle_m, other->middle_m, other->radius_m) && Contains(other->outline_m, track.middle_m)) {
        Followed::Relate(track.parents, other->id, scan_.end_time);
        Followed::Relate(other->children, track.id, scan_.end_time);
      }
    }
    if (seen.is_sure) {
      track.body.emplace(seen.outline_m, SidesOf(i), seen.covariance_relative_m2, ranges_m_[i]);
      Place(track);
      AskWatched(track);
      if (IsClear(i) && Sigmoid(track.NoCrestLogOdds()) > params_.confirm_probability && !IsPerhapsLand(track, i)) {
        track.is_confirmed = true;
        track.log_odds = kClearLogOdds;
      }
    }
    known_.tracks.push_back(std::move(track));
  }
}

}  // namespace lookout::tracker
