#include "services/tracker/core/standing.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/tracker/core/outline.hpp"

namespace lookout::tracker {

namespace {

constexpr double kEveryS = 1.0;
constexpr double kStandsForS = 10.0;      // until it is a thing of the map
constexpr double kMostDeviationM = 10.0;  // of a place that is worth to be kept
// A thing that is looked through: of one second, and of all until it is gone.
constexpr double kLeastBeams = 3.0;
constexpr double kMostMetShare = 0.1;
constexpr int kLooksUntilGone = 20;
constexpr double kBeamsUntilGone = 100.0;
constexpr std::size_t kMostLooked = 200;  // things a second

bool Stands(const Track& track) { return track.status == TrackStatus::kConfirmed && track.velocity_mps.isZero(0.0); }

// Of a place, along its worst direction.
double DeviationOf(const Track& track) {
  const double half_trace = 0.5 * (track.covariance(0, 0) + track.covariance(1, 1));
  const double half_difference = 0.5 * (track.covariance(0, 0) - track.covariance(1, 1));
  return std::sqrt(std::max(0.0, half_trace + Hypot(half_difference, track.covariance(0, 1))));
}

// Numbers that a map may hold.
bool CanBeKept(const Track& track) {
  return DeviationOf(track) <= kMostDeviationM && track.rectangle.length_m <= kMostMapThingM && std::abs(track.top_above_water_m) <= kMostMapThingM;
}

}  // namespace

void StandingThings::Give(const std::vector<MapThing>& things) {
  for (const auto& given : things) {
    Thing thing;
    thing.now = given;
    thing.now.days.clear();
    thing.now.state = MapThing::State::kUnseen;
    thing.given = given;
    things_.push_back(std::move(thing));
  }
  num_given_ = std::ssize(things_);
  has_begun_ = true;
}

void StandingThings::PlaceOnMap(const Datum& datum) {
  if (datum_ && datum_->IsSameAs(datum)) return;
  datum_ = datum;
  const LocalFrame map = datum.Map();
  for (auto& thing : things_) Place(map, datum, thing);
}

// On the height of the datum: things float as the boat does, which began there.
void StandingThings::Place(const LocalFrame& map, const Datum& datum, Thing& thing) {
  const auto& at = thing.reference();
  const double height_m = std::isnan(datum.ellipsoid_height_m) ? 0.0 : datum.ellipsoid_height_m;
  thing.place_m = map.Forward({at.latitude_deg, at.longitude_deg, height_m}).head<2>();
  thing.outline_m.clear();
  for (const auto& corner_m : at.outline_m) thing.outline_m.emplace_back(thing.place_m + corner_m);
}

void StandingThings::Update(const ScanInput& scan, const Sight* sight, double max_range_m, std::vector<Track>& tracks) {
  if (!scan.own || !has_begun_) return;
  PlaceOnMap(scan.datum);
  NoteSeen(scan, tracks);
  if (second_ && scan.end_time >= *second_ && ToSeconds(scan.end_time - *second_) < kEveryS) return;
  second_ = scan.end_time;
  LetGo(tracks);
  Match(scan, tracks);
  Measure(scan, tracks);
  if (sight != nullptr) LookThrough(scan.end_time, *sight, max_range_m);
}

void StandingThings::NoteSeen(const ScanInput& scan, std::vector<Track>& tracks) {
  for (auto& track : tracks) {
    const auto found = thing_of_.find(track.id);
    if (found == thing_of_.end()) continue;
    auto& thing = things_[found->second];
    if (Stands(track) && thing.given && !thing.given->gone && std::cmp_greater_equal(thing.given->days.size(), kKnownDays)) {
      track.known_days = static_cast<std::int32_t>(thing.given->days.size());
    }
    if (track.segment_ids.empty() || !Stands(track)) continue;
    if (thing.now.state != MapThing::State::kSeen) {
      if (thing.now.days.empty()) thing.now.first = track.first;
      thing.now.state = MapThing::State::kSeen;
      thing.now.gone.reset();
    }
    // A clock that was set back makes no thing that was seen before it was seen first.
    thing.now.first = std::min(thing.now.first, scan.end_time);
    thing.now.seen = std::max(thing.now.seen, scan.end_time);
    AddScans({DayOf(scan.end_time), 1}, thing.now.days);
    thing.is_changed = true;
    thing.num_looks = 0;
    thing.num_beams = 0.0;
  }
}

// Of tracks that ended, move, or stand elsewhere by now.
void StandingThings::LetGo(const std::vector<Track>& tracks) {
  for (auto& thing : things_) thing.is_tracked = false;
  std::erase_if(thing_of_, [&](const auto& one) {
    const auto track = std::ranges::lower_bound(tracks, one.first, {}, &Track::id);
    if (track == tracks.end() || track->id != one.first || track->status == TrackStatus::kLost || !track->velocity_mps.isZero(0.0)) return true;
    auto& thing = things_[one.second];
    const double apart_m = (track->position_m - thing.place_m).norm();
    if (apart_m > SamePlaceM(thing.reference().deviation_m, DeviationOf(*track))) return true;
    thing.is_tracked = true;
    return false;
  });
}

void StandingThings::Match(const ScanInput& scan, const std::vector<Track>& tracks) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;  // distance, thing, track
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    const auto& track = tracks[k];
    if (!Stands(track) || thing_of_.contains(track.id)) continue;
    const double deviation_m = DeviationOf(track);
    for (std::size_t i = 0; i < things_.size(); ++i) {
      const auto& thing = things_[i];
      if (thing.is_tracked) continue;
      const double apart_m = (track.position_m - thing.place_m).norm();
      if (apart_m > SamePlaceM(thing.reference().deviation_m, deviation_m)) continue;
      if (AreOfOneThing(track.rectangle.length_m, thing.reference().length_m)) pairs.emplace_back(apart_m, i, k);
    }
  }
  std::ranges::sort(pairs);
  for (const auto& [apart_m, i, k] : pairs) {
    if (things_[i].is_tracked || thing_of_.contains(tracks[k].id)) continue;
    things_[i].is_tracked = true;
    thing_of_.emplace(tracks[k].id, i);
  }
  for (const auto& track : tracks) {
    if (!Stands(track) || thing_of_.contains(track.id) || ToSeconds(track.seen - track.first) < kStandsForS) continue;
    if (!CanBeKept(track)) continue;
    if (std::ssize(things_) - num_given_ >= static_cast<std::int64_t>(kMostMapThings)) {
      ++num_over_limit_;
      continue;
    }
    Thing thing;
    thing.now.id = std::ssize(things_) + 1;
    thing.now.first = track.first;
    thing.now.seen = track.seen;
    thing.now.state = MapThing::State::kSeen;
    thing.now.days = {{DayOf(scan.end_time), 1}};
    thing.is_tracked = thing.is_changed = true;
    thing_of_.emplace(track.id, things_.size());
    things_.push_back(std::move(thing));
  }
}

