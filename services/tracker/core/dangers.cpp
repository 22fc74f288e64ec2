#include "services/tracker/core/dangers.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "common/core/angles.hpp"
#include "services/tracker/core/outline.hpp"

namespace lookout::tracker {

namespace {

// Half a knot: below any way that steers.
constexpr double kOwnStillMps = 0.26;
// Longer than a moored boat sways to one side, shorter than it takes to cast off.
constexpr double kOwnAverageS = 5.0;
constexpr double kLikelyApproach = 0.5;
// Drops of rain, spray and most crests are gone by then.
constexpr double kStaysS = 0.8;
constexpr std::chrono::milliseconds kSeenNow{300};
// Crests run, and none lives so long.
constexpr double kCrestS = 5.0;
// A thing that comes up so near to a known one is a part of it until it is a track of its own.
constexpr double kPartM = 2.0;
// A boat in her berth does not keep clear of a boat that passes: she need not know of the passing boat so long before, and its course is known better
// by then. A boat that needs longer to act is told as long before.
constexpr double kBerthS = 15.0;
// What has an alert and is so near beyond the zone keeps it.
constexpr double kEdgeShare = 1.2;
constexpr double kAtEdge = 0.3;

std::vector<Eigen::Vector2d> InVessel(std::span<const Eigen::Vector2d> corners_map_m, const Pose& own) {
  const auto [sine, cosine] = SinCosOf(own.heading_rad);
  std::vector<Eigen::Vector2d> corners_m;
  for (const auto& corner : corners_map_m) {
    const Eigen::Vector2d offset = corner - own.position_map_m.head<2>();
    corners_m.emplace_back(offset.x() * sine + offset.y() * cosine, offset.y() * sine - offset.x() * cosine);
  }
  return corners_m;
}

DangerPlace PlaceOf(const NearestPoint& point, const std::optional<Pose>& own) {
  DangerPlace place{point.range_m, point.bearing_rad};
  if (own) {
    const auto [sine, cosine] = SinCosOf(own->heading_rad + place.bearing_rad);
    place.position_map_m = own->position_map_m.head<2>() + place.range_m * Eigen::Vector2d(sine, cosine);
  }
  return place;
}

// The nearest point of a track.
DangerPlace PlaceOf(const Track& track, const Pose& own) {
  if (track.outline_m.empty()) return {track.range_m, track.bearing_rad};
  const Eigen::Vector2d here_m = own.position_map_m.head<2>();
  const Eigen::Vector2d place_m = GapOf(track.outline_m, {&here_m, 1}).from_m;
  const Eigen::Vector2d off = place_m - here_m;
  return {off.norm(), WrapTo2Pi(Atan2(off.x(), off.y()) - own.heading_rad), place_m};
}

// The part of a thing in the zone, under one name.
struct InZone {
  std::optional<NearestPoint> nearest;
  std::vector<NearestPoint> things;  // the nearest point of each obstacle
  const Track* track = nullptr;      // the nearest
  int num_tracks = 0;
  bool is_certain = false;
  bool is_known = false;  // one of the tracks has been seen for long enough
  double probability = 0.0;

  void Add(const NearestPoint& point, const Track* of, bool is_certain_one, double with_probability) {
    // A place at the edge, or one that may be a piece, is told only where there is no other, and no acknowledgement covers it.
    constexpr double kLikely = 0.5;
    const bool is_likely = with_probability >= kLikely;
    if (is_likely) things.push_back(point);
    const bool was_likely = probability >= kLikely;
    if (!nearest || (is_likely && !was_likely) || (is_likely == was_likely && point.range_m < nearest->range_m)) {
      nearest = point;
      track = of;
    }
    is_certain = is_certain || is_certain_one;
    probability = std::max(probability, with_probability);
  }
};

Danger DangerOf(std::int64_t thing, const InZone& found, const std::vector<NearestPoint>& places, const std::optional<Pose>& own) {
  const auto nearest = PlaceOf(*found.nearest, own);
  Danger danger{.cause = AlertCause::kGuardZone,
                .thing = thing,
                .probability = found.probability,
                .distance_m = nearest.range_m,
                .bearing_rad = nearest.bearing_rad,
                .is_grave = !own || !own->velocity_map_mps.allFinite(),
                .is_just_seen = own && !found.is_certain,
                .is_known = found.is_known,
                .place_map_m = nearest.position_map_m};
  if (found.track != nullptr) {
    danger.nearest_track = found.track->id;
    danger.kind = found.track->kind;
    danger.first = found.track->first;
    danger.seen = found.track->seen;
  }
  danger.places.reserve(places.size());
  for (const auto& place : places) danger.places.push_back(PlaceOf(place, own));
  return danger;
}

// Known things, to which an obstacle without a track may belong.
class KnownThings {
 public:
  KnownThings(const Picture& picture, std::span<const VesselOutline> outlines, const Things& things, const Pose& own) {
    for (const auto& track : picture.tracks) {
      if (!IsConfirmed(track) || track.outline_m.empty() || track.range_m > kFarM) continue;
      known_.push_back({things.ThingOf(track.id), &track, InVessel(track.outline_m, own)});
    }
    for (const auto& outline : outlines) {
      if (outline.is_land) known_.push_back({kLandTrack, nullptr, outline.corners_m, outline.is_line});
    }
  }

