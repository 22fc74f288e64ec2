// Land in a scan.
#include <algorithm>

#include "services/tracker/core/step.hpp"

namespace lookout::tracker {

namespace {

constexpr double kLandShare = 0.6;           // of a segment's returns, where land is remembered
constexpr std::size_t kMostLandPlaces = 40;  // of a segment that are asked for
constexpr std::size_t kMostFed = 400;        // of a segment that are remembered, a scan
constexpr int kMovesFor = 20;                // scans, and
constexpr double kMovedByM = 2.0;            // since it was seen first: a thing that went so far is no land
constexpr std::size_t kLeastPieceReturns = 8;
constexpr double kPieceExistence = 6.0;  // log odds
constexpr double kPieceThing = 0.9;

bool HasMoved(const Followed& track) {
  return track.is_proven || (track.num_moving >= kMovesFor && (track.middle_m - track.first_m).norm() > kMovedByM);
}

// As a thing: pieces of a bank or a pier come and go.
bool IsKnown(const Followed& track) {
  constexpr int kKnownScans = 8;
  return track.is_confirmed && (HasMoved(track) || track.num_hits >= kKnownScans);
}

}  // namespace

// Segments that the segmenter calls land, and those where land is remembered; but nothing that has been seen to move.
void Step::FindLand() {
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const auto& seen = sightings_[i].seen;
    const double land_share = known_.land.Share(sightings_[i].places_m, kMostLandPlaces);
    if (sightings_[i].use == Sighting::Use::kLeftOut) continue;
    if ((seen.is_land && seen.is_sure) || land_share >= kLandShare) sightings_[i].use = Sighting::Use::kLand;
  }
  FollowLandPieces();
  for (const auto& track : known_.tracks) {
    if (!track.is_confirmed || !track.body || !HasMoved(track)) continue;
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      if (sightings_[i].use != Sighting::Use::kLand || sightings_[i].radius_m > 2.0 * track.radius_m + 1.0) continue;
      if ((sightings_[i].middle_m - track.middle_m).norm() > track.radius_m + sightings_[i].radius_m) continue;
      const auto both = Intersection(sightings_[i].seen.outline_m, track.outline_m);
      if (!both.empty() && AreaOf(both) >= 0.5 * AreaOf(sightings_[i].seen.outline_m)) sightings_[i].use = Sighting::Use::kFree;
    }
  }
}

void Step::FollowLandPieces() {
  std::vector<LandPieces::Seen> pieces;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const auto& seen = sightings_[i].seen;
    if (sightings_[i].use != Sighting::Use::kLand || !seen.is_sure || sightings_[i].radius_m > LandPieces::kGreatestRadiusM ||
        sightings_[i].places_m.size() < kLeastPieceReturns)
      continue;
    if (std::ranges::any_of(known_.tracks,
                            [&](const Followed& track) { return track.is_confirmed && Contains(track.outline_m, sightings_[i].middle_m); }))
      continue;
    pieces.push_back({i, seen.outline_m, sightings_[i].places_m, sightings_[i].heights_m, sightings_[i].middle_m, sightings_[i].radius_m,
                      sightings_[i].range_m, seen.covariance_relative_m2, SidesOf(i)});
  }
  std::vector<bool> seems_moving;
  for (auto& proven : known_.land_pieces.Update(pieces, known_.sight, scan_.end_time, seems_moving)) {
    const auto& seen = sightings_[proven.index].seen;
    Followed track;
    track.id = known_.next_id++;
    track.first = proven.first;
    track.seen = track.seen_alone = scan_.end_time;
    track.first_m = proven.first_m;
    track.body = proven.body;
    Place(track);
    track.top_m = seen.top_above_water_m;
    track.log_odds = kPieceExistence;
    track.num_hits = proven.num_hits;
    track.mean_thing = Logit(kPieceThing);
    track.seen_m = track.middle_m;
    track.num_moving = kMovesFor;
    track.is_proven = true;
    Confirm(track);
    known_.tracks.push_back(std::move(track));
  }
  for (std::size_t k = 0; k < pieces.size(); ++k) sightings_[pieces[k].index].seems_moving = seems_moving[k];
}

// A track without a sighting of its own, inside of land by the ledger, is land, unless it was seen to move: then it is a boat that came alongside,
// for as long as beams end in it.
bool Step::IsLand(const Followed& track) const {
  constexpr double kWithinS = 0.5;
  return !HasMoved(track) && track.is_inside_now && track.inside_of == 0 && ToSeconds(scan_.end_time - track.seen_alone) > kWithinS;
}

// A segment beside land may be cut off it by chance, until the ledger has seen both for a while.
bool Step::IsPerhapsLand(const Followed& track, std::size_t i) const {
  constexpr int kSeenFor = 10;  // scans
  constexpr double kBesideShoreM = 2.0;
  if (track.num_hits >= kSeenFor) return false;
  for (std::size_t k = 0; k < sightings_.size(); ++k) {
    if (!sightings_[k].seen.is_land ||
        (sightings_[k].middle_m - sightings_[i].middle_m).norm() > sightings_[k].radius_m + sightings_[i].radius_m + kBesideShoreM)
      continue;
    // The shore, not the hull, of a bay.
    if (std::ranges::any_of(sightings_[k].places_m, [&](const Eigen::Vector2d& place_m) {
          return (place_m - sightings_[i].middle_m).norm() < sightings_[i].radius_m + kBesideShoreM;
        }))
      return true;
  }
  return false;
}

void Step::EndLand() {
  for (auto& track : known_.tracks) {
    if (IsLand(track)) track.is_ended = true;
  }
}

void Step::FeedLand() {
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const auto& seen = sightings_[i].seen;
    if (sightings_[i].use == Sighting::Use::kLand) land_ids_.push_back(seen.segment_id);
    if (sightings_[i].use == Sighting::Use::kLeftOut || !seen.is_sure || sightings_[i].seems_moving) continue;
    std::vector<const Followed*> near;
    for (const auto& track : known_.tracks) {
      if (IsKnown(track) && !IsLand(track) && (track.middle_m - sightings_[i].middle_m).norm() < track.radius_m + sightings_[i].radius_m)
        near.push_back(&track);
    }
    const std::size_t step = 1 + sightings_[i].places_m.size() / kMostFed;
    std::vector<Eigen::Vector2d> fed_m;
    std::vector<double> tops_m;
    for (std::size_t k = 0; k < sightings_[i].places_m.size(); k += step) {
      const auto& place_m = sightings_[i].places_m[k];
      if (seen.is_land && std::ranges::any_of(near, [&](const Followed* track) { return Contains(track->outline_m, place_m); })) continue;
      fed_m.push_back(place_m);
      if (!sightings_[i].heights_m.empty()) tops_m.push_back(sightings_[i].heights_m[k]);
    }
    const bool is_known = std::ranges::any_of(
        near, [&](const Followed* track) { return std::ranges::find(track->segment_ids, seen.segment_id) != track->segment_ids.end(); });
    known_.land.Add(fed_m, tops_m, seen.is_land ? LandMemory::Said::kLand : is_known ? LandMemory::Said::kThing : LandMemory::Said::kMaybeThing);
  }
  known_.land.LookThrough(known_.sight);
}

}  // namespace lookout::tracker