// How a thing looks to this process: what was given stays where it was given, for what follows.
void StandingThings::Measure(const ScanInput& scan, const std::vector<Track>& tracks) {
  const LocalFrame map = scan.datum.Map();
  for (const auto& [id, i] : thing_of_) {
    const auto track = std::ranges::lower_bound(tracks, id, {}, &Track::id);
    auto& thing = things_[i];
    if (!Stands(*track) || thing.now.state != MapThing::State::kSeen || !CanBeKept(*track)) continue;
    auto& now = thing.now;
    const auto place = map.Reverse({track->position_m.x(), track->position_m.y(), scan.own->position_map_m.z()});
    now.latitude_deg = place.latitude_deg;
    now.longitude_deg = place.longitude_deg;
    now.kind = track->kind;
    now.deviation_m = DeviationOf(*track);
    now.length_m = track->rectangle.length_m;
    now.width_m = track->rectangle.width_m;
    const double bearing_rad = WrapTo2Pi(kPi / 2.0 - track->rectangle.length_angle_rad);
    now.length_bearing_rad = bearing_rad < kPi ? bearing_rad : bearing_rad - kPi;
    now.top_above_water_m = track->top_above_water_m;
    now.outline_m.clear();
    for (const auto& corner_m : track->outline_m) now.outline_m.emplace_back(corner_m - track->position_m);
    if (!thing.given) Place(map, scan.datum, thing);
  }
}

void StandingThings::LookThrough(Utime now, const Sight& sight, double max_range_m) {
  std::size_t num_looked = 0;
  for (std::size_t n = 0; n < things_.size() && num_looked < kMostLooked; ++n) {
    next_looked_ = next_looked_ < things_.size() ? next_looked_ : 0;
    auto& thing = things_[next_looked_++];
    if (thing.is_tracked || thing.now.state == MapThing::State::kGone || (thing.place_m - sight.from_m()).norm() > max_range_m) continue;
    ++num_looked;
    const auto look = sight.At(thing.outline_m, thing.reference().top_above_water_m);
    if (look.num_open < kLeastBeams) continue;
    if (look.num_met > kMostMetShare * look.num_open) {  // something is there
      thing.num_looks = 0;
      thing.num_beams = 0.0;
      continue;
    }
    ++thing.num_looks;
    thing.num_beams += look.num_open;
    if (thing.num_looks < kLooksUntilGone || thing.num_beams < kBeamsUntilGone) continue;
    thing.now.state = MapThing::State::kGone;
    // What was found gone on an earlier day went then.
    thing.now.gone = thing.given && thing.given->gone && thing.now.days.empty() ? thing.given->gone : now;
    thing.is_changed = true;
  }
}

std::vector<MapThing> StandingThings::TakeChanged() {
  std::vector<MapThing> changed;
  for (auto& thing : things_) {
    if (std::exchange(thing.is_changed, false)) changed.push_back(thing.now);
  }
  return changed;
}

std::int64_t StandingThings::num_known_seen() const {
  return std::ranges::count_if(things_, [](const Thing& thing) {
    return thing.given && std::cmp_greater_equal(thing.given->days.size(), kKnownDays) && thing.now.state == MapThing::State::kSeen;
  });
}

std::int64_t StandingThings::num_gone() const {
  return std::ranges::count_if(things_,
                               [](const Thing& thing) { return thing.given && !thing.given->gone && thing.now.state == MapThing::State::kGone; });
}

}  // namespace lookout::tracker
