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

// A shore has 72. Of more things the nearest count: in a downpour they are compared one by one.
constexpr std::size_t kMostToldPlaces = 200;
// Less than it takes to read an alert and to press a button.
constexpr std::chrono::milliseconds kToldAfter{1000};
constexpr double kKeptSideRad = DegToRad(60.0);

void SetState(Alert& alert, AlertState state, Utime time) {
  if (alert.state != state) alert.changed = time;
  alert.state = state;
}

void SetLevel(Alert& alert, AlertLevel level, Utime time) {
  if (alert.level == level) return;
  alert.level = level;
  alert.changed = time;
}

bool IsGraver(const Alert& a, const Alert& b) {
  const auto number = [](double value) { return std::isnan(value) ? std::numeric_limits<double>::infinity() : value; };
  const auto rank = [&number](const Alert& alert) {
    return std::tuple(!alert.Holds(), alert.level != AlertLevel::kWarning, alert.state, number(alert.tcpa_s), number(alert.distance_m), alert.id);
  };
  return rank(a) < rank(b);
}

}  // namespace

void Alerts::Latch::Update(Utime time, bool is_whole, bool says_on, bool says_off, double clear_s) {
  std::erase_if(looks, [time](const Look& look) { return time - look.time > kGreatestAge; });
  if (is_whole || says_on) looks.push_back({time, says_on});
  if (looks.size() > kWindowScans) looks.pop_front();
  if (!is_on) {
    is_on = std::ranges::count_if(looks, &Look::says_on) >= kScansToRaise;
    off_since.reset();
    num_off = 0;
  } else if (!says_off) {
    off_since.reset();
    num_off = 0;
  } else if (is_whole) {
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
  num_off = 0;
}

const std::vector<Alert>& Alerts::Update(Utime time, bool is_whole, const std::vector<Danger>& dangers) {
  if (newest_ && std::chrono::abs(time - *newest_) > kGreatestAge) {
    for (auto& [key, entry] : entries_) {
      entry.raised.ForgetLooks();
      entry.warning.ForgetLooks();
      entry.untold.ForgetLooks();
    }
  }
  newest_ = time;

  std::map<Key, const Danger*> of_key;
  for (const auto& danger : dangers) {
    const Key key{danger.cause, danger.track_id};
    auto& known = of_key[key];
    if (known == nullptr || danger.probability > known->probability) known = &danger;
    if (danger.probability >= params_.raise_probability) entries_.try_emplace(key);
  }
  for (auto& [key, entry] : entries_) {
    const auto found = of_key.find(key);
    if (key != kUnnamedKey) Update(entry, key, time, is_whole, found == of_key.end() ? nullptr : found->second);
  }
  const auto unnamed = FindUnnamed(of_key);
  if (unnamed) entries_.try_emplace(kUnnamedKey);
  if (const auto found = entries_.find(kUnnamedKey); found != entries_.end()) {
    Update(found->second, kUnnamedKey, time, is_whole, unnamed ? &*unnamed : nullptr);
  }
  ClearOldestRectified(time);

  alerts_.clear();
  alerts_.swap(ended_);
  std::erase_if(entries_, [this](const auto& item) {
    const auto& [key, entry] = item;
    if (entry.alert) alerts_.push_back(*entry.alert);
    return entry.alert ? entry.alert->state == AlertState::kCleared : std::ranges::none_of(entry.raised.looks, &Latch::Look::says_on);
  });
  std::sort(alerts_.begin(), alerts_.end(), IsGraver);
  return alerts_;
}

void Alerts::Update(Entry& entry, const Key& key, Utime time, bool is_whole, const Danger* danger) {
  const double probability = danger == nullptr ? 0.0 : danger->probability;
  const bool is_grave = danger != nullptr && (danger->is_inside || (danger->tcpa_s > 0.0 && danger->tcpa_s < params_.warning_tcpa_s));
  const bool says_on = probability >= params_.raise_probability;
  const bool says_off = !(probability >= params_.clear_probability);
  entry.raised.Update(time, is_whole, says_on, says_off, params_.clear_s);
  entry.warning.Update(time, is_whole, says_on && is_grave, says_off || !is_grave, params_.clear_s);
  Advance(entry, key, time);
  if (!entry.alert || !entry.alert->Holds() || danger == nullptr) return;
  auto& alert = *entry.alert;
  alert.distance_m = danger->distance_m;
  alert.bearing_rad = danger->bearing_rad;
  alert.cpa_m = danger->cpa_m;
  alert.tcpa_s = danger->cause == AlertCause::kClosestApproach ? danger->tcpa_s : kNan;
  alert.cpa_probability = danger->cause == AlertCause::kClosestApproach ? probability : kNan;
  if (IsOfPlaces(key.second)) UpdatePlaces(entry, time, is_whole, *danger);
}

// Precondition: the alert holds.
void Alerts::UpdatePlaces(Entry& entry, Utime time, bool is_whole, const Danger& danger) const {
  auto places = danger.places;
  if (places.size() > kMostToldPlaces) {
    std::ranges::stable_sort(places, {}, &DangerPlace::range_m);
    places.resize(kMostToldPlaces);
  }
  auto& alert = *entry.alert;
  std::optional<DangerPlace> untold;
  if (entry.told) {
    untold = entry.told->Untold(time, places);
    entry.untold.Update(time, is_whole, untold.has_value(), !untold, params_.clear_s);
  }
  if (!places.empty()) {
    // The first one is older than a second, if there is one.
    while (entry.shown.size() > 1 && std::chrono::abs(time - entry.shown[1].time) >= kToldAfter) entry.shown.pop_front();
    entry.shown.push_back({time, std::move(places)});
  }
  if (alert.state == AlertState::kAcknowledged && entry.untold.is_on) {
    SetState(alert, AlertState::kActive, time);
    entry.untold = {};
  }
  if (alert.state == AlertState::kActive && untold) {
    alert.distance_m = untold->range_m;
    alert.bearing_rad = untold->bearing_rad;
  }
}

// All in the guard zone that has no alert which holds. Call it once the others are up to date.
std::optional<Danger> Alerts::FindUnnamed(const std::map<Key, const Danger*>& dangers) const {
  const Danger* nearest = nullptr;
  std::vector<DangerPlace> places;
  for (const auto& [key, danger] : dangers) {
    if (key.first != AlertCause::kGuardZone) continue;
    const auto entry = entries_.find(key);
    const bool holds = key != kUnnamedKey && entry != entries_.end() && entry->second.alert && entry->second.alert->Holds();
    if (holds) continue;
    std::ranges::copy(danger->places, std::back_inserter(places));
    if (nearest == nullptr || danger->distance_m < nearest->distance_m) nearest = danger;
  }
  if (nearest == nullptr) return std::nullopt;
  auto all = *nearest;
  all.places = std::move(places);
  return all;
}

// Whether an alert of something in the guard zone that has a name is so.
bool Alerts::HasNamedInZone(bool (*is_so)(const Alert&)) const {
  return std::ranges::any_of(entries_, [is_so](const auto& item) {
    const auto& [key, entry] = item;
    return key.first == AlertCause::kGuardZone && key != kUnnamedKey && entry.alert && is_so(*entry.alert);
  });
}

void Alerts::Advance(Entry& entry, const Key& key, Utime time) {
  const auto level = entry.warning.is_on ? AlertLevel::kWarning : AlertLevel::kCaution;
  if (!entry.alert) {
    // Somebody is being told of the zone anyway. The looks stay: it comes up as soon as nobody is.
    if (key == kUnnamedKey && HasNamedInZone([](const Alert& alert) { return alert.state == AlertState::kActive; })) entry.raised.is_on = false;
    if (!entry.raised.is_on) return;
    entry.alert = Alert{.id = next_id_++, .cause = key.first, .level = level, .track_id = key.second, .raised = time, .changed = time};
    return;
  }
  auto& alert = *entry.alert;
  if (alert.state == AlertState::kCleared) return;
  if (!entry.raised.is_on) {
    // What is named by now has an alert of its own.
    const bool is_named = key == kUnnamedKey && HasNamedInZone([](const Alert& other) { return other.Holds(); });
    const bool wants_note = alert.state != AlertState::kAcknowledged && alert.level == AlertLevel::kWarning && !is_named;
    SetState(alert, wants_note ? AlertState::kRectified : AlertState::kCleared, time);
    return;
  }
  const bool rises = level > alert.level;
  SetLevel(alert, level, time);
  if (rises || alert.state == AlertState::kRectified) SetState(alert, AlertState::kActive, time);
}

void Alerts::ClearOldestRectified(Utime time) {
  std::vector<Alert*> rectified;
  for (auto& [key, entry] : entries_) {
    if (entry.alert && entry.alert->state == AlertState::kRectified) rectified.push_back(&*entry.alert);
  }
  if (rectified.size() <= kMostRectified) return;
  std::ranges::sort(rectified, {}, [](const Alert* alert) { return std::pair(alert->changed, alert->id); });
  for (std::size_t i = 0; i + kMostRectified < rectified.size(); ++i) SetState(*rectified[i], AlertState::kCleared, time);
}

bool Alerts::Acknowledge(const Acknowledgement& acknowledgement, Utime time) {
  for (auto& [key, entry] : entries_) {
    if (!entry.alert || entry.alert->id != acknowledgement.alert_id || entry.alert->raised != acknowledgement.raised) continue;
    if (entry.alert->state == AlertState::kActive) {
      SetState(*entry.alert, AlertState::kAcknowledged, time);
      if (IsOfPlaces(key.second)) TellPlaces(entry, key, acknowledgement);
    } else if (entry.alert->state == AlertState::kRectified) {
      SetState(*entry.alert, AlertState::kCleared, time);
    } else {
      return false;
    }
    return true;
  }
  return false;
}

// What was shown a second ago, followed since: what came up between is not acknowledged. What the tracker itself acknowledges for a person (see
// KeptAcknowledgements) is on the side of the boat where it was told.
void Alerts::TellPlaces(Entry& entry, const Key& key, const Acknowledgement& acknowledgement) {
  if (!entry.told) entry.told.emplace(key.second == kLandTrack ? ToldPlaces::Kind::kLand : ToldPlaces::Kind::kThings);
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

void Alerts::ForgetMap() {
  for (auto& [key, entry] : entries_) {
    if (entry.told) entry.told->ForgetMap();
    for (auto& shown : entry.shown) {
      for (auto& place : shown.places) place.position_map_m.setConstant(kNan);
    }
  }
}

void Alerts::Rename(std::int64_t from_track, std::int64_t to_track, Utime time) {
  if (from_track == to_track) return;
  for (const auto cause : {AlertCause::kGuardZone, AlertCause::kClosestApproach}) {
    auto moved = entries_.extract(Key{cause, from_track});
    if (!moved) continue;
    moved.key().second = to_track;
    if (moved.mapped().alert) moved.mapped().alert->track_id = to_track;
    const auto placed = entries_.insert(std::move(moved));
    if (placed.inserted) continue;
    auto& stays = placed.position->second;
    auto& goes = placed.node.mapped();
    if (!goes.alert) continue;
    if (!stays.alert || goes.alert->id < stays.alert->id) std::swap(stays, goes);
    if (!goes.alert) continue;
    if (goes.alert->Holds()) {
      const bool is_open = goes.alert->state == AlertState::kActive || stays.alert->state != AlertState::kAcknowledged;
      SetState(*stays.alert, is_open ? AlertState::kActive : AlertState::kAcknowledged, time);
      SetLevel(*stays.alert, std::max(stays.alert->level, goes.alert->level), time);
      if (goes.raised.is_on) stays.raised.is_on = true;
      if (goes.warning.is_on) stays.warning.is_on = true;
    }
    SetState(*goes.alert, AlertState::kCleared, time);
    ended_.push_back(*goes.alert);
  }
}

}  // namespace lookout::tracker
