#include "services/tracker/core/alerts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::tracker {

namespace {

// A shore has 72 places. Of more than so many things the nearest count: in a downpour they are compared one by one.
constexpr std::size_t kMostToldPlaces = 200;
// Less than the time to read an alert and press a button.
constexpr std::chrono::milliseconds kToldAfter{1000};
constexpr double kKeptSideRad = DegToRad(60.0);
constexpr std::size_t kZone = static_cast<std::size_t>(AlertCause::kGuardZone) - 1;
constexpr std::size_t kApproach = static_cast<std::size_t>(AlertCause::kClosestApproach) - 1;
constexpr std::size_t kWatch = static_cast<std::size_t>(AlertCause::kWatch) - 1;
// An alert without a track is shown for so long after its thing was seen last.
constexpr std::chrono::milliseconds kShownFor{500};
constexpr double kPassedS = 1.0;
// A thing far ahead drifts on and off the boat's way as she yaws. Its alert stands on for this share of the time to closest approach.
constexpr double kWaversShare = 0.3;

// Unknown values come last.
double LastIfUnknown(double value) { return std::isnan(value) ? std::numeric_limits<double>::infinity() : value; }

bool IsToldBefore(const Alert& a, const Alert& b) {
  const auto rank = [](const Alert& alert) {
    const double soon_s = LastIfUnknown(std::isnan(alert.time_left_s) ? alert.tcpa_s : alert.time_left_s);
    return std::tuple(!alert.Holds(), alert.level != AlertLevel::kWarning, alert.state, soon_s, LastIfUnknown(alert.distance_m), alert.id);
  };
  return rank(a) < rank(b);
}

bool IsOfTrack(std::int64_t thing) { return !IsOfPlaces(thing); }

const Track* FindTrack(const Surroundings& around, std::int64_t id) {
  const auto found = std::ranges::find(*around.tracks, id, &Track::id);
  return found == around.tracks->end() ? nullptr : &*found;
}

// Distance and bearing to the last place of the thing, as the boat moves.
void TellFromPlace(Alert& alert, const std::optional<Pose>& own) {
  if (!own || alert.place_map_m.hasNaN()) return;
  const Eigen::Vector2d off = alert.place_map_m - own->position_map_m.head<2>();
  alert.distance_m = off.norm();
  alert.bearing_rad = WrapTo2Pi(Atan2(off.x(), off.y()) - own->heading_rad);
}

bool IsAbaft(double bearing_rad) { return std::fabs(WrapToPi(bearing_rad)) > 0.5 * kPi; }

}  // namespace

bool IsGraver(const Danger& one, const Danger& other) {
  constexpr double kLikely = 0.5;
  const auto rank = [](const Danger& danger) {
    const bool is_likely = danger.probability >= kLikely;
    return std::tuple(!is_likely, !danger.is_grave, is_likely ? 0.0 : -danger.probability, LastIfUnknown(danger.time_left_s),
                      LastIfUnknown(danger.distance_m), danger.nearest_track);
  };
  return rank(one) < rank(other);
}

void Alerts::Latch::Update(Utime time, bool is_whole, bool says_on, bool says_off, double clear_s, bool is_known) {
  std::erase_if(looks, [time](const Look& look) { return time - look.time > kGreatestAge; });
  if (is_whole || says_on) looks.push_back({time, says_on});
  if (looks.size() > kWindowScans) looks.pop_front();
  if (says_on || !quiet_since) quiet_since = time;
  // A lost packet hides a part of the water, and not the same part for so long.
  const bool counts_off = is_whole || ToSeconds(time - *quiet_since) >= kHiddenS;
  if (!is_on) {
    is_on = (says_on && is_known) || std::ranges::count_if(looks, &Look::says_on) >= kScansToRaise;
    off_since.reset();
    num_off = 0;
  } else if (!says_off) {
    off_since.reset();
    num_off = 0;
  } else if (counts_off) {
    if (!off_since) off_since = time;
    ++num_off;
    if (num_off >= kScansToClear && ToSeconds(time - *off_since) >= clear_s) {
      is_on = false;
      looks.clear();
    }
  }
}

void Alerts::Latch::ForgetLooks() {
  looks.clear();
  off_since.reset();
  quiet_since.reset();
  num_off = 0;
}

bool Alerts::Entry::IsRaised() const { return std::ranges::any_of(causes, &Latch::is_on); }

