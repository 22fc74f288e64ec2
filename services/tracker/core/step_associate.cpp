// Association of segments with tracks.
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "services/tracker/core/assignment.hpp"
#include "services/tracker/core/step.hpp"

namespace lookout::tracker {

namespace {

constexpr double kPieceBesideM = 0.3;  // beyond the outline of the thing that it is a piece of
constexpr double kMostCost = 6.0;
constexpr double kYoungCost = 2.0;
constexpr double kLongestScanS = 0.2;

}  // namespace

double Step::CostOf(const Followed& track, std::size_t i) {
  constexpr double kWidestGateM = 12.5;  // of the gates below; most pairs are farther apart
  if ((sightings_[i].middle_m - track.middle_m).norm() > kWidestGateM + track.radius_m + sightings_[i].radius_m) return kMostCost;
  const auto& seen = sightings_[i].seen;
  const Eigen::Matrix4d covariance = track.body->covariance();
  const double sd = std::min(3.0, std::sqrt(std::max(covariance(0, 0), covariance(1, 1))));
  const double noise = std::sqrt(0.5 * seen.covariance_relative_m2.trace());
  const double gate = 0.5 + 2.0 * sd + std::min(3.0 * std::max(0.0, noise - 0.3), 6.0);
  if ((sightings_[i].middle_m - track.middle_m).norm() > gate + track.radius_m + sightings_[i].radius_m) return kMostCost;
  const double young = track.is_confirmed ? 0.0 : kYoungCost;  // a known track comes before one that came up in it
  if (params_.without.outlines) return (sightings_[i].middle_m - track.middle_m).norm() / gate + young;
  const double gap = GapOf(track.outline_m, seen.outline_m).distance_m;
  if (gap > gate) return kMostCost;
  const double area_track = std::max(0.1, AreaOf(track.outline_m));
  const double area_seen = std::max(0.1, AreaOf(seen.outline_m));
  const auto both = Intersection(track.outline_m, seen.outline_m);
  const double overlap = both.empty() ? 0.0 : std::min(1.0, std::max(AreaOf(both), 0.1) / std::min(area_track, area_seen));
  const auto shift = track.body->ShiftOf(seen.outline_m, SidesOf(i), seen.covariance_relative_m2, sightings_[i].range_m);
  // Mean number of such pieces of clutter within the gate, as drops of rain in the outline of a boat.
  const double chance = known_.clutter.DensityAt(ToVessel(sightings_[i].middle_m), seen.num_returns) * (area_track + 4.0 * gate * gate);
  return Log(1.0 + chance) + 0.1 * std::min(shift.off, 30.0) + 0.1 * std::min(shift.misfit, 20.0) + (1.0 - overlap) +
         0.1 * std::abs(Log(area_seen / area_track)) + young;
}

// Computed once for a segment, on demand.
const Sides& Step::SidesOf(std::size_t i) {
  auto& sighting = sightings_[i];
  if (!sighting.sides) {
    sighting.sides = known_.sight.SidesOf(sighting.seen.outline_m, sighting.seen.top_above_water_m);
    sighting.sides->before_s = std::clamp(ToSeconds(scan_.end_time - sighting.seen.time), 0.0, kLongestScanS);
  }
  return *sighting.sides;
}

void Step::AssignBodies() {
  std::vector<std::size_t> rows;
  for (std::size_t t = 0; t < known_.tracks.size(); ++t) {
    if (known_.tracks[t].body) rows.push_back(t);
  }
  std::vector<Candidate> candidates;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      // Land takes no part, unless it is the very thing that was seen there before.
      const bool may_be =
          sightings_[i].use == Sighting::Use::kFree || (sightings_[i].use == Sighting::Use::kLand && known_.tracks[rows[row]].is_confirmed &&
                                                        sightings_[i].radius_m < 2.0 * known_.tracks[rows[row]].radius_m + 1.0);
      if (!may_be) continue;
      const double cost = CostOf(known_.tracks[rows[row]], i) + (sightings_[i].use == Sighting::Use::kLand ? 1.0 : 0.0);
      if (cost < kMostCost) candidates.push_back({static_cast<std::int32_t>(row), static_cast<std::int32_t>(i), cost});
    }
  }
  const auto column_of = Assign(static_cast<std::int32_t>(rows.size()), static_cast<std::int32_t>(sightings_.size()), candidates, kMostCost);
  for (const auto column : column_of) {
    if (column >= 0 && sightings_[static_cast<std::size_t>(column)].use == Sighting::Use::kFree)
      sightings_[static_cast<std::size_t>(column)].use = Sighting::Use::kAssigned;
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (column_of[row] >= 0) HitWhole(known_.tracks[rows[row]], static_cast<std::size_t>(column_of[row]));
  }
}

