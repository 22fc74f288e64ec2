// The thing of an alert: when things become one, are found again, or lose their map.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "services/tracker/core/alerts.hpp"

namespace lookout::tracker {

namespace {

// How far off a lost thing may be by now, for each second.
constexpr double kMovedOnMps = 0.5;
// How long before the end of the old track, or before the alert of a thing without a name, the new one may have begun.
constexpr std::chrono::seconds kBeganBefore{2};

// A thing that comes up again so near, and so soon, is the lost one.
constexpr double kSurelySameM = 5.0;
constexpr double kSurelySameS = 10.0;

bool HasTrack(std::int64_t thing) { return !IsOfPlaces(thing); }

DangerPlace PlaceOf(const Alert& alert) { return {alert.distance_m, alert.bearing_rad, alert.place_map_m}; }

}  // namespace

bool Alerts::Entry::WasLost() const { return lost || (is_over && (alert->end == AlertEnd::kHidden || alert->end == AlertEnd::kGone)); }

// Distance to the last place of the thing, or to where it would be by now. Precondition: it has an alert with a place.
double Alerts::Entry::DistanceTo(const Eigen::Vector2d& place_map_m, Utime time) const {
  const Eigen::Vector2d stood = alert->place_map_m - place_map_m;
  const Eigen::Vector2d went = stood + ToSeconds(time - placed) * velocity_mps;
  return std::min(stood.norm(), went.norm());
}

// The alert of a lost thing, or of one without a name, goes on under the name of the thing that is found at the same place. Where that was found
// before the old track was given up it has an alert of its own: then the two become one.
void Alerts::Adopt(std::int64_t thing, Utime time, const Danger& danger) {
  if (IsOfPlaces(thing) || danger.place_map_m.hasNaN()) return;
  const auto own = entries_.find(thing);
  const bool has_own = own != entries_.end() && own->second.HasAlert();
  if (own != entries_.end() && own->second.is_over) return;
  auto best = entries_.end();
  double least_m = kSamePlaceM;
  for (auto item = entries_.begin(); item != entries_.end(); ++item) {
    const auto& [other, entry] = *item;
    if (item == own || !entry.alert || entry.alert->place_map_m.hasNaN()) continue;
    // A lost thing; not an alert that is over and goes on where it is clear.
    const bool is_nameless = other == kUnnamed && entry.HasAlert() && entry.alert->Holds();
    const bool is_lost_now = HasTrack(other) && entry.lost && entry.HasAlert() && entry.alert->Holds();
    const bool is_free = has_own ? is_lost_now : HasTrack(other) ? entry.WasLost() : is_nameless;
    // Another thing that comes by was seen before.
    const Utime since = HasTrack(other) ? entry.alert->seen : entry.alert->raised;
    if (!is_free || danger.first < since - kBeganBefore) continue;
    // Beyond what it may have moved otherwise.
    const double away_m = entry.DistanceTo(danger.place_map_m, time) - kMovedOnMps * std::fabs(ToSeconds(time - entry.alert->seen));
    if (away_m > least_m) continue;
    least_m = away_m;
    best = item;
  }
  if (best == entries_.end()) return;
  adopted_.emplace_back(best->first, thing);
  if (has_own) return Rename(best->first, thing, time);
  auto moved = entries_.extract(best);
  entries_.erase(thing);
  auto& entry = moved.mapped();
  // So far off, or so late, the thing may be another boat, which nobody has acknowledged.
  const bool is_sure = entry.DistanceTo(danger.place_map_m, time) <= kSurelySameM && ToSeconds(time - entry.alert->seen) <= kSurelySameS;
  if (!is_sure) {
    entry.was_acknowledged = false;
    if (entry.alert->state == AlertState::kAcknowledged) entry.alert->SetState(AlertState::kActive, time);
  }
  moved.key() = thing;
  entry.alert->thing = thing;
  entry.lost.reset();
  entry.told.reset();
  entry.untold = {};
  entry.shown.clear();
  entries_.insert(std::move(moved));
}

void Alerts::ForgetMap() {
  for (auto& [thing, entry] : entries_) {
    if (entry.alert) entry.alert->place_map_m.setConstant(kNan);
    if (entry.told) entry.told->ForgetMap();
    for (auto& shown : entry.shown) {
      for (auto& place : shown.places) place.position_map_m.setConstant(kNan);
    }
  }
}

void Alerts::Rename(std::int64_t from_thing, std::int64_t to_thing, Utime time) {
  if (from_thing == to_thing) return;
  auto moved = entries_.extract(from_thing);
  if (!moved) return;
  moved.key() = to_thing;
  const auto placed = entries_.insert(std::move(moved));
  auto& stays = placed.position->second;
  if (placed.inserted) {
    if (stays.alert) stays.alert->thing = to_thing;
    return;
  }
  auto& goes = placed.node.mapped();
  if (!goes.alert) return;
  const bool is_older = goes.HasAlert() == stays.HasAlert() && stays.alert && goes.alert->id < stays.alert->id;
  if ((goes.HasAlert() && !stays.HasAlert()) || !stays.alert || is_older) std::swap(stays, goes);
  stays.alert->thing = to_thing;
  if (!goes.HasAlert()) return;
  if (goes.alert->Holds()) {
    const bool is_open = goes.alert->state == AlertState::kActive || stays.alert->state != AlertState::kAcknowledged;
    stays.alert->SetState(is_open ? AlertState::kActive : AlertState::kAcknowledged, time);
    stays.alert->SetLevel(std::max(stays.alert->level, goes.alert->level), time);
    stays.alert->end = AlertEnd::kNone;
    for (std::size_t i = 0; i < stays.causes.size(); ++i) stays.causes[i].Merge(goes.causes[i]);
    stays.warning.Merge(goes.warning);
    if (!is_open) {
      // The acknowledgements of both cover the places of both.
      if (!stays.told) {
        stays.told.emplace(to_thing == kUnnamed ? ToldPlaces::Kind::kThings : ToldPlaces::Kind::kLand);
        stays.told->Tell(time, std::array{PlaceOf(*stays.alert)});
      }
      stays.told->Tell(time, std::array{PlaceOf(*goes.alert)});
    }
  }
  goes.alert->SetState(AlertState::kCleared, time);
  goes.alert->end = AlertEnd::kMerged;
  ended_.push_back(*goes.alert);
}

}  // namespace lookout::tracker