const std::vector<Alert>& Alerts::Update(Utime time, bool is_whole, const std::vector<Danger>& dangers, const Surroundings& around) {
  if (newest_ && std::chrono::abs(time - *newest_) > kGreatestAge) {
    for (auto& [thing, entry] : entries_) {
      for (auto& latch : entry.causes) latch.ForgetLooks();
      entry.warning.ForgetLooks();
      entry.untold.ForgetLooks();
      if (entry.lost) entry.lost->since = time;
    }
  }
  newest_ = time;
  adopted_.clear();

  std::map<std::int64_t, Evidence> of_thing;
  for (const auto& danger : dangers) {
    auto& known = of_thing[danger.thing].at(static_cast<std::size_t>(danger.cause) - 1);
    if (known == nullptr || IsGraver(danger, *known)) known = &danger;
    if (danger.probability < params_.raise_probability) continue;
    Adopt(danger.thing, time, danger);
    entries_.try_emplace(danger.thing);
  }
  const auto evidence_of = [&of_thing](std::int64_t thing) {
    const auto found = of_thing.find(thing);
    return found == of_thing.end() ? Evidence{} : found->second;
  };
  for (auto& [thing, entry] : entries_) {
    if (thing != kUnnamed) Update(entry, thing, time, is_whole, evidence_of(thing), around);
  }
  const auto unnamed = FindUnnamed(of_thing);
  if (unnamed) entries_.try_emplace(kUnnamed);
  if (const auto found = entries_.find(kUnnamed); found != entries_.end()) {
    Update(found->second, kUnnamed, time, is_whole, {unnamed ? &*unnamed : nullptr}, around);
  }
  ClearOldestRectified(time);

  alerts_.clear();
  alerts_.swap(ended_);
  std::erase_if(entries_, [time](const auto& item) {
    const auto& entry = item.second;
    if (entry.alert) return entry.is_over && std::fabs(ToSeconds(time - entry.alert->changed)) > kSameS;
    return std::ranges::none_of(entry.causes, [](const Latch& latch) { return std::ranges::any_of(latch.looks, &Latch::Look::says_on); });
  });
  for (auto& [thing, entry] : entries_) {
    if (!entry.HasAlert()) continue;
    alerts_.push_back(*entry.alert);
    entry.is_over = entry.alert->state == AlertState::kCleared;
  }
  std::sort(alerts_.begin(), alerts_.end(), IsToldBefore);
  return alerts_;
}

void Alerts::Update(Entry& entry, std::int64_t thing, Utime time, bool is_whole, const Evidence& evidence, const Surroundings& around) {
  LookFor(entry, thing, time, evidence, around);
  const bool is_lost_for_long = entry.lost && ToSeconds(time - entry.lost->since) >= kHiddenS;
  // The thing may be hidden, and is not abaft yet.
  const bool may_be_there = entry.lost && entry.lost->is_hidden && !is_lost_for_long && !IsAbaft(entry.alert->bearing_rad);
  // The thing opens abaft: there is nothing to wait for.
  const bool has_passed =
      entry.HasAlert() && IsAbaft(entry.alert->bearing_rad) && evidence[kApproach] != nullptr && evidence[kApproach]->tcpa_s == 0.0;
  const double clear_s = has_passed ? std::min(params_.clear_s, kPassedS) : params_.clear_s;
  // A thing at the edge of the zone, which is about to be in it, does not end first by its approach.
  const bool is_at_zone = !entry.causes[kZone].is_on && evidence[kZone] != nullptr && evidence[kZone]->probability >= params_.clear_probability;
  bool says_warning = false;
  bool says_no_warning = true;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const double probability = evidence[i] == nullptr ? 0.0 : evidence[i]->probability;
    const bool says_on = probability >= params_.raise_probability;
    const bool says_off = !(probability >= params_.clear_probability) && !may_be_there && !(i == kApproach && is_at_zone);
    if (i == kApproach && says_on) entry.likely_tcpa_s = evidence[i]->tcpa_s;
    const bool may_waver = i == kApproach && evidence[i] != nullptr && !has_passed;
    const double cause_clear_s = may_waver ? std::clamp(kWaversShare * entry.likely_tcpa_s, clear_s, std::max(clear_s, kSameS)) : clear_s;
    entry.causes[i].Update(time, is_whole, says_on, says_off, cause_clear_s, evidence[i] != nullptr && evidence[i]->is_known);
    const bool is_grave = evidence[i] != nullptr && evidence[i]->is_grave;
    says_warning = says_warning || (says_on && is_grave);
    says_no_warning = says_no_warning && !(is_grave && probability >= params_.clear_probability);
  }
  entry.warning.Update(time, is_whole, says_warning, says_no_warning, clear_s);
  Advance(entry, thing, time);
  if (!entry.HasAlert() || !entry.alert->Holds()) return;
  const DangerPlace last{entry.alert->distance_m, entry.alert->bearing_rad, entry.alert->place_map_m};
  Tell(entry, evidence, time);
  UpdatePlaces(entry, time, is_whole, evidence, last);
}