  struct Known {
    std::int64_t thing;
    const Track* track;
    std::vector<Eigen::Vector2d> corners_m;  // as the vessel sees it
    bool is_line = false;                    // open: the mouth of a harbour is no land

    double GapTo(const Eigen::Vector2d& place_m) const {
      if (!is_line || corners_m.size() < 3) return GapOf(corners_m, {&place_m, 1}).distance_m;
      double least_m = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i + 1 < corners_m.size(); ++i) {
        least_m = std::min(least_m, GapOf(std::span(corners_m).subspan(i, 2), {&place_m, 1}).distance_m);
      }
      return least_m;
    }
  };
  // nullptr: the obstacle belongs to no known thing.
  const Known* Find(const NearestPoint& point) const {
    const auto [sine, cosine] = SinCosOf(point.bearing_rad);
    const Eigen::Vector2d place_m(point.range_m * cosine, -point.range_m * sine);
    const Known* nearest = nullptr;
    double least_m = kPartM;
    for (const auto& known : known_) {
      const double away_m = known.GapTo(place_m);
      if (away_m > least_m) continue;
      least_m = away_m;
      nearest = &known;
    }
    return nearest;
  }

 private:
  static constexpr double kFarM = 150.0;
  std::vector<Known> known_;
};

// The nearest land of the zone in each bin of bearing: an acknowledgement of land covers these.
class ShoreBearings {
 public:
  explicit ShoreBearings(const GuardZoneParams& zone) : zone_(zone) {}

  void Add(const NearestPoint& point) {
    if (point.range_m > zone_.range_m || !zone_.bearing.Contains(point.bearing_rad)) return;
    KeepNearer(nearest_.at(std::min(static_cast<std::size_t>(point.bearing_rad / kBinRad), kBins - 1)), point);
  }

  // All along the edges.
  void Add(std::span<const Eigen::Vector2d> corners_m, bool is_closed) {
    for (std::size_t i = 0; i + 1 < corners_m.size(); ++i) AddEdge(corners_m[i], corners_m[i + 1]);
    if (is_closed && corners_m.size() > 2) AddEdge(corners_m.back(), corners_m.front());
  }

  std::vector<NearestPoint> Places() const {
    std::vector<NearestPoint> places;
    for (const auto& point : nearest_) {
      if (point) places.push_back(*point);
    }
    return places;
  }

 private:
  static constexpr std::size_t kBins = 72;
  static constexpr double kBinRad = kTwoPi / kBins;
  static_assert(kBinRad <= 0.5 * ToldPlaces::kBesideRad);

  // In steps small enough to miss no bin.
  void AddEdge(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    const double length_m = (to_m - from_m).norm();
    if (length_m == 0.0) return;
    const Eigen::Vector2d along = (to_m - from_m) / length_m;
    // The part of it within the range.
    const double middle_m = -from_m.dot(along);
    const double half2_m2 = zone_.range_m * zone_.range_m - (from_m + middle_m * along).squaredNorm();
    if (half2_m2 < 0.0) return;
    const double end_m = std::min(length_m, middle_m + std::sqrt(half2_m2));
    for (double at_m = std::max(0.0, middle_m - std::sqrt(half2_m2)); at_m <= end_m;) {
      const Eigen::Vector2d point = from_m + at_m * along;
      const double range_m = point.norm();
      Add({range_m, WrapTo2Pi(Atan2(-point.y(), point.x()))});
      at_m += std::max(kLeastStepM, 0.5 * kBinRad * range_m);
    }
  }

  static constexpr double kLeastStepM = 0.05;

  const GuardZoneParams& zone_;
  std::array<std::optional<NearestPoint>, kBins> nearest_;
};

}  // namespace