// Whether the scans that saw both side by side say that these are two.
bool Step::AreTwo(std::size_t one, std::size_t other) const {
  const auto first = static_cast<std::int32_t>(one);
  const auto second = static_cast<std::int32_t>(other);
  return first < num_groups_ && second < num_groups_ && known_.ledger.EvidenceBetween(first, second) < 0.0F;
}

// A thing may come in several segments. A segment that no other track takes, in the outline of a track, belongs to it.
void Step::HitWhole(Followed& track, std::size_t i) {
  std::vector<std::size_t> others;
  const auto around = RectangleAround(track.outline_m);
  if (track.is_confirmed && sightings_[i].use == Sighting::Use::kAssigned && around.width_m < kWidestBoatM && around.length_m < kLongestWholeM) {
    for (std::size_t k = 0; k < sightings_.size(); ++k) {
      if (AreTwo(i, k)) continue;
      if (sightings_[k].use != Sighting::Use::kFree || sightings_[k].seen.thing_probability < 0.5 ||
          (sightings_[k].middle_m - track.middle_m).norm() > track.radius_m + kPieceBesideM)
        continue;
      if (std::ranges::all_of(sightings_[k].seen.outline_m, [&](const auto& corner) {
            return Contains(track.outline_m, corner) || GapOf(track.outline_m, std::array{corner}).distance_m < kPieceBesideM;
          }))
        others.push_back(k);
    }
  }
  if (others.empty()) {
    Hit(track, i, sightings_[i].seen, SidesOf(i));
    return;
  }
  Seen whole = sightings_[i].seen;
  for (const auto k : others) {
    const auto& piece = sightings_[k].seen;
    sightings_[k].use = Sighting::Use::kTaken;
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
    if (!known_.tracks[pair.track].is_seen_now && sightings_[pair.seen].use == Sighting::Use::kFree) take(pair);
  }
}

// A track that is not yet likely takes the nearest of the rest.
void Step::AssignRest() {
  std::vector<std::size_t> by_east;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (sightings_[i].use == Sighting::Use::kFree) by_east.push_back(i);
  }
  const auto east = [this](std::size_t i) { return sightings_[i].middle_m.x(); };
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
      const double distance = (sightings_[*first].middle_m - track.middle_m).norm() - track.radius_m - sightings_[*first].radius_m;
      if (distance < reach) pairs.push_back({std::max(0.0, distance) + 0.01 * (sightings_[*first].middle_m - track.middle_m).norm(), t, *first});
    }
  }
  TakeNearest(pairs, [&](const Near& pair) {
    Hit(known_.tracks[pair.track], pair.seen, sightings_[pair.seen].seen, SidesOf(pair.seen));
    known_.clutter.Add(ToVessel(sightings_[pair.seen].middle_m), sightings_[pair.seen].seen.num_returns);
  });
}

// The segment around a track and in it: of a thing rather than of land.
std::optional<std::size_t> Step::SightingAround(const Followed& track) const {
  constexpr double kLeastArea = 0.05;
  constexpr double kShare = 0.5;
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const auto& sighting = sightings_[i];
    if (sighting.use == Sighting::Use::kFree || sighting.use == Sighting::Use::kLeftOut) continue;
    if (found && sighting.seen.is_land) continue;
    if ((sighting.middle_m - track.middle_m).norm() > sighting.radius_m + track.radius_m) continue;
    const auto both = Intersection(sighting.seen.outline_m, track.outline_m);
    if (both.empty() || AreaOf(both) < kShare * std::max(kLeastArea, AreaOf(track.outline_m))) continue;
    // Some of its returns must lie in the track; where these are not known, beams that end there.
    const bool is_in = std::ranges::any_of(sighting.places_m, [&](const Eigen::Vector2d& place_m) { return Contains(track.outline_m, place_m); });
    if (!is_in && !(sighting.heights_m.empty() && track.is_met)) continue;
    found = i;
    if (!sighting.seen.is_land) break;
  }
  return found;
}

// Tracks inside of another track's segment: a boat that was merged with a dock, a bank or another boat in this scan.
void Step::FindInside() {
  for (auto& track : known_.tracks) {
    if (track.is_seen_now || !track.body) continue;
    const auto in = SightingAround(track);
    if (!in) continue;
    track.is_inside_now = true;
    track.seen = scan_.end_time;
    track.inside_of = 0;
    for (const auto& other : known_.tracks) {
      if (other.is_seen_now && std::ranges::find(other.segment_ids, sightings_[*in].seen.segment_id) != other.segment_ids.end())
        track.inside_of = other.id;
    }
    if (track.inside_of == 0) track.body->Fade(dt_s_);
  }
}

}  // namespace lookout::tracker