// Whether its track is still there; of an alert without one the place as it lies from the boat now.
void Alerts::LookFor(Entry& entry, std::int64_t thing, Utime time, const Evidence& evidence, const Surroundings& around) {
  const bool is_told = std::ranges::any_of(evidence, [](const Danger* danger) { return danger != nullptr; });
  if (!entry.HasAlert() || is_told) {
    entry.lost.reset();
    if (!entry.HasAlert()) return;
  }
  auto& alert = *entry.alert;
  if (IsOfTrack(thing) && around.tracks) {
    const Track* track = FindTrack(around, thing);
    if (track != nullptr && track->status != TrackStatus::kLost) entry.velocity_mps = track->velocity_mps;
    if (track != nullptr) entry.was_likely = track->status != TrackStatus::kTentative && track->existence_probability >= 0.5;
    const bool is_there = is_told || (track != nullptr && track->status != TrackStatus::kLost);
    if (is_there) entry.lost.reset();
    if (!is_there && !entry.lost) entry.lost = Lost{time, entry.was_likely};
  }
  if (thing == kUnnamed && !is_told && !entry.lost && time - alert.seen > kShownFor) entry.lost = Lost{time, false};
  const bool is_lost = entry.lost.has_value();
  if (is_lost) alert.nearest_track = kLandTrack;
  if (is_lost || !is_told) {
    TellFromPlace(alert, around.own);
    alert.cpa_m = alert.tcpa_s = alert.cpa_probability = alert.time_left_s = kNan;
  }
  if (is_lost) alert.sight = AlertSight::kLost;
  if (!is_lost && alert.sight == AlertSight::kLost) alert.sight = AlertSight::kSeen;
}

// Which danger of a thing is told: what is likely; then that in the zone, as it is the nearest, unless what lies on the boat's way is elsewhere.
const Danger* Alerts::ToldOf(const Evidence& evidence, bool comes_near) const {
  const Danger* zone = evidence[kZone];
  const Danger* approach = evidence[kApproach];
  const auto is_likely = [this](const Danger* danger) { return danger != nullptr && danger->probability >= params_.raise_probability; };
  const bool is_on_way = comes_near && is_likely(approach) && !std::isnan(approach->time_left_s);
  const bool is_elsewhere = zone != nullptr && is_on_way && std::fabs(WrapToPi(approach->bearing_rad - zone->bearing_rad)) > kKeptSideRad;
  if (is_likely(zone) && !is_elsewhere) return zone;
  if (is_likely(approach)) return approach;
  return zone != nullptr ? zone : approach != nullptr ? approach : evidence[kWatch];
}

// An alert that holds, in the words of this scan.
void Alerts::Tell(Entry& entry, const Evidence& evidence, Utime time) const {
  auto& alert = *entry.alert;
  alert.is_in_zone = entry.causes[kZone].is_on;
  alert.comes_near = entry.causes[kApproach].is_on;
  alert.cause = entry.causes[kWatch].is_on ? AlertCause::kWatch : alert.comes_near ? AlertCause::kClosestApproach : AlertCause::kGuardZone;
  const Danger* nearest = ToldOf(evidence, alert.comes_near);
  if (nearest == nullptr) return;
  alert.tells_way = nearest == evidence[kApproach];
  alert.nearest_track = nearest->nearest_track;
  alert.kind = nearest->kind;
  alert.distance_m = nearest->distance_m;
  alert.bearing_rad = nearest->bearing_rad;
  if (!nearest->place_map_m.hasNaN()) alert.place_map_m = nearest->place_map_m;
  entry.placed = time;
  bool is_just_seen = true;
  for (const auto* danger : evidence) {
    if (danger == nullptr) continue;
    alert.seen = std::max(alert.seen, danger->seen);
    if (danger->probability >= params_.raise_probability) is_just_seen = is_just_seen && danger->is_just_seen;
  }
  const bool is_likely =
      std::ranges::any_of(evidence, [this](const Danger* danger) { return danger != nullptr && danger->probability >= params_.raise_probability; });
  if (is_likely) alert.sight = is_just_seen ? AlertSight::kJustSeen : AlertSight::kSeen;
  const Danger* approach = evidence[kApproach];
  alert.cpa_m = approach == nullptr ? kNan : approach->cpa_m;
  alert.tcpa_s = approach == nullptr ? kNan : approach->tcpa_s;
  alert.cpa_probability = approach == nullptr ? kNan : approach->probability;
  alert.time_left_s = approach == nullptr ? kNan : approach->time_left_s;
}