std::vector<Danger> GuardZoneDangers(const GuardZoneParams& params, const Picture& picture, std::span<const VesselOutline> outlines,
                                     const std::optional<Pose>& own, const Things& things, Newcomers* newcomers, Utime time, const Proof* doubted) {
  if (params.range_m <= 0.0) return {};
  std::map<std::int64_t, InZone> in_zone;  // of each thing, land and things without a name
  std::vector<NearestPoint> unnamed;
  std::optional<KnownThings> known;
  ShoreBearings shore(params);
  const auto add = [&](std::int64_t thing, const std::optional<NearestPoint>& point, const Track* track) {
    if (!point || point->range_m > kEdgeShare * params.range_m) return;
    const bool moves = track != nullptr && !track->velocity_mps.isZero(0.0);
    const bool is_doubted = moves && doubted != nullptr && !params.takes_tentative && doubted->MayBePiece(track->id);
    if (point->range_m > params.range_m || is_doubted) {
      if (track != nullptr && IsConfirmed(*track)) in_zone[thing].Add(*point, track, true, kAtEdge);
      return;
    }
    const bool is_certain =
        params.takes_tentative || thing == kLandTrack || (track != nullptr && (IsConfirmed(*track) || Proof::Lasts(*track, time)));
    const bool is_confirmed = track != nullptr && IsConfirmed(*track);
    if (own && !is_confirmed && thing != kLandTrack && !params.takes_tentative) {
      if (!known) known.emplace(picture, outlines, things, *own);
      if (const auto* of = known->Find(*point)) {
        in_zone[of->thing].Add(*point, of->track, true, 1.0);
        if (of->thing == kLandTrack) shore.Add(*point);  // so that an acknowledgement of the shore does not cover it
        return;
      }
    }
    if (thing == kUnnamed && own && newcomers != nullptr && !is_certain) {
      unnamed.push_back(*point);
      return;
    }
    const bool counts = is_certain || track == nullptr || !own || track->existence_probability >= Proof::kLikely;
    in_zone[thing].Add(*point, track, is_certain, counts ? 1.0 : 0.0);
  };

  std::map<std::int32_t, const Track*> track_of;
  for (const auto& track : picture.tracks) {
    for (const auto id : track.segment_ids) track_of.emplace(id, &track);
  }
  for (const auto& outline : outlines) {
    const auto found = track_of.find(outline.segment_id);
    const Track* track = found == track_of.end() ? nullptr : found->second;
    if (!outline.is_sure && !params.takes_tentative && (track == nullptr || !IsConfirmed(*track))) continue;
    const bool is_land = outline.is_land || std::ranges::count(picture.land_segment_ids, outline.segment_id) > 0;
    const auto thing = track != nullptr ? things.ThingOf(track->id) : is_land ? kLandTrack : kUnnamed;
    auto nearest = NearestWithin(params.bearing, outline.corners_m, !outline.is_line);
    if (!outline.nearest_m.hasNaN()) KeepNearer(nearest, NearestWithin(params.bearing, {&outline.nearest_m, 1}, false));
    add(thing, nearest, track);
    if (thing != kLandTrack) continue;
    if (nearest) shore.Add(*nearest);
    shore.Add(outline.corners_m, !outline.is_line);
  }
  if (newcomers != nullptr) {
    std::vector<DangerPlace> places;
    places.reserve(unnamed.size());
    for (const auto& point : unnamed) places.push_back(PlaceOf(point, own));
    const auto ages_s = newcomers->Update(time, places);
    for (std::size_t i = 0; i < unnamed.size(); ++i) {
      if (ages_s[i] >= kStaysS) in_zone[kUnnamed].Add(unnamed[i], nullptr, false, 1.0);
    }
  }
  if (own) {
    for (const auto& track : picture.tracks) {
      if (!IsConfirmed(track) && !(track.status == TrackStatus::kTentative && params.takes_tentative)) continue;
      const auto nearest = NearestWithin(params.bearing, InVessel(track.outline_m, *own), true);
      const auto thing = things.ThingOf(track.id);
      add(thing, nearest, &track);
      const bool is_known = track.status == TrackStatus::kConfirmed && !Proof::IsYoung(track, time);
      if (is_known && nearest && nearest->range_m <= params.range_m) in_zone[thing].is_known = true;
      if (thing == kLandTrack && nearest) shore.Add(*nearest);
    }
  }

  std::vector<Danger> dangers;
  dangers.reserve(in_zone.size());
  for (const auto& [thing, found] : in_zone) {
    const bool has_places = IsOfPlaces(thing) || things.IsGroup(thing);
    auto places = thing == kLandTrack ? shore.Places() : has_places ? found.things : std::vector<NearestPoint>{};
    if (places.empty() && has_places) places = found.things;
    dangers.push_back(DangerOf(thing, found, places, own));
  }
  return dangers;
}

bool StillWatch::Update(Utime time, const Eigen::Vector2d& velocity_mps) {
  const double step_s = ToSeconds(time - newest_);
  newest_ = time;
  if (mean_mps_.hasNaN() || velocity_mps.hasNaN() || step_s < 0.0 || step_s > 1.0) {
    mean_mps_ = velocity_mps;
  } else {
    mean_mps_ += step_s / (kOwnAverageS + step_s) * (velocity_mps - mean_mps_);
  }
  return mean_mps_.norm() < kOwnStillMps;  // false where it is NaN
}