// Precondition: the alert holds. `last` is where it was told in the scan before.
void Alerts::UpdatePlaces(Entry& entry, Utime time, bool is_whole, const Evidence& evidence, const DangerPlace& last) const {
  std::vector<DangerPlace> places;
  for (const auto* danger : evidence) {
    if (danger != nullptr) std::ranges::copy(danger->places, std::back_inserter(places));
  }
  if (places.size() > kMostToldPlaces) {
    std::ranges::stable_sort(places, {}, &DangerPlace::range_m);
    places.resize(kMostToldPlaces);
  }
  auto& alert = *entry.alert;
  std::optional<DangerPlace> untold;
  if (!entry.told && alert.state == AlertState::kAcknowledged && !places.empty()) {
    // The acknowledgement was given to a thing with one place: what has come to it since was not told.
    entry.told.emplace(alert.thing == kUnnamed ? ToldPlaces::Kind::kThings : ToldPlaces::Kind::kLand);
    entry.told->Tell(time, {&last, 1});
  }
  if (entry.told) {
    untold = entry.told->Untold(time, places);
    entry.untold.Update(time, is_whole, untold.has_value(), !untold, params_.clear_s);
  }
  if (!places.empty()) {
    // The first look is older than a second, if there is one.
    while (entry.shown.size() > 1 && std::chrono::abs(time - entry.shown[1].time) >= kToldAfter) entry.shown.pop_front();
    entry.shown.push_back({time, std::move(places)});
  }
  if (alert.state == AlertState::kAcknowledged && entry.untold.is_on) {
    alert.SetState(AlertState::kActive, time);
    entry.untold = {};
  }
  if (alert.state == AlertState::kActive && untold) {
    alert.distance_m = untold->range_m;
    alert.bearing_rad = untold->bearing_rad;
    alert.place_map_m = untold->position_map_m;
  }
}

// Dangers in the guard zone without an alert that holds. Call this once the others are up to date.
std::optional<Danger> Alerts::FindUnnamed(const std::map<std::int64_t, Evidence>& dangers) const {
  const Danger* nearest = nullptr;
  std::vector<DangerPlace> places;
  bool is_just_seen = true;
  bool is_grave = false;
  for (const auto& [thing, evidence] : dangers) {
    const Danger* danger = evidence[kZone];
    if (danger == nullptr || danger->probability < params_.raise_probability) continue;
    const auto entry = entries_.find(thing);
    if (thing != kUnnamed && entry != entries_.end() && entry->second.HasAlert() && entry->second.alert->Holds()) continue;
    if (danger->places.empty()) {
      places.push_back({danger->distance_m, danger->bearing_rad, danger->place_map_m});
    } else {
      std::ranges::copy(danger->places, std::back_inserter(places));
    }
    is_just_seen = is_just_seen && danger->is_just_seen;
    is_grave = is_grave || danger->is_grave;
    if (nearest == nullptr || danger->distance_m < nearest->distance_m) nearest = danger;
  }
  if (nearest == nullptr) return std::nullopt;
  auto all = *nearest;
  all.thing = kUnnamed;
  all.nearest_track = kLandTrack;
  all.kind = TrackKind::kUnknown;
  all.is_just_seen = is_just_seen;
  all.is_grave = is_grave;
  all.places = std::move(places);
  return all;
}

// Whether an alert of a named thing in the guard zone holds.
bool Alerts::HasNamedInZone(bool (*is_so)(const Alert&)) const {
  return std::ranges::any_of(entries_, [is_so](const auto& item) {
    const auto& [thing, entry] = item;
    return thing != kUnnamed && entry.HasAlert() && entry.causes[kZone].is_on && is_so(*entry.alert);
  });
}