std::vector<Danger> ClosestApproachDangers(const ApproachParams& params, const Picture& picture, const std::optional<Pose>& own, bool is_own_still,
                                           const Things& things, const Proof* proof, Utime time) {
  if (!own) return {};
  const double own_mps = own->velocity_map_mps.allFinite() ? own->velocity_map_mps.norm() : std::numeric_limits<double>::infinity();
  const double needed_s = TimeToAct(own_mps, params.ability);
  const auto add_approach = [needed_s](const ClosestApproach& approach, double limit_m, Danger& danger) {
    danger.probability = approach.probability;
    danger.distance_m = approach.distance_m;
    danger.cpa_m = approach.cpa_m;
    danger.tcpa_s = approach.tcpa_s;
    danger.time_left_s = TimeLeft(approach, limit_m);
    danger.is_grave = danger.time_left_s < needed_s;  // not where it is NaN
  };
  std::vector<Danger> dangers;
  std::map<std::int64_t, std::vector<DangerPlace>> places_of;  // of things of several tracks: all that are likely to come too near
  for (const auto& track : picture.tracks) {
    const bool lasts = proof != nullptr && Proof::Lasts(track, time);
    if (!IsConfirmed(track) && !lasts) continue;
    const bool may_be_crest = lasts && !track.velocity_mps.isZero(0.0) && ToSeconds(time - track.first) < kCrestS;
    if (is_own_still && track.velocity_mps.isZero(0.0)) continue;
    const auto place = PlaceOf(track, *own);
    Danger danger{.cause = AlertCause::kClosestApproach,
                  .thing = things.ThingOf(track.id),
                  .nearest_track = track.id,
                  .kind = track.kind,
                  .bearing_rad = track.bearing_rad,
                  .first = track.first,
                  .seen = track.seen,
                  .place_map_m = place.position_map_m};
    add_approach(track.approach, params.limit_m, danger);
    // Where a moving thing goes is a guess, and beams that find nothing there say so. What stands may be hidden.
    if (!track.velocity_mps.isZero(0.0)) danger.probability *= track.existence_probability;
    // A boat in her berth gains nothing by being told of a piece of it.
    const bool is_of_berth = is_own_still && proof != nullptr && proof->MayBePiece(track.id);
    const auto doubt = [&track, time, is_of_berth](Danger& of) {
      if (!of.is_grave || is_of_berth || time - track.seen > kSeenNow) of.probability = 0.0;
      of.is_grave = false;
      of.is_just_seen = true;
    };
    const bool is_proven = proof == nullptr || (proof->IsProven(track) && !may_be_crest);
    const bool is_young = proof != nullptr && Proof::IsYoung(track, time);
    if (is_young || !is_proven) doubt(danger);
    if (!is_proven) {
      if (may_be_crest || proof->MayBePiece(track.id)) danger.probability = 0.0;
      // Whatever its course is, it is told no later than if it stood.
      auto standing = danger;
      standing.is_just_seen = false;
      add_approach(track.approach_if_standing, params.limit_m, standing);
      if (time - track.seen > kSeenNow) standing.probability *= track.existence_probability;
      if (is_young) doubt(standing);
      if (!is_own_still && IsGraver(standing, danger)) danger = standing;
    }
    if (is_own_still && danger.time_left_s > std::max(kBerthS, needed_s)) danger.probability = std::min(danger.probability, kAtEdge);
    if (danger.thing != track.id) danger.bearing_rad = place.bearing_rad;
    if (danger.probability >= kLikelyApproach && things.IsGroup(danger.thing)) places_of[danger.thing].push_back(place);
    dangers.push_back(std::move(danger));
  }
  if (picture.land_approach && !is_own_still) {
    const auto& [approach, land_limit_m, bearing_rad, places] = *picture.land_approach;
    Danger danger{.cause = AlertCause::kClosestApproach, .thing = kLandTrack, .kind = TrackKind::kStructure, .bearing_rad = bearing_rad};
    add_approach(approach, land_limit_m, danger);
    const auto nearest = std::ranges::min_element(places, {}, &DangerPlace::range_m);
    if (nearest != places.end()) danger.place_map_m = nearest->position_map_m;
    std::ranges::copy(places, std::back_inserter(places_of[kLandTrack]));
    dangers.push_back(std::move(danger));
  }
  for (auto& danger : dangers) {
    const auto places = places_of.find(danger.thing);
    if (places != places_of.end()) danger.places = places->second;
  }
  return dangers;
}

}  // namespace lookout::tracker