void Alerts::Advance(Entry& entry, std::int64_t thing, Utime time) {
  const auto level = entry.warning.is_on ? AlertLevel::kWarning : AlertLevel::kCaution;
  if (!entry.HasAlert()) {
    // Another alert of the zone holds. The looks stay: this alert comes up as soon as none holds.
    if (thing == kUnnamed && HasNamedInZone([](const Alert& alert) { return alert.state == AlertState::kActive; })) {
      entry.causes[kZone].is_on = false;
    }
    if (!entry.IsRaised()) return;
    if (entry.is_over) {
      // The same thing is dangerous again, so soon.
      auto& alert = *entry.alert;
      entry.is_over = false;
      const bool is_known = entry.was_acknowledged && level <= alert.level;
      alert.SetState(is_known ? AlertState::kAcknowledged : AlertState::kActive, time);
      alert.SetLevel(level, time);
      alert.end = AlertEnd::kNone;
      return;
    }
    entry.alert = Alert{.id = next_id_++, .level = level, .thing = thing, .raised = time, .changed = time};
    return;
  }
  auto& alert = *entry.alert;
  if (alert.state == AlertState::kCleared) return;
  if (!entry.IsRaised()) {
    if (alert.Holds()) {
      alert.end = entry.lost && IsOfTrack(thing) ? (entry.lost->is_hidden && !IsAbaft(alert.bearing_rad) ? AlertEnd::kHidden
                                                    : IsAbaft(alert.bearing_rad)                         ? AlertEnd::kPassed
                                                                                                         : AlertEnd::kGone)
                                                 : (IsAbaft(alert.bearing_rad) ? AlertEnd::kPassed : AlertEnd::kClear);
      alert.is_in_zone = alert.comes_near = false;
      entry.was_acknowledged = alert.state == AlertState::kAcknowledged;
    }
    // A thing that has a name by now has an alert of its own.
    const bool is_named = thing == kUnnamed && HasNamedInZone([](const Alert& other) { return other.Holds(); });
    const bool wants_note = alert.state != AlertState::kAcknowledged && alert.level == AlertLevel::kWarning && !is_named;
    alert.SetState(wants_note ? AlertState::kRectified : AlertState::kCleared, time);
    return;
  }
  const bool rises = level > alert.level;
  alert.SetLevel(level, time);
  if (rises || alert.state == AlertState::kRectified) {
    alert.SetState(AlertState::kActive, time);
    alert.end = AlertEnd::kNone;
  }
}

void Alerts::ClearOldestRectified(Utime time) {
  std::vector<Alert*> rectified;
  for (auto& [thing, entry] : entries_) {
    if (entry.alert && entry.alert->state == AlertState::kRectified) rectified.push_back(&*entry.alert);
  }
  if (rectified.size() <= kMostRectified) return;
  std::ranges::sort(rectified, {}, [](const Alert* alert) { return std::pair(alert->changed, alert->id); });
  for (std::size_t i = 0; i + kMostRectified < rectified.size(); ++i) rectified[i]->SetState(AlertState::kCleared, time);
}

bool Alerts::Acknowledge(const Acknowledgement& acknowledgement, Utime time) {
  for (auto& [thing, entry] : entries_) {
    if (!entry.HasAlert() || entry.alert->id != acknowledgement.alert_id || entry.alert->raised != acknowledgement.raised) continue;
    if (entry.alert->state == AlertState::kActive) {
      entry.alert->SetState(AlertState::kAcknowledged, time);
      if (IsOfPlaces(thing) || !entry.shown.empty()) TellPlaces(entry, thing, acknowledgement);
    } else if (entry.alert->state == AlertState::kRectified) {
      entry.alert->SetState(AlertState::kCleared, time);
      entry.was_acknowledged = true;
    } else {
      return false;
    }
    return true;
  }
  return false;
}

// Places shown a second ago, followed since: a place that came up between is not acknowledged. An acknowledgement by the tracker itself for a person
// (see KeptAcknowledgements) is on the side of the boat where it was told.
void Alerts::TellPlaces(Entry& entry, std::int64_t thing, const Acknowledgement& acknowledgement) {
  if (!entry.told) entry.told.emplace(thing == kUnnamed ? ToldPlaces::Kind::kThings : ToldPlaces::Kind::kLand);
  entry.untold = {};
  if (entry.shown.empty()) return;
  auto [shown_at, places] = entry.shown.front();
  if (acknowledgement.seq == 0 && acknowledgement.source == "tracker") {
    std::erase_if(places,
                  [&entry](const DangerPlace& place) { return std::fabs(WrapToPi(place.bearing_rad - entry.alert->bearing_rad)) > kKeptSideRad; });
  }
  entry.told->Tell(shown_at, places);
  for (std::size_t i = 1; i < entry.shown.size(); ++i) entry.told->Untold(entry.shown[i].time, entry.shown[i].places);
}

}  // namespace lookout::tracker
